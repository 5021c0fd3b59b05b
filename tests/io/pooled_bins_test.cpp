// Bins that are finer than a map can use, averaged.
#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <isobath/io/open_source.hpp>
#include <isobath/io/pooled_bins.hpp>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

/// Events one after another.
class Told final : public Source {
 public:
  explicit Told(std::vector<Event> events) : events_(std::move(events)) {}
  std::optional<Event> next() override {
    if (at_ == events_.size()) return {};
    return events_[at_++];
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  std::vector<Event> events_;
  std::size_t at_ = 0;
  SourceReport report_;
};

Ping pooled(const Ping& ping, int max_bins) {
  return std::get<Ping>(*with_pooled_bins(std::make_unique<Told>(std::vector<Event>{ping}), max_bins)->next());
}

template <class Sample>
void expect_means(float full_scale) {
  Random random(11);
  const auto value = [&](int, int) { return random.uniform(0, static_cast<double>(full_scale)); };
  // 5 m off to 15 m in bins of 2 cm: 750 would reach from the sonar to the end; 200 may.
  const Ping fine = test::ping_of<Sample>(test::fan_of(3), {5, 0.02, 500}, value, full_scale);
  const Ping ping = pooled(fine, 200);
  ASSERT_EQ(check(ping), PingFault::kNone);
  EXPECT_EQ(ping.window.bins, 125);
  EXPECT_NEAR(ping.window.bin_m, 0.08, 1e-12);
  EXPECT_EQ(ping.window.start_m, 5);
  EXPECT_EQ(ping.fan, fine.fan);
  EXPECT_EQ(ping.intensity.type(), fine.intensity.type());
  for (int b = 0; b < 3; ++b) {
    for (int k = 0; k < 125; ++k) {
      double mean = 0;
      for (int i = 0; i < 4; ++i) mean += static_cast<double>(fine.intensity(b, 4 * k + i)) / 4;
      if (std::is_integral_v<Sample>) mean = std::floor(mean + 0.5);
      EXPECT_NEAR(static_cast<double>(ping.intensity(b, k)), mean, 1e-6 * static_cast<double>(full_scale));
    }
  }
}

TEST(PooledBins, AreSampledWhereAllOfThemWas) {
  Ping fine = test::ping_of<float>(
      test::fan_of(4), {0, 0.02, 100}, [](int, int) { return 1.0; }, 1);
  fine.sampled = std::make_shared<std::vector<BinSpan>>(std::vector<BinSpan>{{0, 100}, {3, 11}, {5, 7}, {0, 0}});
  const Ping ping = pooled(fine, 25);
  ASSERT_EQ(check(ping), PingFault::kNone);
  EXPECT_EQ(*ping.sampled, (std::vector<BinSpan>{{0, 25}, {1, 2}, {2, 2}, {0, 0}}));
}

TEST(PooledBins, AreMeansOfTheirNeighbours) {
  expect_means<std::uint8_t>(255);
  expect_means<std::uint16_t>(4000);
  expect_means<float>(1);
}

TEST(PooledBins, AreOnlyMadeWhereBinsAreFinerThanAsked) {
  const auto level = [](int, int k) { return k; };
  const Ping coarse = test::ping_of<std::uint8_t>(test::fan_of(2), {0, 0.05, 200}, level);
  EXPECT_EQ(pooled(coarse, 200).intensity.data(), coarse.intensity.data());
  EXPECT_EQ(pooled(coarse, 0).window.bins, 200);
  const Ping halved = pooled(coarse, 199);
  EXPECT_EQ(halved.window.bins, 100);
  EXPECT_EQ(pooled(coarse, 60).window.bins, 50) << "four together";
  EXPECT_EQ(pooled(test::ping_of<std::uint8_t>(test::fan_of(2), {0, 0.05, 203}, level), 60).window.bins, 50)
      << "the last three fill no bin";
  RangeReading reading;
  reading.range_m = 3;
  const auto source = with_pooled_bins(std::make_unique<Told>(std::vector<Event>{reading, coarse}), 100);
  EXPECT_TRUE(std::holds_alternative<RangeReading>(*source->next()));
  EXPECT_TRUE(std::holds_alternative<Ping>(*source->next()));
  EXPECT_FALSE(source->next());
}

/// Mean level, and standard deviation of a sample by the differences of neighbours, which know no trend.
std::pair<double, double> noise_of(const Ping& ping) {
  double sum = 0, squares = 0;
  int n = 0;
  for (int b = 0; b < ping.intensity.beams(); ++b) {
    for (int k = 0; k + 1 < ping.window.bins; ++k, ++n) {
      const auto z = static_cast<double>(ping.intensity(b, k)), next = static_cast<double>(ping.intensity(b, k + 1));
      sum += z;
      squares += (next - z) * (next - z) / 2;
    }
  }
  return {sum / n, std::sqrt(squares / n)};
}

TEST(PooledBins, HalveTheSpeckleOfFourSamples) {
  Random random(12);
  const auto noise = test::rayleigh(0.1);
  const Ping fine = test::ping_of<float>(
      test::fan_of(40), {0, 0.01, 2000}, [&](int, int) { return noise(random); }, 1);
  const auto [before, spread] = noise_of(fine);
  const auto [after, left] = noise_of(pooled(fine, 500));
  EXPECT_NEAR(after, before, 1e-3);
  EXPECT_NEAR(left / spread, 0.5, 0.02);
}

// An ARIS of 2000 samples: its water varies by less, and the window stays.
TEST(PooledBinsOfARecording, KeepTheWindowAndLowerTheSpeckle) {
  ISOBATH_NEEDS_DATA(folder, "aris-sample");
  InputConfig whole;
  whole.max_bins = 0;
  const Ping fine = std::get<Ping>(*open_source(folder / "sample.aris", whole)->next());
  const Ping ping = std::get<Ping>(*open_source(folder / "sample.aris", {})->next());
  EXPECT_EQ(fine.window.bins, 2000);
  EXPECT_EQ(ping.window.bins, 1000);
  EXPECT_NEAR(ping.window.end_m(), fine.window.end_m(), 1e-9);
  EXPECT_NEAR(noise_of(ping).first, noise_of(fine).first, 1);
  EXPECT_LT(noise_of(ping).second, 0.85 * noise_of(fine).second);
}

}  // namespace
}  // namespace isobath

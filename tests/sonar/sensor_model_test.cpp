#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/sonar/sensor_model.hpp>

namespace isobath {
namespace {

/// 44 bins to 50 m, the first 9 blind: the sonar of the thesis.
SensorModel model() {
  SensorModel m;
  m.source = "reservoir";
  m.window = {0, 50.0 / 44, 44};
  for (int k = 0; k < 44; ++k) m.bins.push_back({20.0 + k, 0.9 - 0.01 * k, 10.25, 5, k < 9});
  for (int k = 0; k < 9; ++k) m.bins[k] = {0, 0, 3, 1, true};
  return m;
}

template <class Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(SensorModel, IsReadBackAsItWasWritten) {
  EXPECT_EQ(read_sensor_model(write_sensor_model(model()), "m.json"), model());
}

// ledger: S6-09 S6-E05
TEST(SensorModel, RefusesBinsThatDetectNoBetterThanTheyAlarm) {
  SensorModel m = model();
  m.bins[20].p_detect = m.false_alarm;
  EXPECT_THAT(error_of([&] { m.check("m.json"); }), testing::HasSubstr("m.json: bins[20].p_detect"));
  m.bins[20].blind = true;
  EXPECT_NO_THROW(m.check());
}

// ledger: S6-E05
TEST(SensorModel, RefusesThePrintedFormOfTheBlindZone) {
  SensorModel m = model();
  m.bins[3] = {0, 0, 3, 1, false};
  EXPECT_THAT(error_of([&] { m.check(); }), testing::HasSubstr("blind"));
}

TEST(SensorModel, ErrorsOfAFileSayWhere) {
  const std::string good = write_sensor_model(model());
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return error_of([&] { read_sensor_model(text, "m.json"); });
  };
  using testing::HasSubstr;
  EXPECT_THAT(changed("\"version\": 1", "\"version\": 2"), HasSubstr("m.json: version: unknown version; allowed: 1"));
  EXPECT_THAT(changed("\"start_m\"", "\"start\""), HasSubstr("window.start: unknown key"));
  EXPECT_THAT(changed("\"blind\": true", "\"blind\": 1"), HasSubstr("bins[0].blind: wrong type"));
  EXPECT_THAT(changed("\"bins\": 44", "\"bins\": 45"), HasSubstr("44 bins for a window of 45"));
  EXPECT_THAT(changed("\"bins\": 44", "\"bins\": 1e300"), HasSubstr("window.bins: out of range"));
  EXPECT_THAT(changed("\"reservoir\"", "reservoir"), HasSubstr("m.json: byte"));
  EXPECT_THAT(error_of([&] { read_sensor_model("", "m.json"); }), HasSubstr("not JSON"));
  EXPECT_THAT(error_of([&] { read_sensor_model("[]", "m.json"); }), HasSubstr("not an object"));
}

TEST(SensorModel, DamagedTextIsAnErrorAndNothingElse) {
  const std::string good = write_sensor_model(model());
  Random random(17);
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (int n = 0; n < 1 + i % 3; ++n) text[random.index(text.size())] = static_cast<char>(random.bits());
    if (i % 5 == 0) text.resize(random.index(text.size()));
    try {
      read_sensor_model(text, "m.json").check();
    } catch (const Error&) {
    }
  }
  EXPECT_THROW(read_sensor_model("{\"format\": 1e999}", "m.json"), Error);
  EXPECT_THROW(read_sensor_model(std::string(100000, '['), "m.json"), Error);
}

TEST(SensorModel, IsInterpolatedOverRangeForAnotherWindow) {
  const SensorModel m = model();
  const RangeWindow finer{10.5, 0.75, 40};
  const auto bins = for_window(m, finer, 255);
  ASSERT_TRUE(bins);
  for (int k = 0; k < finer.bins; ++k) {
    const double at = finer.centre(k) / m.window.bin_m - 0.5;
    if ((*bins)[k].blind) {
      EXPECT_LT(at, 9) << "blind where a blind bin has a share";
    } else {
      EXPECT_NEAR((*bins)[k].threshold, 20 + at, 1e-9);
      EXPECT_NEAR((*bins)[k].p_detect, 0.9 - 0.01 * at, 1e-9);
    }
  }
}

TEST(SensorModel, RefusesWindowsThatItDoesNotKnow) {
  const SensorModel m = model();
  EXPECT_EQ(for_window(m, {0, 1, 60}, 255).error(), ModelMismatch::kRange);
  EXPECT_EQ(for_window(m, {0, 0.1, 100}, 255).error(), ModelMismatch::kBinLength);
  EXPECT_EQ(for_window(m, m.window, 65535).error(), ModelMismatch::kFullScale);
}

}  // namespace
}  // namespace isobath

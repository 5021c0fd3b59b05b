// The automatic detector on recordings of real sonars (see their README for what stands where).
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <png.h>
#include <cmath>
#include <fstream>
#include <isobath/sonar/calibration.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <sstream>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>

namespace isobath {
namespace {

/// For each of 200 bearings the share of pings, from the third turn on, that hit each bin.
struct Tank {
  static constexpr double kBin = 0.01253133;
  std::vector<std::vector<double>> share = std::vector<std::vector<double>>(200, std::vector<double>(399, 0));

  explicit Tank(const std::filesystem::path& csv) {
    std::ifstream in(csv);
    EchoDetector detector{EchoDetectorConfig{}};
    EchoDecisions out;
    std::vector<int> pings(200, 0);
    std::string line;
    for (int n = 0; std::getline(in, line);) {
      if (line[0] == '#') continue;
      std::istringstream row(line);
      const auto next = [&] {
        std::string cell;
        std::getline(row, cell, ',');
        return std::stod(cell);
      };
      next();
      const double bearing = next();
      const Ping ping = test::ping_of<std::uint8_t>(test::fan_of(1, Angle::degrees(bearing)), {0, next(), 399},
                                                    [&](int, int k) { return k == 0 ? (next(), next()) : next(); });
      detector.detect(ping, out);
      if (n++ < 300) continue;  // a turn of 100 pings, and one of 200
      const int at = static_cast<int>(std::lround(bearing / 1.8)) % 200;
      ++pings[at];
      for (int k = 0; k < 399; ++k) share[at][k] += out.hit(0, k);
    }
    for (int b = 0; b < 200; ++b) {
      for (double& s : share[b]) s /= pings[b];
    }
  }
  /// Ranges where stretches of bins begin that hit in most pings.
  [[nodiscard]] std::vector<double> echoes(int bearing_deg) const {
    const auto& s = share[bearing_deg * 200 / 360];
    std::vector<double> begins;
    for (int k = 1, last = -9; k < 399; ++k) {
      if (s[k] <= 0.5) continue;
      if (k - last > 3) begins.push_back(k * kBin);
      last = k;
    }
    return begins;
  }
};

TEST(TankRecording, FirstEchoOfEachWallIsTheWall) {
  ISOBATH_NEEDS_DATA(csv, "msis-tank/msis-tank-rev00-20.csv");
  const Tank tank(csv);
  const auto first = [&](int bearing) { return tank.echoes(bearing).empty() ? 0 : tank.echoes(bearing)[0]; };
  EXPECT_NEAR(first(0), 2.12, 0.07);
  EXPECT_NEAR(first(90), 1.79, 0.07);
  EXPECT_NEAR(first(180), 2.31, 0.07);
  EXPECT_NEAR(first(270), 1.49, 0.05) << "the compact echo";
  using testing::AllOf, testing::Contains, testing::Gt, testing::Lt;
  EXPECT_THAT(tank.echoes(270), Contains(AllOf(Gt(2.70), Lt(2.80)))) << "the wall behind it";
  double hits = 0;
  for (const auto& s : tank.share) {
    for (int k = 64; k < 112; ++k) hits += s[k];  // 0.8 .. 1.4 m: reverberation of 40 to 60 counts, no wall
  }
  EXPECT_LT(hits / (200 * 48), 0.005);
}

/// A grey picture: rows are range bins, columns beams. The first channel of any other.
struct Picture {
  int beams = 0;
  int bins = 0;
  std::vector<std::uint8_t> rows;

  explicit Picture(const std::filesystem::path& png) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_file(&image, png.c_str())) return;
    image.format = PNG_FORMAT_RGBA;
    beams = static_cast<int>(image.width);
    bins = static_cast<int>(image.height);
    std::vector<std::uint8_t> all(PNG_IMAGE_SIZE(image));
    png_image_finish_read(&image, nullptr, all.data(), 0, nullptr);
    for (std::size_t i = 0; i < all.size(); i += 4) rows.push_back(all[i]);
  }
  [[nodiscard]] std::uint8_t at(int beam, int bin) const { return rows[std::size_t(bin) * beams + beam]; }
  [[nodiscard]] Ping ping(RangeWindow window) const {
    window.bins = bins;
    return test::ping_of<std::uint8_t>(test::fan_of(beams, {}, Angle::degrees(0.3)), window,
                                       [&](int b, int k) { return at(b, k); });
  }
};

std::vector<std::filesystem::path> pictures(const std::filesystem::path& folder, const std::string& ending) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().filename().string().ends_with(ending)) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

constexpr RangeWindow kDidson{2.25, 9.0 / 512, 512};
constexpr RangeWindow kHolo{0, 8.0 / 512, 512};

// ledger: S6-04 S6-05 S6-06
TEST(DidsonRecording, ThresholdsABinDetectAtLeastAsMuchAsOneForAll) {
  ISOBATH_NEEDS_DATA(folder, "didson-hull");
  Calibration calibration{CalibrationConfig{}};
  for (const auto& png : pictures(folder / "background", ".png"))
    calibration.add_background(Picture(png).ping(kDidson));
  for (const auto& png : pictures(folder / "test", "_raw.png")) {
    const Picture picture(png);
    const std::string name = png.filename().string();
    const Picture marks(png.parent_path() / (name.substr(0, name.size() - 8) + "_annotated.png"));
    std::vector<std::uint8_t> marked;
    for (int b = 0; b < picture.beams; ++b) {
      for (int k = 0; k < picture.bins; ++k) marked.push_back(marks.at(b, k) == 255);
    }
    calibration.add_marked(picture.ping(kDidson), marked);
  }
  const CalibrationResult result = calibration.finish("DIDSON");
  EXPECT_EQ(result.background_pings, 87);
  EXPECT_EQ(result.marked_pings, 8);
  EXPECT_EQ(result.marked_cells, 443u);
  ASSERT_EQ(result.comparison.size(), 4u);
  for (const ThresholdComparison& c : result.comparison) {
    EXPECT_NEAR(c.false_alarm.value, c.nominal_false_alarm, 0.05 * c.nominal_false_alarm);
    EXPECT_GE(c.per_bin.value, c.global.value) << c.nominal_false_alarm;
    RecordProperty(
        fmt::format("f{:.2f}", c.nominal_false_alarm),
        fmt::format("{:.3f} [{:.3f}, {:.3f}] against {:.3f} [{:.3f}, {:.3f}]", c.per_bin.value, c.per_bin.interval.low,
                    c.per_bin.interval.high, c.global.value, c.global.interval.low, c.global.interval.high));
  }
  for (const SensorModel::Bin& bin : result.model.bins) EXPECT_GT(bin.p_detect, 0.5);
}

TEST(DidsonRecording, AutomaticThresholdsAlarmAboutAsOftenAsAsked) {
  ISOBATH_NEEDS_DATA(folder, "didson-hull/background");
  EchoDetector detector{EchoDetectorConfig{}};
  EchoDecisions out;
  double hits = 0, all = 0;
  int frame = 0;
  for (const auto& png : pictures(folder, ".png")) {
    detector.detect(Picture(png).ping(kDidson), out);
    if (++frame <= 40) continue;
    for (int b = 0; b < out.beams(); ++b) {
      for (int k = 0; k < out.bins(); ++k) hits += out.hit(b, k);
    }
    all += out.beams() * out.bins();
  }
  EXPECT_NEAR(hits / all, 0.025, 0.01);
}

/// Frames of the noisy set without a sample over 0.75 (37 counts): no target.
bool empty(const Picture& picture) {
  return std::all_of(picture.rows.begin(), picture.rows.end(), [](std::uint8_t z) { return z <= 37; });
}

TEST(NoisySimulatedRecording, AutomaticThresholdsKeepEmptyFramesEmpty) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat/noisy");
  EchoDetector detector{EchoDetectorConfig{}};
  EchoDecisions out;
  double hits = 0, all = 0;
  int frame = 0;
  auto frames = pictures(folder, ".png");
  frames.resize(std::min<std::size_t>(frames.size(), 200));
  for (const auto& png : frames) {
    const Picture picture(png);
    detector.detect(picture.ping(kHolo), out);
    if (++frame <= 20 || !empty(picture)) continue;
    for (int b = 0; b < out.beams(); ++b) {
      for (int k = 0; k < out.bins(); ++k) {
        hits += out.hit(b, k);
        all += out.usable(k);
      }
    }
  }
  ASSERT_GT(all, 0);
  EXPECT_LT(hits / all, 0.02) << "below it: choosing frames by their maximum cuts the tail of the noise off";
}

// Background alone, no marks: thresholds from every other target-less frame, tried on those between.
// ledger: S6-06
TEST(NoisySimulatedRecording, CalibratesFromBackgroundAlone) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat/noisy");
  Calibration calibration{CalibrationConfig{}};
  std::vector<Picture> tried;
  int frame = 0;
  for (const auto& png : pictures(folder, ".png")) {
    Picture picture(png);
    if (!empty(picture)) continue;
    if (frame++ % 2 == 0) {
      calibration.add_background(picture.ping(kHolo));
    } else {
      tried.push_back(std::move(picture));
    }
  }
  ASSERT_GT(tried.size(), 10u);
  EchoDetector detector({}, calibration.finish("noise").model);
  EchoDecisions out;
  double hits = 0, all = 0;
  for (const Picture& picture : tried) {
    detector.detect(picture.ping(kHolo), out);
    for (int b = 0; b < out.beams(); ++b) {
      for (int k = 0; k < out.bins(); ++k) {
        hits += out.hit(b, k);
        all += out.usable(k);
      }
    }
  }
  EXPECT_LE(hits / all, 0.02) << "whole thresholds on noise of few counts: at or below";
  EXPECT_GT(hits / all, 0.01);
}

}  // namespace
}  // namespace isobath

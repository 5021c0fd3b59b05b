// The automatic detector on recordings of real sonars (see their README for what stands where).
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/sonar/calibration.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/fan_detector.hpp>
#include <png.h>
#include <sstream>
#include <tests/support/data.hpp>
#include <tests/support/echoes.hpp>
#include <tests/support/sanitized.hpp>

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
  for (int bearing : {0, 90, 180, 270})
    RecordProperty(fmt::format("first{}", bearing), fmt::format("{:.3f}", first(bearing)));
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

TEST(DidsonRecording, LearntThresholdsAlarmAboutAsOftenAsAsked) {
  ISOBATH_NEEDS_DATA(folder, "didson-hull/background");
  EchoDetectorConfig config;
  config.method = DetectionMethod::kLearnt;
  EchoDetector detector(config);
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
  RecordProperty("rate", fmt::format("{:.4f}", hits / all));
  EXPECT_NEAR(hits / all, 0.025, 0.01);
}

// Thresholds are learnt from the frames before: of 57 frames of empty water, clipped and spiky, as many cells are false
// as were asked for, though nobody has marked or calibrated anything.
// ledger: S6-06 S6-70
TEST(DidsonRecording, CellsAlarmAsOftenAsAsked) {
  ISOBATH_NOT_SANITIZED();
  ISOBATH_NEEDS_DATA(folder, "didson-hull/background");
  for (const auto& [asked, tolerance] : {std::pair{1e-2, 0.1}, {1e-3, 0.15}, {1e-4, 0.35}}) {
    FanDetectorConfig config;
    config.false_alarm = asked;
    FanDetector detector(config);
    EchoDecisions samples;
    FanLooks looks;
    double hits = 0, all = 0;
    int frame = 0;
    for (const auto& png : pictures(folder, ".png")) {
      Ping ping = Picture(png).ping(kDidson);
      ping.time = Time{} + seconds(0.14 * frame);
      detector.detect(ping, {}, samples, looks);
      if (++frame <= 30) continue;
      const EchoDecisions& d = looks.decisions;
      for (int b = 0; b < d.beams(); ++b) {
        for (int k = 0; k < d.bins(); ++k) {
          all += d.tells(b, k);
          hits += d.tells(b, k) && d.hit(b, k);
        }
      }
    }
    EXPECT_NEAR(hits / all / asked, 1, tolerance) << asked;
  }
}

/// The frames of the recording as pings, background first. Targets are marked by pairs of range bins, which is the
/// resolution of a cell at the settings of these frames.
struct DidsonFrames {
  static constexpr std::size_t kLearning = 30;  ///< background frames that are not judged
  std::vector<Ping> pings;
  std::vector<std::vector<bool>> marked;  ///< of each ping, beams x pairs; empty: background

  explicit DidsonFrames(const std::filesystem::path& folder) {
    for (const auto& png : pictures(folder / "background", ".png")) add(Picture(png), {});
    for (const auto& png : pictures(folder / "test", "_raw.png")) {
      const std::string name = png.filename().string();
      const Picture marks(png.parent_path() / (name.substr(0, name.size() - 8) + "_annotated.png"));
      std::vector<bool> pairs;
      for (int b = 0; b < marks.beams; ++b) {
        for (int k = 0; k + 1 < marks.bins; k += 2) pairs.push_back(marks.at(b, k) == 255 || marks.at(b, k + 1) == 255);
      }
      add(Picture(png), std::move(pairs));
    }
  }

 private:
  void add(const Picture& picture, std::vector<bool> pairs) {
    pings.push_back(picture.ping(kDidson));
    pings.back().time = Time{} + seconds(0.14 * static_cast<double>(pings.size()));
    marked.push_back(std::move(pairs));
  }
};

/// The mean power of each pair of bins, as one sample.
Ping pooled(const Ping& ping) {
  RangeWindow window = ping.window;
  window.bins /= 2;
  window.bin_m *= 2;
  Ping out = test::ping_of<float>(ping.fan, window, [&](int b, int k) {
    return std::hypot(ping.intensity(b, 2 * k), ping.intensity(b, 2 * k + 1)) / std::sqrt(2.0);
  });
  out.time = ping.time;
  return out;
}

/// Of the pairs in background, from frame 31 on, and of those that somebody marked, the shares with an echo.
struct Shares {
  double background = 0, marked = 0;
};

/// Counts echo(beam, pair) of one frame after another.
class ShareCount {
 public:
  template <class Echo>
  void add(const DidsonFrames& frames, std::size_t frame, const Echo& echo) {
    const bool background = frames.marked[frame].empty();
    if (background && frame < DidsonFrames::kLearning) return;
    const int beams = frames.pings[frame].fan->beams(), pairs = frames.pings[frame].window.bins / 2;
    for (int b = 0, at = 0; b < beams; ++b) {
      for (int k = 0; k < pairs; ++k, ++at) {
        if (!background && !frames.marked[frame][static_cast<std::size_t>(at)]) continue;
        (background ? all_ : marked_) += 1;
        (background ? hits_ : found_) += echo(b, k);
      }
    }
  }
  [[nodiscard]] Shares shares() const { return {hits_ / all_, found_ / marked_}; }

 private:
  double hits_ = 0, all_ = 0, found_ = 0, marked_ = 0;
};

EchoDetectorConfig didson_config(DetectionMethod method, double asked) {
  EchoDetectorConfig config;
  config.method = method;
  config.false_alarm = config.fan.false_alarm = asked;
  config.p_detect = config.fan.p_detect = std::max(config.p_detect, 0.5 * (1 + asked));
  return config;
}

Shares shares_of(const DidsonFrames& frames, DetectionMethod method, double asked, bool pool = false) {
  EchoDetector detector(didson_config(method, asked));
  EchoDecisions out;
  ShareCount count;
  for (std::size_t i = 0; i < frames.pings.size(); ++i) {
    detector.detect(pool ? pooled(frames.pings[i]) : frames.pings[i], out);
    count.add(frames, i,
              [&](int b, int k) { return pool ? out.hit(b, k) : out.hit(b, 2 * k) || out.hit(b, 2 * k + 1); });
  }
  return count.shares();
}

using Curve = std::vector<Shares>;

Curve shares_of(const std::vector<ShareCount>& counts) {
  Curve curve;
  for (const ShareCount& count : counts) curve.push_back(count.shares());
  return curve;
}

/// The learnt thresholds times each scale: what they are asked for moves them little on these frames, where a share of
/// the loudest echoes holds them up.
Curve curve_of_learnt(const DidsonFrames& frames, const std::vector<double>& scales) {
  EchoDetector detector(didson_config(DetectionMethod::kLearnt, 0.02));
  EchoDecisions out;
  std::vector<ShareCount> counts(scales.size());
  for (std::size_t i = 0; i < frames.pings.size(); ++i) {
    const Ping& ping = frames.pings[i];
    detector.detect(ping, out);
    const std::vector<float>& wanted = detector.thresholds();
    for (std::size_t s = 0; s < scales.size(); ++s) {
      const auto echo = [&](int b, int k) {
        return ping.intensity(b, k) >= scales[s] * static_cast<double>(wanted[static_cast<std::size_t>(k)]);
      };
      counts[s].add(frames, i, [&](int b, int k) { return echo(b, 2 * k) || echo(b, 2 * k + 1); });
    }
  }
  return shares_of(counts);
}

/// What side lobes and shadows leave of a frame.
void print_silence(const DidsonFrames& frames, std::size_t frame, const EchoDecisions& cells) {
  int marked = 0, found = 0, silent = 0;
  for (int b = 0; b < cells.beams(); ++b) {
    for (int k = 0; k < cells.bins(); ++k) {
      const bool mark = frames.marked[frame][static_cast<std::size_t>(b * cells.bins() + k)];
      marked += mark;
      found += mark && cells.tells(b, k) && cells.hit(b, k);
      silent += !cells.tells(b, k);
    }
  }
  fmt::print("marked frame {}: found {} of {} cells; {:.0f} % of the fan is silent\n", frame - 86, found, marked,
             100.0 * silent / (cells.beams() * cells.bins()));
}

/// The ratio of a cell to its background, against its threshold times each scale: the cells without the rules that keep
/// them silent beside side lobes and in shadows.
Curve curve_of_ratios(const DidsonFrames& frames, const std::vector<double>& scales) {
  FanDetectorConfig config;
  config.false_alarm = 1e-3;
  FanDetector detector(config);
  EchoDecisions samples;
  FanLooks looks;
  std::vector<ShareCount> counts(scales.size());
  for (std::size_t i = 0; i < frames.pings.size(); ++i) {
    detector.detect(frames.pings[i], {}, samples, looks);
    const int bins = looks.decisions.bins();
    EXPECT_EQ(bins, frames.pings[i].window.bins / 2);
    if (!frames.marked[i].empty()) print_silence(frames, i, looks.decisions);
    for (std::size_t s = 0; s < scales.size(); ++s) {
      counts[s].add(frames, i, [&](int b, int k) {
        return detector.ratios()[static_cast<std::size_t>(b * bins + k)] >=
               static_cast<float>(scales[s]) * detector.threshold(b, k);
      });
    }
  }
  return shares_of(counts);
}

/// Detection over false alarms by straight lines between measured points (a threshold that is drawn at random between
/// two neighbours reaches them), from (0, 0) to (1, 1).
class MeasuredRoc {
 public:
  explicit MeasuredRoc(Curve points) : points_(std::move(points)) {
    points_.insert(points_.end(), {{0, 0}, {1, 1}});
    std::sort(points_.begin(), points_.end(), [](const Shares& a, const Shares& b) {
      return std::pair(a.background, a.marked) < std::pair(b.background, b.marked);
    });
  }
  [[nodiscard]] double detected(double false_alarm) const {
    std::size_t i = 1;
    while (i + 1 < points_.size() && points_[i].background < false_alarm) ++i;
    const Shares &a = points_[i - 1], &b = points_[i];
    const double span = b.background - a.background;
    return span > 0 ? std::lerp(a.marked, b.marked, (false_alarm - a.background) / span) : b.marked;
  }
  /// Mean of the detection over the logarithm of the false alarms from 1e-4 to 0.1: 1 is perfect.
  [[nodiscard]] double partial_area() const {
    constexpr int kSteps = 3000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += detected(std::pow(10, -4 + 3 * (i + 0.5) / kSteps));
    return sum / kSteps;
  }

 private:
  Curve points_;
};

// ROC of targets that somebody marked in frames of other scenes, against water without targets; nothing is calibrated.
// All methods are judged by pairs of bins; the two of the literature also on samples pooled to that length. By their
// ratio alone the cells are as good as the learnt thresholds would be were they set by hand to each false-alarm rate;
// side lobes and shadows cost some marked cells. ledger: S6-62 S6-64
TEST(DidsonRecording, CellsFindMarkedTargetsWithFewFalseAlarms) {
  ISOBATH_NOT_SANITIZED();
  ISOBATH_NEEDS_DATA(folder, "didson-hull");
  using M = DetectionMethod;
  const DidsonFrames frames(folder);
  ASSERT_EQ(frames.pings.size(), 95u);
  const auto area = [](const std::string& name, const std::vector<double>& settings, const Curve& curve) {
    for (std::size_t i = 0; i < curve.size(); ++i)
      fmt::print("roc,{},{:g},{:.6f},{:.4f}\n", name, settings[i], curve[i].background, curve[i].marked);
    const MeasuredRoc roc(curve);
    fmt::print("{:<15} area {:.3f}; marked at false 0.1: {:.3f}, 0.01: {:.3f}, 0.001: {:.3f}, 0.0001: {:.3f}\n", name,
               roc.partial_area(), roc.detected(0.1), roc.detected(0.01), roc.detected(0.001), roc.detected(0.0001));
    return roc.partial_area();
  };
  const auto area_of = [&](const std::string& name, M method, const std::vector<double>& asked, bool pool) {
    Curve curve;
    for (const double f : asked) curve.push_back(shares_of(frames, method, f, pool));
    return area(name, asked, curve);
  };
  const std::vector<double> ratios = {0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1, 1.2, 1.5, 2, 3};
  const std::vector<double> scales = {0.35, 0.5, 0.7, 0.84, 1, 1.2, 1.4, 1.7, 2, 2.4, 2.8, 3.4, 4};
  const std::vector<double> far = {0.3, 0.1, 0.01, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-14, 1e-20, 1e-30};
  const double cells = area_of("cells", M::kCells, {0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5}, false);
  const double ratio = area("cells, ratio", ratios, curve_of_ratios(frames, ratios));
  const double learnt = area("learnt, scaled", scales, curve_of_learnt(frames, scales));
  double cfar = 0;
  for (const bool pool : {false, true}) {
    cfar = std::max(cfar, area_of(pool ? "os_cfar, pooled" : "os_cfar", M::kOrderedStatistic, far, pool));
    cfar = std::max(cfar, area_of(pool ? "ca_cfar, pooled" : "ca_cfar", M::kCellAveraging, far, pool));
  }
  EXPECT_GT(ratio, learnt - 0.005);
  EXPECT_GT(cells, learnt - 0.05);
  EXPECT_GT(cells, cfar + 0.3);
  const Shares now = shares_of(frames, M::kCells, 1e-3), before = shares_of(frames, M::kLearnt, 0.02);
  fmt::print("learnt as it was set: background {:.4f}, marked {:.3f}\n", before.background, before.marked);
  EXPECT_GT(now.marked, 1.15 * before.marked);
  EXPECT_LT(now.background, before.background / 30);
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
  RecordProperty("rate", fmt::format("{:.4f}", hits / all));
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

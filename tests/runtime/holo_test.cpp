// Frames of an imaging sonar that circles a small hull, made by others with exact poses: a moving vehicle must see the
// hull where it is. The hull's box is the recording's own, in its frame: x east, y north.
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <isobath/sonar/calibration.hpp>
#include <tests/runtime/kept_scans.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

constexpr double kSlack = 0.5;  // m

/// How far a point of the level body frame lies outside the hull's box.
double off_hull(const Eigen::Vector2d& p, const Pose& X_WB) {
  const Eigen::Vector3d w = level(X_WB) * Eigen::Vector3d(p.x(), p.y(), 0);
  const double x = w.y(), y = w.x();
  return std::max({-76.2 - x, x + 63.4, -32.6 - y, y + 27.4, 0.0});
}

/// Of the frames that report an obstacle: in how many the outlines stay on the hull. The box holds 98 % of the bright
/// cells along each axis, not all of them: the stern's own echoes reach 0.7 m beyond it (x = -62.70), so a corner of an
/// outline there may stand outside, but no more than a twentieth of the corners, and no obstacle as a whole.
struct Agreement {
  int frames = 0;
  int corners_on_hull = 0;  ///< frames with at least 95 % of all corners on the hull
  int centres_on_hull = 0;  ///< frames with the centres of all obstacles on the hull
  int all_on_hull = 0;      ///< frames with every corner on the hull
  double share(int count) const { return frames > 0 ? static_cast<double>(count) / frames : 0; }
};

Agreement agreement(const std::vector<std::string>& settings) {
  Agreement result;
  for (const auto& scan : test::scans_of(test::shared_data("holo-boat"), test::configured(settings)).scans) {
    if (scan.obstacles.empty()) continue;
    ++result.frames;
    std::size_t corners = 0, on = 0;
    bool centres = true;
    for (const Obstacle& o : scan.obstacles) {
      centres = centres && off_hull(o.centre, scan.X_WB) <= kSlack;
      corners += o.outline.size();
      for (const auto& p : o.outline) on += off_hull(p, scan.X_WB) <= kSlack;
    }
    result.corners_on_hull += static_cast<double>(on) >= 0.95 * static_cast<double>(corners);
    result.centres_on_hull += centres;
    result.all_on_hull += on == corners;
  }
  std::printf("%d frames: 95 %% of corners on the hull in %.1f %%, centres in %.1f %%, every corner in %.1f %%\n", result.frames,
              100 * result.share(result.corners_on_hull), 100 * result.share(result.centres_on_hull),
              100 * result.share(result.all_on_hull));
  return result;
}

// ledger: S6-20 S6-22 S6-27
TEST(HoloBoat, OutlinesStayOnTheHullWithDeterministicMotion) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const Agreement seen = agreement({"motion.kind=deterministic"});
  EXPECT_GE(seen.frames, 180);
  EXPECT_GE(seen.share(seen.corners_on_hull), 0.95);
  EXPECT_GE(seen.share(seen.centres_on_hull), 0.95);
}

// ledger: S6-21 S6-22
TEST(HoloBoat, OutlinesStayOnTheHullWithProbabilisticMotion) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const Agreement seen = agreement({"motion.kind=probabilistic"});
  EXPECT_GE(seen.frames, 180);
  EXPECT_GE(seen.share(seen.corners_on_hull), 0.95);
  EXPECT_GE(seen.share(seen.centres_on_hull), 0.95);
}

// ledger: S6-27
TEST(HoloBoat, WithoutTheMotionModelTheyDoNot) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const Agreement seen = agreement({"motion.kind=none"});
  EXPECT_LT(seen.share(seen.corners_on_hull), 0.6);
  EXPECT_LT(seen.share(seen.centres_on_hull), 0.6);
}

/// Frames of the noisy set without a target: no cell of 0.75 (37.5 counts) or more behind the blind zone.
bool without_target(const Ping& ping, std::vector<float>& beam) {
  beam.resize(ping.window.bins);
  for (int b = 0; b < ping.fan->beams(); ++b) {
    ping.intensity.copy_beam(b, beam.data());
    for (int k = 0; k < ping.window.bins; ++k) {
      if (ping.window.edge(k) >= 0.6 && beam[k] > 37.5f) return false;
    }
  }
  return true;
}

/// Calibrated on every second frame without a target, judged on the others, each on a map of its own and all in a row.
// ledger: S6-06 S6-30
TEST(HoloBoat, NoiseAloneRaisesAtMostOneFalseObstacleInAHundredFrames) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  std::vector<Ping> quiet;
  std::vector<float> beam;
  for (const int pass : {1, 4, 5, 9, 10}) {
    const auto source = open_source(folder, test::configured({"input.set=noisy", "input.pass=" + std::to_string(pass)}).input);
    while (const auto event = source->next()) {
      const auto* ping = std::get_if<Ping>(&*event);
      if (ping && without_target(*ping, beam)) quiet.push_back(*ping);
    }
  }
  Calibration calibration({});
  std::vector<Ping> fresh;
  for (std::size_t i = 0; i < quiet.size(); ++i) {
    if (i % 2 == 0) {
      calibration.add_background(quiet[i]);
    } else {
      fresh.push_back(quiet[i]);
    }
  }
  const auto model = test::scratch_folder() / "model.json";
  save_sensor_model(calibration.finish("noisy frames").model, model);
  const Configuration configuration = test::configured({"sensor.model=" + model.string()});
  std::size_t false_alone = 0, false_in_a_row = 0;
  test::ScanKeeper row;
  Pipeline together(configuration, row);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    fresh[i].time = Time(seconds(static_cast<double>(i)));
    fresh[i].X_BS = {};
    test::ScanKeeper alone;
    Pipeline single(configuration, alone);
    single.take(fresh[i]);
    single.finish();
    false_alone += alone.scans.back().obstacles.size();
    together.take(fresh[i]);
  }
  together.finish();
  for (const auto& scan : row.scans) false_in_a_row += scan.obstacles.size();
  std::printf("%zu target-less frames judged: %zu false obstacles alone, %zu in a row\n", fresh.size(), false_alone, false_in_a_row);
  EXPECT_GE(fresh.size(), 20u);
  EXPECT_LE(static_cast<double>(false_alone), 0.01 * static_cast<double>(fresh.size()) + 1e-9);
  EXPECT_LE(static_cast<double>(false_in_a_row), 0.01 * static_cast<double>(fresh.size()) + 1e-9);
}

}  // namespace
}  // namespace isobath

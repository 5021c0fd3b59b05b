// Frames of an imaging sonar that circles a small hull, made by others with exact poses: a moving vehicle must see the hull
// where it is. The hull's box is the recording's own, in its frame: x east, y north.
#include <gtest/gtest.h>
#include <tests/runtime/kept_scans.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

struct Agreement {
  int frames = 0;  ///< that report an obstacle
  int inside = 0;  ///< of these, with all outlines on the hull
  double share() const { return frames > 0 ? static_cast<double>(inside) / frames : 0; }
};

bool on_hull(const Obstacle& o, const Pose& X_WB) {
  constexpr double kSlack = 0.5;
  const Pose X_WL = level(X_WB);
  for (const auto& p : o.outline) {
    const Eigen::Vector3d w = X_WL * Eigen::Vector3d(p.x(), p.y(), 0);
    const double x = w.y(), y = w.x();
    if (x < -76.2 - kSlack || x > -63.4 + kSlack || y < -32.6 - kSlack || y > -27.4 + kSlack) return false;
  }
  return true;
}

Agreement agreement(const std::vector<std::string>& settings) {
  Agreement result;
  for (const auto& scan : test::scans_of(test::shared_data("holo-boat"), test::configured(settings)).scans) {
    if (scan.obstacles.empty()) continue;
    ++result.frames;
    result.inside += std::all_of(scan.obstacles.begin(), scan.obstacles.end(),
                                 [&](const Obstacle& o) { return on_hull(o, scan.X_WB); });
  }
  return result;
}

// ledger: S6-20 S6-22 S6-27
TEST(HoloBoat, OutlinesStayOnTheHullWithDeterministicMotion) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const Agreement seen = agreement({"motion.kind=deterministic"});
  EXPECT_GE(seen.frames, 180);
  EXPECT_GE(seen.share(), 0.95) << seen.inside << " of " << seen.frames;
}

// ledger: S6-21 S6-22
TEST(HoloBoat, OutlinesStayOnTheHullWithProbabilisticMotion) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const Agreement seen = agreement({"motion.kind=probabilistic"});
  EXPECT_GE(seen.frames, 180);
  EXPECT_GE(seen.share(), 0.95) << seen.inside << " of " << seen.frames;
}

// ledger: S6-27
TEST(HoloBoat, WithoutTheMotionModelTheyDoNot) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const Agreement seen = agreement({"motion.kind=none"});
  EXPECT_LT(seen.share(), 0.75) << seen.inside << " of " << seen.frames;
}

}  // namespace
}  // namespace isobath

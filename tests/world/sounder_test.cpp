// Echo sounders in the pipeline: which way a fan stands, and the walls and floors of real harbours in the map of
// voxels.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/configuration/configuration.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/sonar/fan_stance.hpp>
#include <isobath/world/voxel_model.hpp>
#include <tests/support/data.hpp>
#include <tests/support/kept_scans.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

Ping fan_at(double heading_deg, double pitch_deg, double roll_deg, double half_deg, int beams = 31) {
  auto fan = std::make_shared<BeamFan>();
  for (int b = 0; b < beams; ++b) {
    fan->azimuth.push_back(Angle::degrees(beams > 1 ? half_deg * (2.0 * b / (beams - 1) - 1) : 0));
    fan->width.push_back(Angle::degrees(2));
  }
  fan->height = Angle::degrees(2);
  Ping ping;
  ping.fan = fan;
  ping.X_BS.rotation = Rotation::from_heading_pitch_roll(Angle::degrees(heading_deg), Angle::degrees(pitch_deg),
                                                         Angle::degrees(roll_deg));
  return ping;
}

// ledger: S5-06 S5-07
TEST(Stance, IsHowTheBeamsLieBesideEachOther) {
  EXPECT_TRUE(lies_flat(fan_at(0, 0, 0, 45)));
  EXPECT_TRUE(lies_flat(fan_at(120, -30, 180, 45)));
  EXPECT_TRUE(lies_flat(fan_at(0, -60, 0, 14))) << "an imaging sonar tilted down";
  EXPECT_FALSE(lies_flat(fan_at(0, 0, 90, 23))) << "upright along the vehicle";
  EXPECT_FALSE(lies_flat(fan_at(0, -90, 0, 60))) << "upright athwart";
  EXPECT_FALSE(lies_flat(fan_at(0, 0, 60, 23)));

  EXPECT_TRUE(looks_down(fan_at(0, -90, 0, 60)));
  EXPECT_TRUE(looks_down(fan_at(2, -88, 3, 60)));
  EXPECT_TRUE(looks_down(fan_at(0, -90, 35, 60))) << "one of two heads, that looks to starboard";
  EXPECT_TRUE(looks_down(fan_at(0, -45, 90, 50))) << "along the vehicle";
  EXPECT_FALSE(looks_down(fan_at(0, -5, 90, 23))) << "ahead";
  EXPECT_FALSE(looks_down(fan_at(0, 0, 0, 180))) << "all round, flat";
  EXPECT_FALSE(looks_down(fan_at(0, -90, 0, 0, 1))) << "no fan";
}

struct VoxelSink : ResultSink {
  explicit VoxelSink(const VoxelModelConfig& config) : voxels(config) {}
  void on_ping(const PosedPing&) override {}
  void on_scan(const ScanResult&) override {}
  void on_vertical_ping(const PosedPing& posed) override {
    voxels.update(posed);
    heading = posed.X_WB.rotation.heading();
    reference = posed.X_WB.translation;
  }
  VoxelModel voxels;
  Angle heading;
  Vector3d reference = Vector3d::Zero();
};

/// Occupied voxels as seen from the vehicle: metres to starboard of its reference point and below the water.
struct Section {
  std::vector<Eigen::Vector2d> occupied;
  VoxelOutcome outcome;
  PipelineCounts counts;

  /// Of all occupied voxels, the share near some place.
  template <class Near>
  [[nodiscard]] double share(const Near& near) const {
    const auto count = std::count_if(occupied.begin(), occupied.end(), near);
    return static_cast<double>(count) / static_cast<double>(occupied.size());
  }
  /// Of the bands `step` high or wide between two limits, the share of those that hold an occupied voxel near a line.
  template <class Place>
  [[nodiscard]] double filled(double from, double to, double step, const Place& place, double within) const {
    int bands = 0, held = 0;
    for (double at = from; at < to; at += step, ++bands) {
      const Eigen::Vector2d p = place(at);
      held += std::any_of(occupied.begin(), occupied.end(),
                          [&](const Eigen::Vector2d& v) { return (v - p).cwiseAbs().maxCoeff() < within; });
    }
    return static_cast<double>(held) / bands;
  }
};

Section section_of(const std::filesystem::path& log) {
  const Configuration configuration = test::configured();
  VoxelSink sink(configuration.voxels);
  const auto source = open_source(log, configuration.input);
  Pipeline pipeline(configuration, sink);
  while (auto event = source->next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  Section section;
  section.outcome = sink.voxels.outcome();
  section.counts = pipeline.counts();
  const VoxelMap& map = *sink.voxels.map();
  for_each_seen(map, [&](const VoxelIndex& v) {
    if (map.space(v) != Space::kOccupied) return;
    const Vector3d p = (v.cast<double>().array() + 0.5).matrix() * map.voxel_m();
    const Vector3d aside = Rotation::from_heading(-sink.heading) * (p - sink.reference);
    section.occupied.emplace_back(aside.y(), p.z());
  });
  return section;
}

// The README of the recordings: a quay wall 3.0 m to starboard, a floor that the sonar itself finds 8.4 to 8.8 m below
// the water between the wall and 8 m to port. Default settings, five pings of a second each.
// ledger: S5-07 S5-13 S5-16
TEST(EchoSounder, ShowsTheQuayWallAndTheFloorOfAHarbour) {
  ISOBATH_NEEDS_DATA(folder, "kongsberg-pings");
  const Section harbour = section_of(folder / "em2042-harbour-a.kmall");
  EXPECT_EQ(harbour.counts.vertical, 5u);
  EXPECT_EQ(harbour.counts.pings, 0u);
  ASSERT_EQ(harbour.outcome.layers.size(), 1u);
  const auto wall = [](double depth) { return Eigen::Vector2d(3.0, depth); };
  const auto floor = [](double starboard) { return Eigen::Vector2d(starboard, 8.6); };
  EXPECT_EQ(harbour.filled(3.2, 8.0, 0.2, wall, 0.2), 1) << "every band of 0.2 m of the wall, within 0.2 m of it";
  EXPECT_EQ(harbour.filled(-8, 2.6, 0.2, floor, 0.4), 1);
  const auto off = [](const Eigen::Vector2d& p) { return p.x() < 2.6 && p.y() > 2.2 && p.y() < 8.0; };
  EXPECT_LT(harbour.share(off), 0.2) << "in the water between the wall and the vehicle's port side";
  EXPECT_GT(harbour.outcome.free, 8000u) << "what lies between is known to be free";
}

// The sonar changes its frequency, its beams and its bins from ping to ping: one layer for the modes whose beams are
// about as wide, one for that whose are half as wide. The sonar's soundings lie 8.6 to 8.8 m below the water.
// ledger: S5-07 S5-13
TEST(EchoSounder, ShowsAFlatFloorThroughFourModes) {
  ISOBATH_NEEDS_DATA(folder, "kongsberg-pings");
  const Section harbour = section_of(folder / "em2042-harbour-c.kmall");
  EXPECT_EQ(harbour.counts.vertical, 5u);
  ASSERT_EQ(harbour.outcome.layers.size(), 2u);
  EXPECT_EQ(harbour.outcome.layers[0].pings, 4u);
  const auto floor = [](double starboard) { return Eigen::Vector2d(starboard, 8.65); };
  EXPECT_GT(harbour.filled(-6, 6, 0.25, floor, 0.4), 0.95);
  const auto off = [](const Eigen::Vector2d& p) { return p.y() > 2.2 && p.y() < 8.0; };
  EXPECT_LT(harbour.share(off), 0.2);
}

}  // namespace
}  // namespace isobath

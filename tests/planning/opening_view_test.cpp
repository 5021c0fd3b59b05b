// What a pair of fans knows of an opening, and what a map says of the water before it.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/planning/awareness.hpp>
#include <isobath/planning/opening_view.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

Vector3d direction(double azimuth_deg, double elevation_deg) {
  const Angle a = Angle::degrees(azimuth_deg), e = Angle::degrees(elevation_deg);
  return {cos(e) * cos(a), cos(e) * sin(a), -sin(e)};
}

// ledger: S5-03 S5-05 S5-08
TEST(FanPair, HasTheEdgesOfItsSectors) {
  const FanPair fans;
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(in_horizontal_fan(fans, direction(side * 44.9, 0)));
    EXPECT_FALSE(in_horizontal_fan(fans, direction(side * 45.1, 0)));
    EXPECT_TRUE(in_horizontal_fan(fans, direction(20, side * 7.4)));
    EXPECT_FALSE(in_horizontal_fan(fans, direction(20, side * 7.6)));
    EXPECT_TRUE(in_vertical_fan(fans, direction(side * 7.4, -5)));
    EXPECT_FALSE(in_vertical_fan(fans, direction(side * 7.6, -5)));
  }
  EXPECT_TRUE(in_vertical_fan(fans, direction(0, 17.5)));
  EXPECT_FALSE(in_vertical_fan(fans, direction(0, 18.5)));
  EXPECT_TRUE(in_vertical_fan(fans, direction(0, -27.5)));
  EXPECT_FALSE(in_vertical_fan(fans, direction(0, -28.5)));
}

// From the middle line the common beam is a rectangle of the opening, of a width that is known. ledger: S5-09 S5-40
TEST(OpeningView, OnAStraightLineKnowsTheBeamsWidthAndNoMore) {
  const Opening opening{{Rotation::from_heading(Angle::degrees(50)), {100, 30, 4}}, 25, 8};
  OpeningView view(opening, {}, 0.1);
  double last = 0;
  for (double distance = 80; distance > 0.5; distance -= 1) {
    view.look({opening.X_WO.rotation, opening.X_WO * Vector3d(-distance, 0, 0)});
    EXPECT_GE(view.known_share(), last);
    last = view.known_share();
    if (distance > 60.01) {
      EXPECT_EQ(last, 0) << "too far away to count";
    }
  }
  // 60 m tan 7.5 deg to each side, but for the corners that lie beyond the range.
  EXPECT_NEAR(last, 2 * 59 * std::tan(Angle::degrees(7.5).radians()) / 25, 0.01);
}

// From any place and attitude, against the angles of each cell. ledger: S5-40
TEST(OpeningView, AgreesWithTheAnglesOfEachCell) {
  Random random(8);
  const Opening opening{{Rotation::from_heading(Angle::degrees(-20)), {5, 6, 7}}, 20, 12};
  const FanPair fans;
  std::size_t seen = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const double back = random.uniform(5, 55);
    const double aside = random.uniform(-6, 6);
    const double below = random.uniform(-4, 4);
    const Vector3d p_W = opening.X_WO * Vector3d(-back, aside, below);
    const double heading = random.uniform(-45, 5);
    const double pitch = random.uniform(-20, 20);
    const double roll = random.uniform(-20, 20);
    const Pose X_WB{
        Rotation::from_heading_pitch_roll(Angle::degrees(heading), Angle::degrees(pitch), Angle::degrees(roll)), p_W};
    OpeningView view(opening, fans, 0.5);
    view.look(X_WB);
    for (int row = 0; row < view.rows(); ++row) {
      for (int column = 0; column < view.columns(); ++column) {
        const Vector3d p_O(0, -10 + 0.5 * (column + 0.5), -6 + 0.5 * (row + 0.5));
        const Vector3d u = X_WB.inverse() * (opening.X_WO * p_O);
        const double azimuth = std::atan2(u.y(), u.x()), elevation = -std::asin(u.z() / u.norm());
        // Of the vertical fan: the same about axes pitched by -5 degrees.
        const Vector3d v = Rotation::from_heading_pitch_roll({}, Angle::degrees(-5), {}).inverse() * u;
        const double in_plane = std::atan2(-v.z(), v.x()), across = std::asin(v.y() / v.norm());
        const auto deg = [](double radians) { return std::abs(Angle::radians(radians).degrees()); };
        const bool both =
            u.norm() <= 60 && deg(azimuth) <= 45 && deg(elevation) <= 7.5 && deg(in_plane) <= 23 && deg(across) <= 7.5;
        EXPECT_EQ(view.known_since(row, column) == 1, both);
        seen += both;
      }
    }
  }
  EXPECT_GT(seen, 500u);
}

// ledger: S5-46
TEST(HelixWorth, TradesWayForSight) {
  const Opening opening{{Rotation(), {0, 0, 4}}, 25, 8};
  const HelixWorth line = helix_worth({6, 0, 0}, opening, 20), fitting = helix_worth({6, 1.5, 0}, opening, 20),
                   paper = helix_worth({6, 4, 2}, opening, 20);
  EXPECT_DOUBLE_EQ(line.stretch, 1);
  EXPECT_LT(line.known_share, 0.7);
  EXPECT_GT(fitting.known_share, 0.9);
  EXPECT_LT(fitting.stretch, 1.03);
  EXPECT_NEAR(paper.stretch, 42.57 / 37.70, 0.001);
  EXPECT_LT(paper.known_share, fitting.known_share) << "a swing beyond the edges looks past the middle";
  double stretch = 0;
  for (double lateral = 0; lateral < 6; lateral += 0.5) {
    const HelixWorth worth = helix_worth({6, lateral, 0}, opening, 20);
    EXPECT_GT(worth.stretch, stretch);
    stretch = worth.stretch;
  }
}

TEST(OpeningView, RefusesAnOpeningWithoutASize) {
  EXPECT_THROW(OpeningView(Opening{{}, 0, 8}), Error);
  EXPECT_THROW(OpeningView(Opening{{}, 25, 8}, {}, 0), Error);
}

// Every voxel by hand, in a box that stands askew. ledger: S5-58
TEST(Awareness, IsTheEntropyOfItsVoxels) {
  VoxelMap map({0.5, 0.3, 0.98, 0.2, 6.9});
  Random random(6);
  for (int i = 0; i < 4000; ++i) {
    const int x = static_cast<int>(random.index(30)) - 5;
    const int y = static_cast<int>(random.index(30)) - 15;
    const int z = static_cast<int>(random.index(16));
    const double evidence = random.uniform(-4, 6);
    map.layer("any").add({x, y, z}, to_evidence(evidence));
  }
  const WaterBox box{{Rotation::from_heading(Angle::degrees(30)), {4, 1, 4}}, {12, 7, 6}};
  const Awareness a = awareness(map, box);
  std::size_t voxels = 0, known = 0, free = 0;
  double bits = 0;
  const double c = std::cos(Angle::degrees(30).radians()), s = std::sin(Angle::degrees(30).radians());
  for (int x = -40; x < 60; ++x) {
    for (int y = -40; y < 60; ++y) {
      for (int z = -40; z < 60; ++z) {
        const double dx = 0.5 * (x + 0.5) - 4, dy = 0.5 * (y + 0.5) - 1, dz = 0.5 * (z + 0.5) - 4;
        if (std::abs(c * dx + s * dy) > 6 || std::abs(c * dy - s * dx) > 3.5 || std::abs(dz) > 3) continue;
        ++voxels;
        const double p = map.probability({x, y, z});
        bits -= p * std::log2(p) + (1 - p) * std::log2(1 - p);
        known += map.space({x, y, z}) != Space::kUnknown;
        free += map.space({x, y, z}) == Space::kFree;
      }
    }
  }
  EXPECT_EQ(a.voxels, voxels);
  EXPECT_NEAR(a.entropy_bits, bits, 1e-9 * bits);
  EXPECT_NEAR(a.known_share, static_cast<double>(known) / static_cast<double>(voxels), 1e-12);
  EXPECT_NEAR(a.free_share, static_cast<double>(free) / static_cast<double>(voxels), 1e-12);
  EXPECT_GT(known, free);
}

// ledger: S5-58
TEST(Awareness, OfAnUntouchedMapIsOneBitAVoxel) {
  const VoxelMap map({1, 0.5, 0.98, 0.2, 6.9});
  const Awareness a = awareness(map, {{Rotation(), {0, 0, 0}}, {4, 4, 4}});
  EXPECT_EQ(a.voxels, 64u);
  EXPECT_DOUBLE_EQ(a.bits_a_voxel(), 1);
  EXPECT_EQ(a.known_share, 0);
}

}  // namespace
}  // namespace isobath

// Quarantine of depths that nothing around them supports.
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/perception/sounding_gate.hpp>
#include <limits>
#include <vector>

namespace isobath {
namespace {

using Verdict = SoundingGate::Verdict;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Three readings that agree: the gate knows where it is.
SoundingGate settled(double depth_m, const SoundingGateConfig& config = {}) {
  SoundingGate gate(config);
  for (int i = 0; i < config.accept_after; ++i) gate.judge(0, {0.5 * i, 0, depth_m});
  return gate;
}

// ledger: S1-72
TEST(SoundingGate, the_first_readings_are_believed_when_they_agree_among_themselves) {
  SoundingGate gate({});
  EXPECT_EQ(gate.judge(0, {0, 0, 9}), Verdict::kHeld);
  EXPECT_EQ(gate.judge(0, {0.5, 0, 9.2}), Verdict::kHeld);
  EXPECT_EQ(gate.judge(0, {1, 0, 9.1}), Verdict::kConfirmed);
  EXPECT_EQ(gate.judge(0, {1.5, 0, 9.3}), Verdict::kBelieved);
}

// ledger: S1-72
TEST(SoundingGate, one_wild_depth_is_held_and_the_next_good_one_is_believed_at_once) {
  SoundingGate gate = settled(9);
  EXPECT_EQ(gate.judge(0, {2, 0, 300}), Verdict::kHeld);
  EXPECT_EQ(gate.judge(0, {2.5, 0, 9.1}), Verdict::kBelieved);
  EXPECT_EQ(gate.judge(0, {3, 0, 300}), Verdict::kHeld) << "the row begins anew";
  EXPECT_EQ(gate.judge(0, {3.5, 0, 100}), Verdict::kHeld) << "these two do not agree: a row of one";
  EXPECT_EQ(gate.judge(0, {4, 0, 100.5}), Verdict::kHeld);
  EXPECT_EQ(gate.judge(0, {4.5, 0, 101}), Verdict::kConfirmed);
}

// ledger: S1-72
TEST(SoundingGate, a_quay_wall_is_believed_after_three_and_a_slope_without_any) {
  SoundingGate gate = settled(9);
  EXPECT_EQ(gate.judge(0, {1.5, 0, 2}), Verdict::kHeld);
  EXPECT_EQ(gate.judge(0, {2, 0, 2}), Verdict::kHeld);
  EXPECT_EQ(gate.judge(0, {2.5, 0, 2}), Verdict::kConfirmed);
  SoundingGate slope = settled(9);  // 1 in 2 down from 1 m north: within the steepest that needs no proof
  for (double north = 1.5; north < 40; north += 1.5) {
    EXPECT_EQ(slope.judge(0, {north, 0, 9 + 2 * (north - 1)}), Verdict::kBelieved) << north;
  }
}

// ledger: S1-72
TEST(SoundingGate, the_limit_is_the_slack_plus_the_slope_and_grows_with_depth) {
  SoundingGateConfig config;
  config.max_slope = 1;
  const auto judged = [&](double from, double to, double distance) {
    SoundingGate gate = settled(from, config);  // last at 1 m north
    return gate.judge(0, {1 + distance, 0, to});
  };
  EXPECT_EQ(judged(5, 6.49, 0), Verdict::kBelieved);
  EXPECT_EQ(judged(5, 6.51, 0), Verdict::kHeld);
  EXPECT_EQ(judged(5, 8.49, 2), Verdict::kBelieved);
  EXPECT_EQ(judged(5, 8.51, 2), Verdict::kHeld);
  EXPECT_EQ(judged(100, 115, 0), Verdict::kBelieved);  // 15 % of the deeper
  EXPECT_EQ(judged(100, 118, 0), Verdict::kHeld);
}

// ledger: S1-72
TEST(SoundingGate, impossible_depths_are_told_apart_and_change_nothing) {
  SoundingGateConfig lake;
  lake.max_depth_m = 60;
  SoundingGate gate = settled(9, lake);
  for (const double depth : {300.0, -10.1, kNaN, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(gate.judge(0, {1.5, 0, depth}), Verdict::kImpossible) << depth;
  }
  EXPECT_EQ(gate.judge(0, {1.5, 0, 9}), Verdict::kBelieved);
}

// ledger: S1-72
TEST(SoundingGate, sensors_do_not_vouch_for_one_another) {
  SoundingGate gate = settled(9);
  EXPECT_EQ(gate.judge(1, {1, 0, 9}), Verdict::kHeld);
  EXPECT_EQ(gate.judge(0, {1, 0, 9}), Verdict::kBelieved);
  EXPECT_EQ(gate.judge(SoundingGate::kSensors - 1, {1, 0, 9}), Verdict::kHeld);
}

// ledger: S1-72
TEST(SoundingGate, beams_of_a_swath_are_judged_by_their_neighbours) {
  SoundingGate gate({});
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 64; ++i) points.emplace_back(0, 0.5 * (i - 32), 20 + 0.2 * i);  // a slope across the track
  std::vector<std::uint8_t> believed(points.size());
  gate.judge_swath(points, believed);
  EXPECT_EQ(std::count(believed.begin(), believed.end(), 1), 64);
  points[0].z() = 45;
  points[20].z() = 45;
  points[21].z() = 2;
  points[63].z() = kNaN;
  gate.judge_swath(points, believed);
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_EQ(believed[i], i != 0 && i != 20 && i != 21 && i != 63) << i;
  }
  // A wall: half of the beams lie 12 m higher, and all are right.
  for (int i = 0; i < 64; ++i) points[static_cast<std::size_t>(i)].z() = i < 32 ? 20 : 8;
  gate.judge_swath(points, believed);
  EXPECT_EQ(std::count(believed.begin(), believed.end(), 1), 64);
  gate.judge_swath({}, {});
}

}  // namespace
}  // namespace isobath

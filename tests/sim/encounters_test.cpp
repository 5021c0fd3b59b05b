// The situations of encounters, against the list of DNV's baseline situations and the geometry of a meeting.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/sim/encounters.hpp>
#include <set>

namespace isobath::encounters {
namespace {

using Eigen::Vector2d;

const EncounteredVehicle kVehicle{.start_W = {3, -4}, .course = Angle::degrees(20), .speed = 1.5};
constexpr double kDuration_s = 120;

Vector2d ahead(Angle course) { return {cos(course), sin(course)}; }

/// What a target does, from its path.
struct Course {
  explicit Course(const Body& body) : start_W(body.path[1], body.path[2]) {
    velocity_W = (Vector2d(body.path[5], body.path[6]) - start_W) / (body.path[4] - body.path[0]);
    const Vector2d to = start_W - kVehicle.start_W;
    bearing_deg = (Angle::radians(std::atan2(to.y(), to.x())) - kVehicle.course).wrapped().degrees();
    const Angle course = Angle::radians(std::atan2(velocity_W.y(), velocity_W.x()));
    aspect_deg = std::abs((Angle::radians(std::atan2(-to.y(), -to.x())) - course).wrapped().degrees());
    const Vector2d relative = velocity_W - kVehicle.speed * ahead(kVehicle.course);
    meeting_s = -to.dot(relative) / relative.squaredNorm();
    miss_m = (to + meeting_s * relative).norm();
  }
  Vector2d start_W, velocity_W;
  double bearing_deg, aspect_deg, meeting_s, miss_m;
};

TEST(Encounters, HaveFiftyFiveDistinctSituations) {
  const auto& all = encounter_situations();
  ASSERT_EQ(all.size(), 55u);
  std::set<EncounterSituation> distinct;
  for (EncounterSituation situation : all) {
    std::sort(situation.begin(), situation.end());
    distinct.insert(situation);
  }
  EXPECT_EQ(distinct.size(), 55u);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const auto& s) { return s.size() == 1; }), 5);
  EXPECT_EQ(std::count_if(all.begin(), all.end(), [](const auto& s) { return s.size() == 2; }), 15);
}

// The titles of the baseline situations of DNV's Ship Traffic Generator, by number from 1.
TEST(Encounters, FollowTheOrderOfTheBaselineSituations) {
  const auto& all = encounter_situations();
  const auto title = [&all](std::size_t number) { return to_text(all[number - 1]); };
  EXPECT_EQ(title(1), "head-on");
  EXPECT_EQ(title(5), "overtaking");
  EXPECT_EQ(title(7), "head-on, crossing from starboard");
  EXPECT_EQ(title(15), "crossing from port, crossing from port");
  EXPECT_EQ(title(16), "crossing from port, overtaking");
  EXPECT_EQ(title(17), "crossing from port, overtaken");
  EXPECT_EQ(title(21), "head-on, head-on, head-on");
  EXPECT_EQ(title(31), "head-on, crossing from port, overtaking");
  EXPECT_EQ(title(32), "head-on, crossing from port, overtaken");
  EXPECT_EQ(title(36), "crossing from starboard, crossing from starboard, crossing from starboard");
  EXPECT_EQ(title(40), "crossing from starboard, crossing from port, crossing from port");
}

// ledger: S3-01
TEST(Encounters, MeetAVehicleThatGoesStraight) {
  const EncounterConfig config;
  for (std::uint64_t seed = 0; seed < 4 * 55; ++seed) {
    const EncounterSituation& situation = encounter_situations()[seed % 55];
    const std::vector<Body> bodies = encounter_bodies(config, situation, kVehicle, seed, kDuration_s);
    ASSERT_EQ(bodies.size(), situation.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Course course(bodies[i]);
      EXPECT_LT(course.miss_m, 0.05) << bodies[i].name;
      EXPECT_GE(course.meeting_s, config.meeting_s[0] - 0.2) << bodies[i].name;
      EXPECT_LE(course.meeting_s, config.meeting_s[1] + 0.2) << bodies[i].name;
      EXPECT_GE((course.start_W - kVehicle.start_W).norm(), config.free_m + config.radius_m - 0.01);
      EXPECT_EQ(bodies[i].path[4], kDuration_s);
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_GT((course.start_W - Course(bodies[k]).start_W).norm(), 2 * config.radius_m) << bodies[i].name;
      }
    }
  }
}

TEST(Encounters, AreSeenWithinTheBoundsOfTheirKind) {
  for (std::uint64_t seed = 0; seed < 4 * 55; ++seed) {
    const EncounterSituation& situation = encounter_situations()[seed % 55];
    const std::vector<Body> bodies = encounter_bodies({}, situation, kVehicle, seed, kDuration_s);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Course course(bodies[i]);
      const EncounterBounds& bounds = encounter_bounds(situation[i]);
      double bearing_deg = course.bearing_deg;
      if (situation[i] == EncounterKind::kOvertaking && bearing_deg < 0) bearing_deg += 360;
      const double ratio = course.velocity_W.norm() / kVehicle.speed;
      EXPECT_GE(bearing_deg, bounds.bearing_deg[0] - 0.2) << bodies[i].name;
      EXPECT_LE(bearing_deg, bounds.bearing_deg[1] + 0.2) << bodies[i].name;
      EXPECT_GE(ratio, bounds.speed_ratio[0] - 0.001) << bodies[i].name;
      EXPECT_LE(ratio, bounds.speed_ratio[1] + 0.001) << bodies[i].name;
      EXPECT_GE(course.aspect_deg, bounds.aspect_deg[0] - 0.2) << bodies[i].name;
      EXPECT_LE(course.aspect_deg, bounds.aspect_deg[1] + 0.2) << bodies[i].name;
    }
  }
}

TEST(Encounters, AreNamedByKindAndNumber) {
  const EncounterSituation situation{EncounterKind::kHeadOn, EncounterKind::kFromStarboard, EncounterKind::kOvertaking};
  const std::vector<Body> bodies = encounter_bodies({}, situation, kVehicle, 1, kDuration_s);
  EXPECT_EQ(bodies[0].name, "head-on 1");
  EXPECT_EQ(bodies[1].name, "crossing from starboard 2");
  EXPECT_EQ(bodies[2].name, "overtaking 3");
  const auto& shape = std::get<Cylinder>(bodies[0].shape);
  EXPECT_EQ(shape.radius, 0.5);
  EXPECT_EQ(shape.centre.z(), 15);
  EXPECT_EQ(shape.length, 30);
}

TEST(Encounters, AreRefusedWhereATargetHasNoPlace) {
  EncounterConfig config;
  config.free_m = 500;
  EXPECT_THROW((void)encounter_bodies(config, {EncounterKind::kHeadOn}, kVehicle, 1, kDuration_s), Error);
  config = {};
  config.bottom_m = config.top_m;
  EXPECT_THROW((void)encounter_bodies(config, {EncounterKind::kHeadOn}, kVehicle, 1, kDuration_s), Error);
}

}  // namespace
}  // namespace isobath::encounters

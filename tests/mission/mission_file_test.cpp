// Missions as TOML: what is read, what is refused and where, and that writing loses nothing.
#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <tests/support/data.hpp>

namespace isobath::mission_file_test {
namespace {

using Eigen::Vector2d;

constexpr const char* kMission = R"([mission]
title = "round the reef"
speed = 1.2
at_end = "return"
if_dropped = "surface"

[mission_limits]
max_depth_m = 20.0
min_altitude_m = 2.0

[geofence]
corners = [[-50, -50], [-50, 150], [150, 150], [150, -50]]

[[mission_point]]
name = "north"
north = 100.0
depth_m = 3.0
hold_s = 30.0
move_m = 15.0

[[mission_point]]
north = 100.0
east = 100.0
altitude_m = 4.0
speed = 0.8
task = "survey length_m=40"

[[injected_map]]
outline = [[40, -5], [40, 5], [60, 5], [60, -5]]

[[injected_map]]
at_s = 10.0
outline = [[0, 20], [10, 20], [10, 30]]
)";

std::string refusal(const std::string& text) {
  try {
    (void)parse_mission(text, "m.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// kMission with one line replaced.
std::string with(const std::string& line, const std::string& other) {
  std::string text = kMission;
  const std::size_t at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size(), other);
}

// ledger: S6-43 S6-58 S6-65 S6-E21
TEST(MissionFile, HoldsPointsFenceLimitsAndMapsToInject) {
  const MissionPlan plan = parse_mission(kMission, "m.toml");
  EXPECT_EQ(plan.title, "round the reef");
  EXPECT_EQ(plan.speed, 1.2);
  EXPECT_EQ(plan.at_end, MissionEnd::kReturn);
  EXPECT_EQ(plan.if_dropped, MissionEnd::kSurface);
  EXPECT_EQ(plan.limits.max_depth_m, 20);
  EXPECT_EQ(plan.fence.size(), 4u);
  ASSERT_EQ(plan.points.size(), 2u);
  EXPECT_EQ(plan.points[0].name, "north");
  EXPECT_EQ(plan.points[0].north_east, Vector2d(100, 0));
  EXPECT_EQ(plan.points[0].move_m, 15);
  EXPECT_EQ(plan.points[0].hold_s, 30);
  EXPECT_FALSE(plan.points[0].altitude_m.has_value());
  EXPECT_EQ(plan.points[1].name, "point 2");
  EXPECT_EQ(plan.points[1].altitude_m, 4);
  EXPECT_EQ(plan.points[1].speed, 0.8);
  EXPECT_EQ(plan.points[1].task, "survey length_m=40");
  EXPECT_EQ(plan.points[1].place.line, 21u);
  ASSERT_EQ(plan.injected.size(), 1u) << "both stand at 10 s: one map";
  EXPECT_EQ(plan.injected[0].at_s, 10);
  ASSERT_EQ(plan.injected[0].outlines.size(), 2u);
  EXPECT_GT(area(plan.injected[0].outlines[0]), 0);
  EXPECT_DOUBLE_EQ(area(plan.injected[0].outlines[1]), 50);
  EXPECT_FALSE(plan.origin.has_value());
  EXPECT_EQ(plan.import.text(), "");
}

// ledger: S6-43
TEST(MissionFile, RefusesWithLineAndReason) {
  using testing::HasSubstr;
  struct Case {
    const char *line, *instead, *where, *what;
  };
  const Case cases[] = {
      {"north = 100.0\ndepth_m", "north = 151.0\ndepth_m", "m.toml:14:1", "1.00 m outside the fence"},
      {"depth_m = 3.0", "depth_m = 21.0", "m.toml:14:1: mission_point.depth_m", "21 m of depth; allowed: 0 .. 20 m"},
      {"altitude_m = 4.0", "altitude_m = 1.0", "m.toml:21:1: mission_point.altitude_m", "1 m above the bottom"},
      {"[[-50, -50], [-50, 150], [150, 150], [150, -50]]", "[[-50, -50], [-50, 150]]", "m.toml:11:1",
       "fewer than 3 corners"},
      {"[[-50, -50], [-50, 150], [150, 150], [150, -50]]", "[[-50, -50], [150, 150], [-50, 150], [150, -50]]",
       "m.toml:11:1: geofence.corners", "crosses or touches itself"},
      {"speed = 1.2", "speed = 0.0", "m.toml:3:9", "out of range"},
      {"speed = 1.2", "speed = nan", "m.toml:3:9", "not a number"},
      {"north = 100.0\ndepth_m", "north = inf\ndepth_m", "m.toml:16:9", "out of range"},
      {"max_depth_m = 20.0", "min_depth_m = 200.0", "mission_limits.max_depth_m", "does not lie below"},
      {"[[0, 20], [10, 20], [10, 30]]", "[[0, 20], [10, 20]]", "m.toml:31:1", "fewer than 3 corners"},
      {"[[40, -5], [40, 5], [60, 5], [60, -5]]", "[[40, -5], [40, 5], [45, 0], [60, -5]]", "m.toml:28:1", "not convex"},
      {"move_m = 15.0", "move = 15.0", "m.toml:19:1: mission_point.move", "did you mean move_m?"},
      {"at_end = \"return\"", "at_end = \"home\"", "m.toml:4:10", "hold, surface or return"},
      {"north = 100.0\ndepth_m", "latitude_deg = 1.2\ndepth_m", "m.toml:14:1", "without an origin"},
  };
  for (const Case& c : cases) {
    const std::string said = refusal(with(c.line, c.instead));
    EXPECT_THAT(said, HasSubstr(c.where)) << c.instead;
    EXPECT_THAT(said, HasSubstr(c.what)) << c.instead;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
  EXPECT_THAT(refusal("[mission]\n"), HasSubstr("m.toml:1:1: mission: the mission has no points"));
}

// The check stands for plans that no file made, too. ledger: S6-43
TEST(MissionFile, PlansFromElsewhereAreHeldToTheSame) {
  const MissionPlan good = parse_mission(kMission, "m.toml");
  const double nan = std::nan("");
  const auto refused = [&](auto change) {
    MissionPlan plan = good;
    change(plan);
    try {
      check_mission(plan);
    } catch (const Error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused([](MissionPlan&) {}));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.points[0].north_east.x() = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.points[0].depth_m = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.points[1].altitude_m = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.points[1].speed = -1; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.points[1].hold_s = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.points[1].move_m = -1; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.speed = 0; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.limits.low_battery_share = 2; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.limits.max_position_sigma_m = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.fence[0].x() = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.injected[0].at_s = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.injected[0].outlines[0][0].x() = nan; }));
  EXPECT_TRUE(refused([&](MissionPlan& p) { p.origin = GeoOrigin{91, 0}; }));
  EXPECT_TRUE(refused([](MissionPlan& p) { p.fence.assign(kMaxFenceCorners + 1, Vector2d(0, 0)); }));
}

// ledger: S6-43
TEST(MissionFile, TakesDegreesWhereThereIsAnOrigin) {
  const std::string text = R"([mission]
latitude_deg = 1.2155
longitude_deg = 103.8509
[geofence]
corners_deg = [[1.21, 103.845], [1.21, 103.86], [1.22, 103.86], [1.22, 103.845]]
[[mission_point]]
latitude_deg = 1.2165
longitude_deg = 103.8509
[[mission_point]]
north = 20
east = 30
)";
  const MissionPlan plan = parse_mission(text, "m.toml");
  ASSERT_TRUE(plan.origin.has_value());
  // A minute of latitude is 1842.9 m near the equator (WGS 84).
  EXPECT_NEAR(plan.points[0].north_east.x(), 0.06 * 1842.9, 0.01);
  EXPECT_NEAR(plan.points[0].north_east.y(), 0, 1e-6);
  EXPECT_EQ(plan.points[1].north_east, Vector2d(20, 30));
  EXPECT_EQ(plan.fence.size(), 4u);
  EXPECT_THAT(
      refusal(text + "[[mission_point]]\nnorth = 1\nlatitude_deg = 1.2\nlongitude_deg = 103.8\n"),
      testing::HasSubstr("m.toml:12:1: mission_point.latitude_deg: the point is given in degrees and in metres"));
  EXPECT_THAT(refusal(text + "[[mission_point]]\nlatitude_deg = 12\nlongitude_deg = 103.8\n"),
              testing::HasSubstr("far from the origin"));
}

bool same(const MissionPoint& a, const MissionPoint& b) {
  return a.name == b.name && a.north_east == b.north_east && a.depth_m == b.depth_m && a.altitude_m == b.altitude_m &&
         a.speed == b.speed && a.hold_s == b.hold_s && a.move_m == b.move_m && a.task == b.task;
}

void expect_same(const MissionPlan& a, const MissionPlan& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.speed, b.speed);
  EXPECT_EQ(a.at_end, b.at_end);
  EXPECT_EQ(a.if_dropped, b.if_dropped);
  EXPECT_EQ(a.waits_for_operator, b.waits_for_operator);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.fence, b.fence);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) EXPECT_TRUE(same(a.points[i], b.points[i])) << i;
  ASSERT_EQ(a.injected.size(), b.injected.size());
  for (std::size_t i = 0; i < a.injected.size(); ++i) {
    EXPECT_EQ(a.injected[i].at_s, b.injected[i].at_s);
    EXPECT_EQ(a.injected[i].outlines, b.injected[i].outlines);
  }
  EXPECT_EQ(a.limits.max_duration_s, b.limits.max_duration_s);
  EXPECT_EQ(a.limits.min_altitude_m, b.limits.min_altitude_m);
  EXPECT_EQ(a.limits.low_battery_share, b.limits.low_battery_share);
  EXPECT_EQ(a.limits.min_depth_m, b.limits.min_depth_m);
  EXPECT_EQ(a.limits.max_depth_m, b.limits.max_depth_m);
  EXPECT_EQ(a.limits.max_position_sigma_m, b.limits.max_position_sigma_m);
}

MissionPlan random_plan(Random& random) {
  MissionPlan plan;
  plan.title = "a \"title\" with \\ and \t and \xc3\xa9";
  plan.speed = random.uniform(0.1, 3);
  plan.at_end = static_cast<MissionEnd>(random.index(3));
  plan.if_dropped = static_cast<MissionEnd>(random.index(3));
  plan.waits_for_operator = random.index(2) == 1;
  plan.limits.max_duration_s = random.uniform(0, 1e4);
  plan.limits.low_battery_share = random.uniform();
  if (random.index(2) == 0) plan.origin = GeoOrigin{-33.123456789012345, 151.2};
  if (random.index(2) == 0) plan.fence = {{-200, -200}, {-200, 200.1}, {200, 200}, {0, 0.3}, {200, -200}};
  const std::uint64_t points = 1 + random.index(6);
  for (std::uint64_t i = 0; i < points; ++i) {
    MissionPoint point;
    point.name = "point " + std::to_string(i);
    const double north = random.uniform(-150, -50);
    point.north_east = {north, random.uniform(-40, 40)};
    point.depth_m = random.uniform(0, 50);
    if (random.index(2) == 0) point.altitude_m = random.uniform(1, 20);
    point.speed = random.uniform(0, 2);
    point.hold_s = random.uniform(0, 100);
    point.move_m = random.uniform(0, 30);
    point.task = random.index(2) == 0 ? "" : "circle radius_m=8";
    plan.points.push_back(point);
  }
  for (std::uint64_t i = 0; i < random.index(3); ++i) {
    plan.injected.push_back({{}, random.uniform(0, 100), {{{0, 0}, {1, 0}, {0.1, 1}}, {{5, 5}, {6, 5}, {6, 6}}}});
  }
  return plan;
}

// ledger: S6-43
TEST(MissionFile, WhatIsWrittenReadsBackTheSame) {
  expect_same(parse_mission(write_mission(parse_mission(kMission, "a")), "b"), parse_mission(kMission, "a"));
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const MissionPlan plan = random_plan(random);
    const std::string text = write_mission(plan);
    const MissionPlan again = parse_mission(text, "again");
    expect_same(again, plan);
    EXPECT_EQ(write_mission(again), text);
  }
}

TEST(MissionFile, JoinsASchemaOfOtherSections) {
  const std::string text = std::string("[scene]\nseed = 7\n") + kMission;
  int seed = 0;
  MissionKeys keys;
  Schema both = schema(keys);
  both.sections.insert(both.sections.begin(), {"scene", "", {Field::integer("seed", &seed, {0, 9}, "", "")}});
  read_toml(text, "both.toml", both);
  const MissionPlan plan = make_plan(keys, both, GeoOrigin{10, 20});
  check_mission(plan);
  EXPECT_EQ(seed, 7);
  EXPECT_EQ(plan.points.size(), 2u);
  EXPECT_EQ(plan.fence_place.line, 13u);
  EXPECT_EQ(plan.origin, (GeoOrigin{10, 20}));
  EXPECT_TRUE(looks_like_mission(text));
  EXPECT_FALSE(looks_like_mission("[scene]\n# not a [mission]\n"));
}

TEST(MissionPlan, KeepsItsPlacesOnTheGlobeOnThePlaneOfAnotherOrigin) {
  MissionPlan plan = parse_mission(kMission, "mission");
  const GeoOrigin here{52.34, 13}, there{52.35, 12.99};
  EXPECT_EQ(on_plane_of(plan, there).points[0].north_east, plan.points[0].north_east) << "without an origin";
  plan.origin = here;
  plan.injected.push_back({{}, 10, {{{0, 0}, {5, 0}, {5, 5}}}});
  const MissionPlan moved = on_plane_of(plan, there);
  EXPECT_EQ(moved.origin, there);
  const LocalPlane before(here), after(there);
  for (std::size_t i = 0; i < plan.points.size(); ++i) {
    EXPECT_LT(distance_m(before.to_geo(plan.points[i].north_east), after.to_geo(moved.points[i].north_east)), 1e-6);
  }
  EXPECT_LT(distance_m(before.to_geo(plan.fence[2]), after.to_geo(moved.fence[2])), 1e-6);
  EXPECT_NEAR(moved.injected.back().outlines[0][0].x(), -1113, 1);  // 0.01 degrees of latitude
  EXPECT_EQ(on_plane_of(plan, {52.340005, 13}).points[0].north_east, plan.points[0].north_east) << "within a metre";
  EXPECT_THROW(on_plane_of(plan, {54, 13}), Error);
}

/// The block of TOML of the page that documents the format.
std::vector<std::string> toml_blocks(const std::string& page) {
  std::vector<std::string> blocks;
  for (std::size_t at = page.find("```toml\n"); at != std::string::npos; at = page.find("```toml\n", at)) {
    at += 8;
    blocks.push_back(page.substr(at, page.find("```", at) - at));
  }
  return blocks;
}

// The page shows an example that can be read, and every key as the schema has it.
TEST(MissionFile, ThePageOfTheFormatIsCurrent) {
  const std::vector<std::string> blocks =
      toml_blocks(text_of_file((test::source_folder() / "docs/mission-format.md").string()));
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(parse_mission(blocks[0], "the example").points.size(), 3u);
  MissionKeys keys;
  EXPECT_EQ(blocks[1], write_template(schema(keys)));
}

}  // namespace
}  // namespace isobath::mission_file_test

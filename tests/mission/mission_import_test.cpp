// Missions of QGroundControl and MOOS: what is taken, what is left out, and that it is said.
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/mission/plan/mission_import.hpp>
#include <nlohmann/json.hpp>
#include <tests/support/data.hpp>

namespace isobath::mission_import_test {
namespace {

using Eigen::Vector2d;
using nlohmann::json;
using testing::HasSubstr;

constexpr double kLatitude = 1.2155, kLongitude = 103.8509;

/// A place in degrees, so many metres north and east of the home.
GeoPoint at(double north, double east) { return LocalPlane({kLatitude, kLongitude}).to_geo({north, east}); }

json item(int command, double north, double east, double z, int frame = 3, double first = 0) {
  const GeoPoint p = at(north, east);
  return {{"type", "SimpleItem"},
          {"autoContinue", true},
          {"command", command},
          {"frame", frame},
          {"params", {first, 0, 0, nullptr, p.latitude_deg, p.longitude_deg, z}}};
}

json plan_of(const json& items) {
  return {{"fileType", "Plan"},
          {"version", 1},
          {"groundStation", "QGroundControl"},
          {"geoFence", {{"circles", json::array()}, {"polygons", json::array()}, {"version", 2}}},
          {"rallyPoints", {{"points", json::array()}, {"version", 2}}},
          {"mission",
           {{"version", 2},
            {"vehicleType", 12},
            {"cruiseSpeed", 1.4},
            {"hoverSpeed", 5},
            {"plannedHomePosition", {kLatitude, kLongitude, 2.5}},
            {"items", items}}}};
}

json corners(const std::vector<Vector2d>& metres) {
  json list = json::array();
  for (const Vector2d& p : metres) {
    const GeoPoint geo = at(p.x(), p.y());
    list.push_back({geo.latitude_deg, geo.longitude_deg});
  }
  return list;
}

std::size_t left_out(const MissionPlan& plan, const std::string& what) {
  for (const LeftOut& l : plan.import.left_out) {
    if (l.what.find(what) != std::string::npos) return l.count;
  }
  return 0;
}

std::string refusal(const std::string& text) {
  try {
    (void)parse_mission(text, "x");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// ledger: S6-43
TEST(QGroundControlPlan, BecomesPointsHoldsSpeedsAndAnEnd) {
  const json items = {item(22, 0, 0, 0),
                      item(16, 50, 0, -3, 3, 12),
                      {{"type", "SimpleItem"}, {"command", 178}, {"frame", 2}, {"params", {1, 0.7, -1, 0, 0, 0, 0}}},
                      item(19, 50, 40, -1.5, 0, 60),
                      {{"type", "SimpleItem"}, {"command", 93}, {"frame", 2}, {"params", {5, 0, 0, 0, 0, 0, 0}}},
                      item(16, 10, 40, 4, 10),
                      item(201, 0, 0, 0),
                      item(201, 0, 0, 0),
                      item(16, 5, 5, 2),
                      {{"type", "SimpleItem"}, {"command", 20}, {"frame", 2}, {"params", {0, 0, 0, 0, 0, 0, 0}}},
                      item(16, 0, 0, -1)};
  const MissionPlan plan = parse_mission(plan_of(items).dump(), "harbour.plan");
  ASSERT_EQ(plan.points.size(), 4u);
  EXPECT_NEAR((plan.points[0].north_east - Vector2d(50, 0)).norm(), 0, 1e-6);
  EXPECT_EQ(plan.points[0].depth_m, 3);
  EXPECT_EQ(plan.points[0].hold_s, 12);
  EXPECT_EQ(plan.points[0].speed, 0);
  EXPECT_EQ(plan.points[1].depth_m, 4) << "1.5 m below the sea, home 2.5 m above it";
  EXPECT_EQ(plan.points[1].hold_s, 65);
  EXPECT_EQ(plan.points[1].speed, 0.7);
  EXPECT_EQ(plan.points[2].altitude_m, 4);
  EXPECT_EQ(plan.points[3].depth_m, 0);
  EXPECT_EQ(plan.speed, 1.4);
  EXPECT_EQ(plan.at_end, MissionEnd::kReturn);
  EXPECT_EQ(plan.origin, (GeoOrigin{kLatitude, kLongitude}));
  EXPECT_EQ(left_out(plan, "NAV_TAKEOFF"), 1u);
  EXPECT_EQ(left_out(plan, "DO_SET_ROI"), 2u);
  EXPECT_EQ(left_out(plan, "altitude 2 m above the water"), 1u);
  EXPECT_EQ(left_out(plan, "command 16"), 1u) << "after the end";
  EXPECT_EQ(plan.import.left_out_count(), 5u);
  EXPECT_EQ(plan.import.taken, 8u) << "four points, a speed, a change of it, a delay, the end";
  EXPECT_THAT(plan.import.text(), HasSubstr("QGroundControl plan: 8 taken, 5 left out"));
}

// ledger: S6-43
TEST(QGroundControlPlan, SurveysComeAsTheyWereLaidOut) {
  const json survey = {
      {"type", "ComplexItem"},
      {"complexItemType", "survey"},
      {"TransectStyleComplexItem",
       {{"Items",
         {item(16, 0, 0, -2), item(206, 0, 0, 0), item(16, 100, 0, -2), item(16, 100, 10, -2), item(16, 0, 10, -2)}}}}};
  const json structure = {{"type", "ComplexItem"}, {"complexItemType", "StructureScan"}};
  const MissionPlan plan = parse_mission(plan_of({survey, structure, item(18, 20, 0, -2, 3, 3)}).dump(), "x");
  ASSERT_EQ(plan.points.size(), 5u);
  EXPECT_NEAR((plan.points[2].north_east - Vector2d(100, 10)).norm(), 0, 1e-6);
  EXPECT_EQ(plan.points[4].task, "circle turns=3");
  EXPECT_EQ(left_out(plan, "complex item StructureScan"), 1u);
  EXPECT_EQ(left_out(plan, "DO_SET_CAM_TRIGG_DIST"), 1u);
}

TEST(QGroundControlPlan, AWayPointHasItsAcceptanceRadius) {
  json near = item(16, 50, 0, -3);
  near["params"][1] = 1.5;
  const MissionPlan plan = parse_mission(plan_of({near, item(16, 90, 0, -3)}).dump(), "x");
  EXPECT_EQ(plan.points.at(0).radius_m, 1.5);
  EXPECT_EQ(plan.points.at(1).radius_m, 0);
}

// ledger: S6-39 S6-43 S6-58
TEST(QGroundControlPlan, FencesKeepInAndOut) {
  json root = plan_of(json::array({item(16, 50, 0, -3)}));
  root["geoFence"]["polygons"] = {
      {{"inclusion", true}, {"polygon", corners({{-10, -100}, {200, -100}, {200, 100}, {-10, 100}})}},
      {{"inclusion", false}, {"polygon", corners({{80, -10}, {100, -10}, {90, 0}, {100, 10}, {80, 10}})}}};
  const GeoPoint centre = at(150, 50);
  root["geoFence"]["circles"] = {
      {{"inclusion", false}, {"circle", {{"center", {centre.latitude_deg, centre.longitude_deg}}, {"radius", 20}}}}};
  root["rallyPoints"]["points"] = {{kLatitude, kLongitude, 0}};
  const MissionPlan plan = parse_mission(root.dump(), "x");
  ASSERT_EQ(plan.fence.size(), 4u);
  EXPECT_NEAR((plan.fence[1] - Vector2d(200, -100)).norm(), 0, 1e-6);
  ASSERT_EQ(plan.injected.size(), 1u);
  EXPECT_EQ(plan.injected[0].at_s, 0);
  ASSERT_EQ(plan.injected[0].outlines.size(), 2u);
  EXPECT_TRUE(contains(plan.injected[0].outlines[0], {95, 0})) << "a hollow counts as kept out";
  // The polygon for a circle that keeps out holds all of the circle.
  for (int degree = 0; degree < 360; ++degree) {
    const double a = degree * M_PI / 180;
    EXPECT_TRUE(
        contains(plan.injected[0].outlines[1], Vector2d(150, 50) + 19.999 * Vector2d(std::cos(a), std::sin(a))));
  }
  EXPECT_EQ(left_out(plan, "rally point"), 1u);
  EXPECT_EQ(left_out(plan, "hollow"), 1u);

  // One that keeps in lies inside of it.
  root["geoFence"]["polygons"] = json::array();
  root["geoFence"]["circles"][0]["inclusion"] = true;
  root["geoFence"]["circles"][0]["circle"]["radius"] = 300;
  const MissionPlan round = parse_mission(root.dump(), "x");
  for (const Vector2d& p : round.fence) EXPECT_NEAR((p - Vector2d(150, 50)).norm(), 300, 1e-5);

  root["geoFence"]["circles"][0]["circle"]["radius"] = 30;
  EXPECT_THAT(refusal(root.dump()), HasSubstr("x: mission.items[0].north: point 1"));
  root["geoFence"]["circles"][0]["circle"]["radius"] = -30;
  EXPECT_THAT(refusal(root.dump()), HasSubstr("geoFence.circles[0].radius: not a valid radius"));
  root["geoFence"]["polygons"] = {{{"inclusion", true}, {"polygon", {{1.2, "east"}, {1.3, 103}, {1.4, 103.1}}}}};
  EXPECT_THAT(refusal(root.dump()), HasSubstr("geoFence.polygons[0][0]: not a place on the globe"));
}

TEST(QGroundControlPlan, DamageIsAnErrorOfOneLine) {
  EXPECT_THAT(refusal("{\"fileType\": \"Plan\", "), HasSubstr("x: byte"));
  EXPECT_THAT(refusal("{}"), HasSubstr("not a QGroundControl plan"));
  EXPECT_THAT(refusal("{\"fileType\": \"Plan\"}"), HasSubstr("the plan has no mission"));
  EXPECT_THAT(refusal("{\"fileType\": \"Plan\", \"mission\": 3}"), HasSubstr("neither a home nor"));
  EXPECT_THAT(refusal(plan_of(json::array()).dump()), HasSubstr("the mission has no points"));
  json fenced = plan_of(json::array({item(16, 5, 5, -1)}));
  fenced["geoFence"]["polygons"] = {{{"polygon", {7, "x", nullptr}}}};
  EXPECT_THAT(refusal(fenced.dump()), HasSubstr("geoFence.polygons[0][0]: not a place on the globe"));
  json nowhere = plan_of(json::array({item(16, 5, 5, -1)}));
  nowhere["mission"].erase("plannedHomePosition");
  nowhere["mission"]["items"][0]["params"][5] = 1038.5;
  EXPECT_THAT(refusal(nowhere.dump()), HasSubstr("neither a home nor"));
  EXPECT_THAT(refusal("{\"a\": 1e999}"), HasSubstr("out of range"));
  const MissionPlan odd = parse_mission(
      plan_of({item(16, 5, 5, -1), 7, "x", nullptr, {{"command", -3}}, {{"command", 16}}, item(16, 5, 5, -1, 1)})
          .dump(),
      "x");
  EXPECT_EQ(odd.points.size(), 1u);
  EXPECT_EQ(left_out(odd, "item without a command"), 4u);
  EXPECT_EQ(left_out(odd, "command 16"), 1u);
  EXPECT_EQ(odd.import.left_out_count(), 6u);
}

constexpr const char* kBehaviours = R"(//--- survey, then home
initialize   DEPLOY = false
set MODE = ACTIVE {
  DEPLOY = true
  RETURN != true
} IDLE

Behavior = BHV_Waypoint
{
  name      = survey   // the first
  pwt       = 100
  condition = RETURN = false
  endflag   = RETURN = true
  speed     = 1.8
  capture_radius = 5.0
  points    = 60,-40 : 60,-160:150,-160
  order     = reverse
  repeat    = 1
}
Behavior = BHV_Waypoint
{
  name   = home
  speed  = $(SPD)
  points = pts={0,-20:10,-20.5},label=home
}
Behavior = BHV_OpRegion
{
  polygon      = pts={-80,100:-80,-300:300,-300:300,100}
  max_depth    = 40
  min_altitude = 3
  max_time     = 900
}
Behavior = BHV_ConstantDepth
{
  depth = 6
}
Behavior = BHV_AvdColregs
{
  pwt_outer_dist = 50
}
)";

// x is east, y is north. ledger: S6-43 S6-39
TEST(MoosBehaviours, WayPointsRegionAndDepthBecomeAMission) {
  const MissionPlan plan = parse_mission(kBehaviours, "alpha.bhv");
  ASSERT_EQ(plan.points.size(), 8u);
  const Vector2d expected[] = {{-160, 150}, {-160, 60}, {-40, 60}, {-160, 150},
                               {-160, 60},  {-40, 60},  {-20, 0},  {-20.5, 10}};
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(plan.points[i].north_east, expected[i]) << i;
    EXPECT_EQ(plan.points[i].depth_m, 6);
  }
  EXPECT_EQ(plan.title, "survey");
  EXPECT_EQ(plan.speed, 1.8);
  EXPECT_EQ(plan.points[0].speed, 1.8);
  EXPECT_EQ(plan.points[7].speed, 0);
  EXPECT_EQ(plan.points[7].place.line, 24u);
  EXPECT_EQ(plan.fence, (Polygon{{100, -80}, {-300, -80}, {-300, 300}, {100, 300}}));
  EXPECT_EQ(plan.limits.max_depth_m, 40);
  EXPECT_EQ(plan.limits.min_altitude_m, 3);
  EXPECT_EQ(plan.limits.max_duration_s, 900);
  for (const char* what :
       {"pwt", "condition", "endflag", "capture_radius", "speed", "initialize", "set", "BHV_AvdColregs"}) {
    EXPECT_EQ(left_out(plan, what), 1u) << what;
  }
  EXPECT_EQ(plan.import.left_out_count(), 8u);
}

TEST(MoosBehaviours, PlainListsAndWhatCannotBeTaken) {
  const MissionPlan plan = parse_mission(
      "// a list\nLatOrigin = 43.8\nLongOrigin = 10.1\npoints = 1,2 : 3,4\nPoints = \"5,6,7\"\n", "p.txt");
  ASSERT_EQ(plan.points.size(), 3u);
  EXPECT_EQ(plan.points[2].north_east, Vector2d(6, 5));
  EXPECT_EQ(left_out(plan, "rest of a vertex"), 1u);
  EXPECT_EQ(plan.origin, (GeoOrigin{43.8, 10.1}));
  EXPECT_THAT(refusal("points = 1,2 : 3;4\n"), HasSubstr("x:1: points: \"3;4\" is not a vertex"));
  EXPECT_THAT(refusal("points = 1,2 : nan,4\n"), HasSubstr("is not a vertex"));
  EXPECT_THAT(refusal("points = pts={1,2\n"), HasSubstr("without its }"));
  EXPECT_THAT(refusal("points = 1,2\nspeed = fast\n"), HasSubstr("x:2: speed: \"fast\" is not a number"));
  EXPECT_THAT(refusal("points = format=lawnmower,x=0,y=40,height=60,width=180\n"), HasSubstr("no points"));
  EXPECT_THAT(refusal("points = 1,2:3,4\nrepeat = 9999\n"), HasSubstr("too many points"));
  EXPECT_THAT(refusal("points = 1,2\nBehavior = BHV_OpRegion\n{\npolygon = 0,0:9,9:9,0:0,9\n}\n"),
              HasSubstr("x:4: polygon.corners: the fence crosses or touches itself"));
  EXPECT_EQ(left_out(parse_mission("points = 1,2\nrepeat = forever\n", "x"), "repeat forever"), 1u);
}

// ledger: S6-43
TEST(MoosBehaviours, TheOriginMayStandInTheMoosFileBeside) {
  const std::filesystem::path folder = test::scratch_folder();
  std::ofstream(folder / "alpha.bhv") << kBehaviours;
  EXPECT_FALSE(load_mission((folder / "alpha.bhv").string()).origin.has_value());
  std::ofstream(folder / "alpha.moos")
      << "Community = alpha\nLatOrigin  = 43.825300 // Forrest Lake\nLongOrigin = -70.330400\n";
  EXPECT_EQ(load_mission((folder / "alpha.bhv").string()).origin, (GeoOrigin{43.8253, -70.3304}));
}

// ledger: S6-43
TEST(MissionImport, ReportsNameAndCountWithoutEnd) {
  ImportReport report;
  report.format = "list";
  for (int i = 0; i < 1000; ++i) report.leave_out("kind " + std::to_string(i), "no");
  report.leave_out("kind 7", "no");
  EXPECT_EQ(report.left_out_count(), 1001u);
  EXPECT_LE(report.left_out.size(), 200u);
  EXPECT_EQ(report.left_out[7], (LeftOut{"kind 7", "no", 2}));
}

// What was imported can be written, edited and read as Isobath's own. ledger: S6-43
TEST(MissionImport, CanBeKeptAsToml) {
  const MissionPlan plan = parse_mission(kBehaviours, "alpha.bhv");
  const MissionPlan again = parse_mission(write_mission(plan), "alpha.toml");
  ASSERT_EQ(again.points.size(), plan.points.size());
  EXPECT_EQ(again.points.back().north_east, plan.points.back().north_east);
  EXPECT_EQ(again.fence, plan.fence);
}

}  // namespace
}  // namespace isobath::mission_import_test

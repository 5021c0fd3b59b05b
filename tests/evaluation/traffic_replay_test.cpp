// Ships of a recording: what is read, and that they meet the vehicle.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/evaluation/evaluation_suite.hpp>
#include <string>
#include <tests/support/data.hpp>

namespace isobath::traffic_replay {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using testing::HasSubstr;

constexpr const char* kNames = "Time,MMSI,Latitude_degrees,Longitude_degrees,COG_degrees,SOG_knots\n";
constexpr double kDegree_m = 111'229;  // of latitude, at 50.7 degrees on the ellipsoid

/// North of 50.7 N, 1.1 W; t in seconds after 13:00.
std::string report(double t, int ship, double north_m, double knots = 10) {
  return fmt::format("2016-01-12 13:{:02}:{:06.3f},{},{:.9f},-1.1,0,{}\n", static_cast<int>(t) / 60, std::fmod(t, 60),
                     ship, 50.7 + north_m / kDegree_m, knots);
}

fs::path file_of(const std::string& text) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const fs::path file = fs::path(testing::TempDir()) / fmt::format("replay_{}.csv", test->name());
  std::ofstream(file) << kNames << text;
  return file;
}

/// A ship that goes north at 15 m/s, one that follows it 600 m behind, and one that lies 900 m ahead of their start.
std::string three_ships() {
  std::string text;
  for (int t = 0; t <= 1200; t += 10) {
    text += report(t, 7, 15.0 * t);
    text += report(t + 1, 8, 15.0 * t - 600);
    text += report(t + 2, 9, 900, 0);
  }
  return text;
}

double distance_at(const Body& body, double t, const Vector2d& p) {
  return (Vector2d(body.path[1], body.path[2]) + displacement(body, t).head<2>() - p).norm();
}

TEST(TrafficRecording, JoinsTheReportsOfEachShip) {
  const TrafficRecording recording =
      read_recording(file_of(report(0, 7, 0) + report(0, 8, 50) + report(10, 7, 100) + report(20, 8, 50)));
  ASSERT_EQ(recording.tracks.size(), 2u);
  EXPECT_EQ(recording.tracks[0].ship, 1u);
  EXPECT_EQ(recording.tracks[1].ship, 2u);
  EXPECT_NEAR(recording.tracks[0].at(5).x(), 50, 0.1);
  EXPECT_NEAR(recording.tracks[0].at(30).x(), 300, 0.1) << "straight on after its end";
  EXPECT_NEAR(recording.tracks[0].at(-30).x(), 0, 0.1);
  EXPECT_TRUE(recording.left_out.empty());
}

TEST(TrafficRecording, LeavesOutAndCountsWildReports) {
  const TrafficRecording recording = read_recording(
      file_of(report(0, 7, 0) + report(10, 7, 100) + report(20, 7, 3000) +                            // 290 m/s
              report(20, 7, 200) + report(20, 7, 201) + "2016-01-12 13:00:25,7,91,181,360,102.3\n" +  // unknown
              "2016-01-12 13:00:25,,50.7,-1.1,0,5\n" + report(30, 9, 0)));
  ASSERT_EQ(recording.tracks.size(), 1u);
  EXPECT_EQ(recording.tracks[0].t_s.size(), 3u);
  EXPECT_EQ(recording.left_out.at("report of an impossible speed"), 1u);
  EXPECT_EQ(recording.left_out.at("report of the same time as the one before"), 1u);
  EXPECT_EQ(recording.left_out.at("row without a possible position"), 1u);
  EXPECT_EQ(recording.left_out.at("report without a name"), 1u);
  EXPECT_EQ(recording.left_out.at("single report"), 1u);
}

TEST(TrafficRecording, EndsATrackAtAGapOfThreeMinutes) {
  const TrafficRecording recording =
      read_recording(file_of(report(0, 7, 0) + report(180, 7, 100) + report(361, 7, 200) + report(370, 7, 300)));
  ASSERT_EQ(recording.tracks.size(), 2u);
  EXPECT_EQ(recording.tracks[0].t_s.back(), 180);
  EXPECT_EQ(recording.tracks[1].t_s.front(), 361);
  EXPECT_EQ(recording.tracks[1].ship, 1u) << "the same ship";
}

TEST(TrafficRecording, IsRefusedWithoutAShip) {
  EXPECT_THROW((void)read_recording(file_of(report(0, 7, 0))), Error);
  EXPECT_THROW((void)read_recording("/no/such/file.csv"), Error);
}

TEST(TrafficRecording, HasADigestOfAllTimesAndPlaces) {
  const TrafficRecording a = read_recording(file_of(three_ships()));
  TrafficRecording b = a;
  EXPECT_EQ(a.digest(), b.digest());
  b.tracks[1].p[3].x() += 0.01;
  EXPECT_NE(a.digest(), b.digest());
}

class Replay : public testing::Test {
 protected:
  const EncounteredVehicle vehicle_{.start_W = {3, -4}, .course = Angle::degrees(20), .speed = 1.5};
  const ReplayConfig config_{};
};

// Lengths by 30, times by 3: 15 m/s become 1.5 m/s. ledger: S3-01
TEST_F(Replay, MeetsAVehicleThatGoesStraight) {
  const TrafficRecording recording = read_recording(file_of(three_ships()));
  const Vector2d along(cos(vehicle_.course), sin(vehicle_.course));
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const ReplayedTraffic traffic = replayed_traffic(config_, recording, vehicle_, seed, 120);
    EXPECT_GE(traffic.meeting_s, 20);
    EXPECT_LE(traffic.meeting_s, 50);
    ASSERT_FALSE(traffic.bodies.empty());
    const Body& met = traffic.bodies.front();
    EXPECT_NE(met.name, "ship 3") << "it lies still";
    const Vector2d own = vehicle_.start_W + vehicle_.speed * traffic.meeting_s * along;
    EXPECT_LT(distance_at(met, traffic.meeting_s, own), 0.05);
    const Eigen::Vector3d way = displacement(met, 11) - displacement(met, 10);
    EXPECT_NEAR(way.norm(), 1.5, 0.02);
    for (const Body& body : traffic.bodies) {
      EXPECT_GE(distance_at(body, 0, vehicle_.start_W), config_.free_m + config_.radius_m - 0.02) << body.name;
    }
    // The ships keep their places to each other: 600 m and a second at 15 m/s are 20.5 m.
    if (traffic.bodies.size() >= 2 && traffic.bodies[1].name != "ship 3") {
      EXPECT_NEAR((displacement(traffic.bodies[1], 5) - displacement(met, 5)).norm(), 0, 0.05);
      EXPECT_NEAR(distance_at(traffic.bodies[1], 0, {met.path[1], met.path[2]}), 20.5, 0.1);
    }
  }
}

TEST_F(Replay, IsAFunctionOfTheSeed) {
  const TrafficRecording recording = read_recording(file_of(three_ships()));
  const ReplayedTraffic one = replayed_traffic(config_, recording, vehicle_, 4, 120);
  EXPECT_EQ(one.bodies.front().path, replayed_traffic(config_, recording, vehicle_, 4, 120).bodies.front().path);
  EXPECT_NE(one.bodies.front().path, replayed_traffic(config_, recording, vehicle_, 5, 120).bodies.front().path);
}

TEST_F(Replay, LeavesOutShipsThatAreFarAway) {
  const TrafficRecording recording = read_recording(file_of(three_ships()));
  ReplayConfig near = config_;
  near.within_m = 1;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto all = replayed_traffic(config_, recording, vehicle_, seed, 120).bodies;
    const auto few = replayed_traffic(near, recording, vehicle_, seed, 120).bodies;
    EXPECT_LE(few.size(), all.size());
    EXPECT_EQ(few.front().path, all.front().path) << "the ship that is met is always there";
  }
}

TEST_F(Replay, IsRefusedWhereNoShipMovesOrNoneFits) {
  std::string still;
  for (int t = 0; t <= 600; t += 10) still += report(t, 9, 900);
  EXPECT_THROW((void)replayed_traffic(config_, read_recording(file_of(still)), vehicle_, 1, 120), Error);
  ReplayConfig wide = config_;
  wide.free_m = 900;
  EXPECT_THROW((void)replayed_traffic(wide, read_recording(file_of(three_ships())), vehicle_, 1, 120), Error);
}

class StraitSuite : public testing::Test {
 protected:
  static Suite strait() { return load_suite(test::source_folder() / "suites" / "strait.toml"); }
  static std::string problem(Suite& suite, const fs::path& file) {
    try {
      load_recording(suite, file);
    } catch (const Error& e) {
      return e.what();
    }
    return "none";
  }
};

TEST_F(StraitSuite, NeedsARecording) {
  Suite suite = strait();
  EXPECT_EQ(problem(suite, {}),
            "the suite strait replays a recording of ships, and none is given; give a table of AIS reports: --replay "
            "FILE");
  Suite other = load_suite(test::source_folder() / "suites" / "encounters.toml");
  EXPECT_EQ(problem(other, {}), "none");
  EXPECT_THAT(problem(other, "ais.csv"), HasSubstr("replays no recording"));
}

TEST_F(StraitSuite, AddsTheShipsOfTheRecording) {
  Suite suite = strait();
  const std::uint64_t before = suite.digest;
  load_recording(suite, file_of(three_ships()));
  EXPECT_NE(suite.digest, before) << "other recordings give other runs";
  const std::vector<Scenario> scenes = load_scenes(suite);
  const SuiteRun run = make_run(suite, scenes, 5);
  EXPECT_FALSE(run.scenario.scene.bodies.empty());
  EXPECT_THAT(run.conditions, HasSubstr("ships; meets ship "));
}

}  // namespace
}  // namespace isobath::traffic_replay

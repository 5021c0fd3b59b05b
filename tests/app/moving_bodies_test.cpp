// Bodies that move past a vehicle, as a user meets them: `isobath run` of a scene with traffic.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <isobath/io/mcap/mcap_index.hpp>
#include <map>
#include <numbers>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
using testing::HasSubstr;

std::string crossing_traffic() { return (test::source_folder() / "scenarios/crossing_traffic.toml").string(); }
std::vector<std::string> run_into(const std::filesystem::path& out) {
  return {"run", crossing_traffic(), "--out", out.string(), "--set", "simulation.duration_s=36"};
}

/// The recording holds the track of each moving body in each scan, with its uncertainty.
void expect_tracks_in(const std::filesystem::path& recording) {
  McapIndex index(recording);
  const auto channel = index.channel_of("/tracks");
  ASSERT_TRUE(channel);
  std::map<int, int> scans_of;  // by track
  int fast = 0, all = 0;
  index.visit({&*channel, 1}, 0, ~0ull, [&](const McapMessage& message) {
    const auto scan = nlohmann::json::parse(message.data.begin(), message.data.end());
    for (const auto& body : scan["bodies"]) {
      ++scans_of[body["track"].get<int>()];
      EXPECT_GT(body["position_covariance"][0].get<double>(), 0);
      EXPECT_GT(body["velocity_covariance"][2].get<double>(), 0);
      fast += std::hypot(body["velocity"][0].get<double>(), body["velocity"][1].get<double>()) > 0.1 ? 1 : 0;
      ++all;
    }
    return true;
  });
  int longest = 0;
  for (const auto& [track, scans] : scans_of) longest = std::max(longest, scans);
  EXPECT_GT(longest, 20) << "a body keeps its track";
  EXPECT_GT(fast, 0.8 * all) << "one that stops counts for some seconds more";
}

// The container drifts west at 60 m in 45 s. Its speed is that of its visible side, which changes as the vehicle comes
// nearer. ledger: S3-04 S3-15 S3-E06
TEST(MovingBodies, CrossWithTheirVelocitiesAndLeaveNoTrail) {
  const auto folder = test::scratch_folder();
  auto recorded = run_into(folder / "out");
  recorded.insert(recorded.end(), {"--record", (folder / "run.mcap").string()});
  const auto result = test::isobath(recorded);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("found to move"));
  const auto scans = test::json_of(folder / "out/scans.json");
  int seen = 0, right = 0;
  double last_scan = 0;
  for (const auto& scan : scans["scans"]) {
    last_scan = scan["scan"].get<double>();
    const double t = (last_scan - 1) * 0.5;
    if (t < 8 || t > 25) continue;
    for (const auto& o : scan["obstacles"]) {
      if (!o.contains("motion")) continue;
      ++seen;
      const double speed = o["motion"]["speed"], course = o["motion"]["course_deg"];
      right += std::abs(speed - 60.0 / 45) < 0.4 && std::abs(course - 270) < 15 ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 30);
  EXPECT_GT(right, 0.9 * seen);
  const auto truth = test::json_of(folder / "out/truth.json");
  EXPECT_LT(truth["obstacles"]["false_alarms"].get<double>(), 0.1 * last_scan)
      << "obstacles of nothing: below one a scan, also where the container leaves the sector";
  const auto& motion = truth["motion"];
  EXPECT_GE(motion["known"], 2);
  EXPECT_LE(motion["switches"], 2);
  EXPECT_LT(motion["false_tracks"], 0.3);
  EXPECT_LT(motion["velocity_rms"], 0.9) << "the array of 18 m echoes from another place in each ping";

  expect_tracks_in(folder / "run.mcap");

  auto without = run_into(folder / "without");
  without.insert(without.end(), {"--set", "bodies.on=false"});
  ASSERT_EQ(test::isobath(without).exit_code, 0);
  const auto trail = test::json_of(folder / "without/truth.json");
  EXPECT_GT(trail["obstacles"]["false_alarms"].get<double>(), 3 * last_scan) << "a map that takes the world for still";
}

// A body of 1 m crosses the way of a vehicle that cannot stop, to be met after 24 s. The plan in time lets it pass
// ahead; without it the Navigator goes round the place where the body is, again and again (19 times in this scene).
// ledger: S3-01 S3-21 S3-22
TEST(MovingBodies, ArePassedByAPlanInTime) {
  const auto folder = test::scratch_folder();
  std::ofstream(folder / "scene.toml")
      << "[scene]\nduration_s = 28\n"
         "[bottom]\nkind = 'flat'\nmaterial = 'mud'\ndepth = 30\nextent_m = 200\n"
         "[vehicle]\nfile = '"
      << (test::source_folder() / "vehicles/remus100.toml").string()
      << "'\ndynamic = true\nstart = [0, 0, 15]\nspeed = 1.5\n"
         "[navigation]\nkind = 'drift'\n"
         "[mission]\nspeed = 1.5\n"
         "[[mission_point]]\nnorth = 60\neast = 0\ndepth_m = 15\n"
         "[[sonar]]\npreset = 'oculus_m750d'\nrange_m = 50\nbins = 100\ninterval_s = 0.2\n"
         "[[cylinder]]\ncentre = [36, -24, 15]\nradius = 0.5\nlength = 30\n"
         "path = [[0, 36, -24, 15], [60, 36, 36, 15]]\n";
  const auto result = test::isobath({"run", (folder / "scene.toml").string(), "--out", (folder / "out").string()});
  EXPECT_THAT(result.out, HasSubstr("found to move"));
  int plans = 0;
  const auto decisions = test::json_of(folder / "out/decisions.json");
  for (const auto& decision : decisions["decisions"]) {
    EXPECT_NE(decision["what"], "replan") << decision["reason"];
    if (decision["agent"] != "goal selector" || decision["what"] == "situation") continue;
    ++plans;
    EXPECT_GT(decision["approach"]["gap_m"].get<double>(), 1);
    EXPECT_THAT(decision["reason"].get<std::string>(), HasSubstr("comes as near as"));
  }
  EXPECT_GT(plans, 0);
  double least = 1e9, north = 0;
  const auto scans = test::json_of(folder / "out/scans.json");
  for (const auto& scan : scans["scans"]) {
    north = scan["north_m"];
    const double body_east = -24 + scan["time_ns"].get<double>() * 1e-9;
    least = std::min(least, std::hypot(north - 36, scan["east_m"].get<double>() - body_east));
  }
  EXPECT_GT(north, 37) << "it has passed";
  EXPECT_GT(least, 0.5 + 0.8 + 1) << "both radii and a metre";
}

/// A vehicle that can stop, in a ring of twelve bodies of 1.5 m that close in from 22 m to 7 m and stay there. Three
/// fans look all round. The first `open` bodies are left out, from astern to port.
void write_ring(const std::filesystem::path& file, int open, int duration_s) {
  std::ofstream scene(file);
  scene << fmt::format("[scene]\nduration_s = {}\n", duration_s)
        << "[bottom]\nkind = 'flat'\nmaterial = 'mud'\ndepth = 30\nextent_m = 200\n"
           "[vehicle]\nfile = '"
        << (test::source_folder() / "vehicles/hovering_rov.toml").string()
        << "'\ndynamic = true\nstart = [0, 0, 15]\nspeed = 0.5\n"
           "[navigation]\nkind = 'drift'\n"
           "[mission]\nspeed = 0.5\n"
           "[[mission_point]]\nnorth = 60\neast = 0\ndepth_m = 15\n";
  for (const int heading : {0, 120, -120}) {
    scene << fmt::format(
        "[[sonar]]\npreset = 'oculus_m750d'\nname = 'fan {0}'\nheading_deg = {0}\n"
        "range_m = 30\nbins = 75\ninterval_s = 0.5\n",
        heading);
  }
  constexpr double kFrom = 22, kTo = 7, kSpeed = 0.4;
  for (int k = open; k < 12; ++k) {
    const double a = 2 * std::numbers::pi * (k + 0.5) / 12 + std::numbers::pi, n = std::cos(a), e = std::sin(a);
    scene << fmt::format(
        "[[cylinder]]\ncentre = [{0:.3f}, {1:.3f}, 15]\nradius = 1.5\nlength = 30\n"
        "path = [[0, {0:.3f}, {1:.3f}, 15], [{2}, {3:.3f}, {4:.3f}, 15], [999, {3:.3f}, {4:.3f}, 15]]\n",
        kFrom * n, kFrom * e, (kFrom - kTo) / kSpeed, kTo * n, kTo * e);
  }
}

// Bodies close in from all sides and stay there: the vehicle leaves by the gap, where there is one, though the mission
// leads the other way; without one it stops among them and reports. ledger: S3-37
TEST(MovingBodies, ThatCloseInAreLeftByTheGapOrTheVehicleStopsAndReports) {
  const auto folder = test::scratch_folder();
  for (const bool shut : {false, true}) {
    write_ring(folder / "ring.toml", shut ? 0 : 3, shut ? 75 : 85);
    const auto result = test::isobath({"run", (folder / "ring.toml").string(), "--out", (folder / "out").string(),
                                       "--set", "voxels.sonars=none", "--set", "sphere.keep=false"});
    const auto mission = test::json_of(folder / "out/mission.json");
    EXPECT_FALSE(mission["truth"]["contact"]) << result.out;
    EXPECT_GT(mission["truth"]["least_clearance_m"], 1.0) << "the margin of a plan, less 0.2 m by which it is missed";
    const auto last = test::json_of(folder / "out/scans.json")["scans"].back();
    const double from_middle_m = std::hypot(last["north_m"].get<double>(), last["east_m"].get<double>());
    if (shut) {
      EXPECT_LT(from_middle_m, 6);
      EXPECT_EQ(mission["phase"], "holding");
      EXPECT_THAT(mission["why"].get<std::string>(), HasSubstr("there is no path"));
    } else {
      EXPECT_GT(from_middle_m, 9);
      EXPECT_EQ(mission["phase"], "under way");
    }
  }
}

}  // namespace
}  // namespace isobath

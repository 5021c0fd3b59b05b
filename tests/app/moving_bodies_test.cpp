// Bodies that move past a vehicle, as a user meets them: `isobath run` of a scene with traffic.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <isobath/io/mcap/mcap_index.hpp>
#include <map>
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
  EXPECT_LT(truth["obstacles"]["false_alarms"].get<double>(), last_scan) << "obstacles of nothing: below one a scan";
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

}  // namespace
}  // namespace isobath

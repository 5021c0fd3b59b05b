// `isobath track` and the tracks of `isobath run` on input that is wrong or too much: positions that jump, thousands of
// false ones, bodies that merge and part or stop, time that runs backwards.
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/random.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using testing::HasSubstr;

constexpr double kNoise_m = 0.3;

struct Position {
  double time_s;
  int body;
  Vector2d p;
};

/// Positions of a body each second, from one place on at a velocity.
void sail(std::vector<Position>& all, int body, double from_s, double to_s, Vector2d p, const Vector2d& velocity) {
  for (double t = from_s; t < to_s; t += 1, p += velocity) all.push_back({t, body, p});
}

/// With noise, sorted by time. Positions of body 0 have no name.
std::string table_of(std::vector<Position> all, std::uint64_t seed) {
  Random random(seed);
  std::ranges::stable_sort(all, {}, &Position::time_s);
  std::string text = "time,north,east,id\n";
  for (const Position& one : all) {
    text += fmt::format("{},{:.3f},{:.3f},{}\n", one.time_s, one.p.x() + kNoise_m * random.normal(),
                        one.p.y() + kNoise_m * random.normal(), one.body > 0 ? fmt::format("boat {}", one.body) : "");
  }
  return text;
}

test::ProgramResult track(const std::string& table, std::vector<std::string> options = {"--json"}) {
  const auto folder = test::scratch_folder();
  std::ofstream(folder / "contacts.csv") << table;
  std::vector<std::string> arguments = {"track", (folder / "contacts.csv").string(), "-o", (folder / "out").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return test::isobath(arguments);
}

nlohmann::json tracks_of(const std::string& table, std::vector<std::string> options = {"--json"}) {
  const auto result = track(table, std::move(options));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out);
}

double speed_of(const nlohmann::json& track) {
  return std::hypot(track["velocity"][0].get<double>(), track["velocity"][1].get<double>());
}

// ledger: S3-15
TEST(TrackProgram, ABodyThatTeleportsGetsANewTrackAndNoSpeedOfIts500Metres) {
  std::vector<Position> boat;
  sail(boat, 1, 0, 60, {0, 0}, {1, 0});
  sail(boat, 1, 60, 120, {560, 0}, {1, 0});
  const auto json = tracks_of(table_of(boat, 1));
  ASSERT_EQ(json["tracks"].size(), 2u);
  for (const auto& one : json["tracks"]) EXPECT_NEAR(speed_of(one), 1, 0.2);
  EXPECT_EQ(json["score"]["switches"], 1);
}

// ledger: S3-15
TEST(TrackProgram, TwoThatMergeAndPartAreTwoAgain) {
  int switches = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<Position> boats;
    for (const int side : {-1, 1}) {
      const int body = side > 0 ? 1 : 2;
      // Nearer than 6 m to each other the positions have no names: the noise hides which is which.
      sail(boats, body, 0, 34, {0, 20.2 * side}, {1, -0.5 * side});
      sail(boats, 0, 34, 40, {34, 3.2 * side}, {1, -0.5 * side});
      sail(boats, 0, 40, 60, {40, 0.2 * side}, {1, 0});
      sail(boats, 0, 60, 66, {60, 0.2 * side}, {1, 0.5 * side});
      sail(boats, body, 66, 100, {66, 3.2 * side}, {1, 0.5 * side});
    }
    const auto json = tracks_of(table_of(boats, seed));
    int last = 0;
    for (const auto& one : json["tracks"]) last += one["to_s"].get<double>() > 98 ? 1 : 0;
    EXPECT_EQ(last, 2) << seed;
    EXPECT_GT(json["score"]["held"].get<double>(), 0.95 * json["score"]["asked"].get<double>()) << seed;
    switches += json["score"]["switches"].get<int>();
  }
  EXPECT_LE(switches, 10) << "each boat once a run";
}

// ledger: S3-15
TEST(TrackProgram, ABodyThatStopsLosesItsVelocityAndKeepsItsTrack) {
  std::vector<Position> boat;
  sail(boat, 1, 0, 60, {0, 0}, {1, 0});
  sail(boat, 1, 60, 120, {60, 0}, {0, 0});
  const auto json = tracks_of(table_of(boat, 1));
  ASSERT_EQ(json["tracks"].size(), 1u);
  EXPECT_LT(speed_of(json["tracks"][0]), 0.1);
  EXPECT_GT(json["tracks"][0]["still_probability"], 0.9);
  EXPECT_EQ(json["score"]["switches"], 0);
}

// ledger: S3-15
TEST(TrackProgram, ATableWhoseTimeRunsBackwardsIsSortedAndItSaysSo) {
  std::vector<Position> boat;
  sail(boat, 1, 0, 60, {0, 0}, {1, 0});
  const std::string in_order = table_of(boat, 1);
  std::vector<std::string> lines;
  std::istringstream text(in_order);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  std::reverse(lines.begin() + 1, lines.end());
  std::string backwards;
  for (const std::string& line : lines) backwards += line + "\n";

  EXPECT_THAT(track(backwards, {}).out, HasSubstr("59 positions are earlier than one above them in the table"));
  const auto json = tracks_of(backwards);
  EXPECT_EQ(json["out_of_order"], 59);
  ASSERT_EQ(json["tracks"].size(), 1u);
  EXPECT_NEAR(speed_of(json["tracks"][0]), 1, 0.2);
}

// Two boats among a thousand false positions each second. ledger: S3-15 S3-E06
TEST(TrackProgram, BoatsAreHeldAmongAThousandFalsePositionsASecond) {
  Random random(5);
  std::vector<Position> all;
  sail(all, 1, 0, 30, {-15, -40}, {1, 0});
  sail(all, 2, 0, 30, {30, 15}, {-1, 0.5});
  for (int t = 0; t < 30; ++t) {
    for (int k = 0; k < 1000; ++k) {
      all.push_back({double(t), 0, {random.uniform(-500, 500), random.uniform(-500, 500)}});
    }
  }
  const std::string table = table_of(all, 1);
  const std::vector<std::string> dense = {"--json", "--set", "tracker.clutter=1e-3"};
  const auto json = tracks_of(table, dense);
  EXPECT_EQ(json["readings_left_out"], 30 * 2);
  EXPECT_GT(json["score"]["held"].get<double>(), 0.9 * json["score"]["asked"].get<double>());
  EXPECT_LT(json["score"]["ospa_m"], 1) << "of 2 m at most";
  const auto bounded = track(table, {"--set", "tracker.clutter=1e-3", "--set", "tracker.max_readings=200"});
  EXPECT_EQ(bounded.exit_code, 0);
  EXPECT_THAT(bounded.out, HasSubstr(fmt::format("left out {}: more than 200 positions of one time", 802 * 30)));
}

// More bodies echo than are tracked at most in a look: it goes on, and says so. ledger: S3-15
TEST(TrackProgram, ARunSaysThatItCannotTrackAllThatEchoes) {
  const auto folder = test::scratch_folder();
  std::ofstream scene(folder / "scene.toml");
  scene << "[scene]\nduration_s = 3\n"
           "[bottom]\nkind = 'flat'\nmaterial = 'mud'\ndepth = 30\nextent_m = 100\n"
           "[vehicle]\nstart = [0, 0, 15]\nspeed = 0\n"
           "[[sonar]]\npreset = 'oculus_m750d'\nrange_m = 30\nbins = 100\ninterval_s = 0.5\n";
  for (int k = 0; k < 6; ++k) {
    scene << fmt::format("[[cylinder]]\ncentre = [{}, {}, 15]\nradius = 0.4\nlength = 30\n", 12 + k % 2 * 8,
                         4 * k - 10);
  }
  scene.close();
  const auto run_with = [&](const char* most) {
    const auto result = test::isobath({"run", (folder / "scene.toml").string(), "--out", (folder / "out").string(),
                                       "--set", fmt::format("bodies.max_readings={}", most)});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out;
  };
  EXPECT_THAT(run_with("2"), HasSubstr("too many echoes to track all"));
  EXPECT_THAT(run_with("1000"), Not(HasSubstr("too many echoes to track all")));
}

}  // namespace
}  // namespace isobath

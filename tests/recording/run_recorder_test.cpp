// What a closed loop writes down: events for the replay, set-points and decisions for whoever reads.
#include <csignal>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/display/decision_json.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/mcap/mcap_index.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <isobath/run/mission_input.hpp>
#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tests/support/data.hpp>
#include <tests/support/events.hpp>
#include <tests/support/mission_runs.hpp>
#include <unistd.h>

namespace isobath {
namespace {

constexpr const char* kRecordedScene = R"(
[scene]
duration_s = 4
latitude_deg = 1
longitude_deg = 103
[mission]
title = "there and back"
[[mission_point]]
name = "A"
north = 0.1234567890123456
east = 20
)";

Decision decision_at(double t, const std::string& what) {
  Decision d;
  d.time = Time(seconds(t));
  d.agent = "navigator";
  d.what = what;
  d.reason = "leg 1 would run into \"something\"";
  d.obstacle = Eigen::Vector2d(1.5, -2);
  d.leg = 1;
  d.margin_m = -0.25;
  d.way = {{3, 4}, {5, 6}};
  return d;
}

TEST(RunRecorder, KeepsEventsDecisionsAndWhatTheRunWasMadeOf) {
  const auto file = test::scratch_folder() / "run.mcap";
  const Scenario scenario = parse_scenario(kRecordedScene, "s.toml");
  const MissionSetup setup = setup_of(scenario);
  std::vector<Decision> decisions;
  {
    RunRecorder recorder(file, {});
    recorder.describe(Simulator(scenario.scene, {}), kRecordedScene);
    recorder.describe(setup);
    for (int i = 0; i < 5; ++i) {
      const double t = i;
      recorder.on_event(Event(test::fix_at(t, t)));
      if (i == 2) {
        decisions = {decision_at(t, "plan"), decision_at(t, "replan")};
        for (const Decision& d : decisions) recorder.on_message({100, d.time, d.agent, d});
      }
      recorder.setpoint(Time(seconds(t)), {Angle::degrees(i < 3 ? 10 : 20), 1, 1});
      recorder.on_message({static_cast<std::uint64_t>(i + 1), Time(seconds(t)), "captain", PointReport{}});
    }
    recorder.close();
  }
  EXPECT_EQ(decisions_in(file), (std::vector<std::string>{decision_json(decisions[0]), decision_json(decisions[1])}));
  const auto source = open_native_log(file, {});
  int fixes = 0;
  while (const auto event = source->next()) fixes += std::holds_alternative<Navigation>(*event) ? 1 : 0;
  EXPECT_EQ(fixes, 5);
  EXPECT_TRUE(source->report().rejected.empty()) << "what was made of the events is passed over in silence";
  ASSERT_TRUE(source->report().origin);
  EXPECT_EQ(source->report().origin->longitude_deg, 103);
  EXPECT_EQ(attachment_in(file, kScenarioAttachment), kRecordedScene);
  EXPECT_EQ(attachment_in(file, "nothing"), std::nullopt);
  const MissionPlan read = parse_mission(attachment_in(file, kMissionAttachment).value_or(""), "m.toml");
  ASSERT_EQ(read.points.size(), 1u);
  EXPECT_EQ(read.points[0].north_east, scenario.mission.points[0].north_east) << "to the last bit";
}

// The same vehicle commands in the replay: its sheet comes with the log.
TEST(RunRecorder, TheVehicleIsThatOfTheRecordedRun) {
  const auto file = test::scratch_folder() / "run.mcap";
  const Scenario scenario = test::scenario_of("simulated_mission_1");
  const Simulator simulator(scenario.scene, {});
  const MissionSetup setup = setup_of(scenario);
  {
    RunRecorder recorder(file, {});
    recorder.describe(simulator, kRecordedScene);
    recorder.describe(setup);
    recorder.on_event(Event(test::fix_at(0, 0)));
    recorder.close();
  }
  const auto replay =
      mission_setup(test::source_folder() / "scenarios" / "simulated_mission_1.toml", nullptr, file, nullptr);
  ASSERT_TRUE(replay);
  EXPECT_EQ(replay->vehicle.half_width_m, setup.vehicle.half_width_m);
  EXPECT_EQ(replay->vehicle.hull_radius_m, setup.vehicle.hull_radius_m);
  EXPECT_EQ(replay->vehicle.braking, setup.vehicle.braking);
  EXPECT_EQ(replay->vehicle.min_speed, setup.vehicle.min_speed);
  EXPECT_EQ(replay->vehicle.can_sway, setup.vehicle.can_sway);
  EXPECT_EQ(replay->vehicle.limits.turning_radius, setup.vehicle.limits.turning_radius);
  EXPECT_EQ(replay->vehicle.limits.max_yaw_rate.radians(), setup.vehicle.limits.max_yaw_rate.radians());
}

TEST(RunRecorder, DecisionsAreToldApartFromThoseRecorded) {
  const auto file = test::scratch_folder() / "run.mcap";
  std::vector<Decision> decisions{decision_at(1, "plan"), decision_at(2, "replan"), decision_at(3, "finish")};
  {
    RunRecorder recorder(file, {});
    for (const Decision& d : decisions) recorder.on_message({1, d.time, d.agent, d});
    recorder.close();
  }
  EXPECT_EQ(compare_with_log(decisions, file)->the_same, 3u);
  decisions[1].margin_m = -0.250001;
  EXPECT_EQ(compare_with_log(decisions, file)->the_same, 1u);
  decisions.resize(1);
  EXPECT_EQ(compare_with_log(decisions, file)->the_same, 1u);
  EXPECT_EQ(compare_with_log(decisions, file)->decisions, 3u);
  EXPECT_FALSE(compare_with_log(decisions, test::source_folder() / "README.md"));
}

TEST(RunRecorder, IsAFileOfItsKind) {
  EXPECT_THROW(RunRecorder(test::scratch_folder() / "run.bag", {}), Error);
  EXPECT_THROW(RunRecorder("/nowhere/at/all.mcap", {}), Error);
}

/// A stretch of a run: fixes, messages, a display that changes; deterministic.
void record(RunRecorder& recorder, DisplayState& items, double from_s, double to_s) {
  for (int i = static_cast<int>(from_s * 10); i < static_cast<int>(to_s * 10); ++i) {
    const Time time = Time(seconds(1e9)) + std::chrono::milliseconds(100 * i);
    Navigation fix = test::fix_at(0, i, i % 360);
    fix.time = time;
    recorder.on_event(Event(fix));
    recorder.on_fix(fix);
    recorder.on_message({static_cast<std::uint64_t>(i + 1), time, "pilot", HelmOrder{{Angle::degrees(i), 1, 1.5, 0}}});
    items.set(DisplayKind::kVehicle, 0, time, std::string(80, static_cast<char>(i)));
    items.set(DisplayKind::kTrack, static_cast<std::uint64_t>(i / 64), time, std::string(64, static_cast<char>(i)));
    recorder.sample(time, items);
  }
}

// ledger: S6-57 S6-D09
TEST(RunRecorder, TheSameRunGivesTheSameBytes) {
  const auto folder = test::scratch_folder();
  for (const char* name : {"a.mcap", "b.mcap"}) {
    RunRecorder recorder(folder / name, {});
    DisplayState items;
    record(recorder, items, 0, 30);
    recorder.close();
    EXPECT_EQ(recorder.problem(), "");
    EXPECT_EQ(recorder.left_out(), 0u);
  }
  EXPECT_EQ(read_whole_file(folder / "a.mcap", 1 << 24), read_whole_file(folder / "b.mcap", 1 << 24));
}

TEST(RunRecorder, OtherViewersChannelsCanBeLeftOut) {
  const auto folder = test::scratch_folder();
  for (const bool on : {true, false}) {
    Configuration configuration;
    configuration.recorder.foxglove.on = on;
    RunRecorder recorder(folder / "run.mcap", configuration);
    DisplayState items;
    record(recorder, items, 0, 3);
    recorder.close();
    const McapIndex index(folder / "run.mcap");
    EXPECT_EQ(index.channel_of("/foxglove/tf").has_value(), on);
    EXPECT_TRUE(index.channel_of(kMessagesTopic));
    EXPECT_TRUE(index.channel_of(kDisplayTopic));
  }
}

/// Times of all messages of a channel.
std::vector<std::uint64_t> times_in(McapIndex& index, const char* topic) {
  std::vector<std::uint64_t> times;
  const auto channel = index.channel_of(topic);
  if (!channel) return times;
  index.visit({&*channel, 1}, 0, ~0ull, [&](const McapMessage& message) {
    times.push_back(message.log_time);
    return true;
  });
  return times;
}

/// The messages of a JSON channel.
std::vector<nlohmann::json> objects_in(McapIndex& index, const char* topic) {
  std::vector<nlohmann::json> objects;
  const auto channel = index.channel_of(topic);
  if (!channel) return objects;
  index.visit({&*channel, 1}, 0, ~0ull, [&](const McapMessage& message) {
    objects.push_back(nlohmann::json::parse(message.data.begin(), message.data.end()));
    return true;
  });
  return objects;
}

// From the first body that moves on, each scan has a message, and other viewers an arrow of ten seconds.
TEST(RunRecorder, KeepsTheTracksOfEachScan) {
  const auto file = test::scratch_folder() / "tracks.mcap";
  const BodyGrid grid{BodyGridConfig{}};
  {
    RunRecorder recorder(file, {});
    Detection found;
    found.X_WB = {Rotation::from_heading(Angle::degrees(90)), {100, 200, 5}};
    for (int scan = 1; scan <= 4; ++scan) {
      found.time = Time(seconds(2.0 * scan));
      Obstacle o;
      o.outline = {{5, 0}, {6, 0}, {6, 1}, {5, 1}};
      o.centre = o.nearest = {5.5, 0.5};
      o.covariance.setIdentity();
      o.number = 3;
      o.existence = 0.75;
      if (scan == 2 || scan == 3) {
        o.motion.velocity_W = {-0.5, 1.25};
        o.motion.position_covariance << 0.04, 0.01, 0.01, 0.09;
        o.motion.velocity_covariance << 0.002, -0.001, -0.001, 0.003;
        o.motion.track = 12;
      }
      found.obstacles = {o};
      recorder.on_scan({scan, true, found, grid});
    }
    recorder.close();
    EXPECT_EQ(recorder.problem(), "");
  }
  McapIndex index(file);
  const auto scans = objects_in(index, kTracksTopic);
  ASSERT_EQ(scans.size(), 3u) << "none before the first body that moves";
  EXPECT_EQ(scans[0]["scan"], 2);
  EXPECT_EQ(scans[0]["time_ns"], 4'000'000'000);
  ASSERT_EQ(scans[0]["bodies"].size(), 1u);
  EXPECT_EQ(scans[2]["bodies"].size(), 0u) << "it is seen that a track has ended";
  const auto& body = scans[0]["bodies"][0];
  EXPECT_EQ(body["track"], 12);
  EXPECT_EQ(body["number"], 3);
  EXPECT_EQ(body["place"], nlohmann::json::array({99.5, 205.5}));
  EXPECT_EQ(body["velocity"], nlohmann::json::array({-0.5, 1.25}));
  EXPECT_EQ(body["position_covariance"], nlohmann::json::array({0.04, 0.01, 0.09}));
  EXPECT_EQ(body["velocity_covariance"], nlohmann::json::array({0.002, -0.001, 0.003}));
  EXPECT_EQ(body["outline"].size(), 4u);
  EXPECT_EQ(body["existence"], 0.75);

  const auto drawn = objects_in(index, "/foxglove/obstacles");
  ASSERT_EQ(drawn.size(), 4u);
  EXPECT_EQ(drawn[0]["entities"][0]["lines"].size(), 1u) << "what lies still has no arrow";
  const auto& arrow = drawn[1]["entities"][0]["lines"].at(1)["points"];
  EXPECT_NEAR(arrow[1]["x"].get<double>() - arrow[0]["x"].get<double>(), 12.5, 1e-6) << "east";
  EXPECT_NEAR(arrow[1]["y"].get<double>() - arrow[0]["y"].get<double>(), -5, 1e-6) << "north";
}

// A recorder that is killed in the middle of its work loses no more than the last chunk of each kind.
// ledger: S6-33
TEST(RunRecorder, SurvivesBeingKilled) {
  const auto file = test::scratch_folder() / "killed.mcap";
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    RunRecorder recorder(file, {});
    DisplayState items;
    record(recorder, items, 0, 60);
    (void)!write(ready[1], "x", 1);
    for (double t = 60;; t += 1) record(recorder, items, t, t + 1);  // goes on until it is killed
  }
  char one = 0;
  ASSERT_EQ(read(ready[0], &one, 1), 1);
  ASSERT_EQ(kill(child, SIGKILL), 0);
  int status = 0;
  waitpid(child, &status, 0);
  close(ready[0]);
  close(ready[1]);
  EXPECT_TRUE(WIFSIGNALED(status));

  McapIndex index(file);
  EXPECT_FALSE(index.complete());
  constexpr std::uint64_t kStart = 1'000'000'000ull * 1'000'000'000ull, kSecond = 1'000'000'000ull;
  for (const char* topic : {"/navigation", kMessagesTopic, "/foxglove/tf", kDisplayTopic}) {
    const auto times = times_in(index, topic);
    ASSERT_FALSE(times.empty()) << topic;
    EXPECT_EQ(times.front(), kStart) << topic;
    EXPECT_GE(times.back(), kStart + 54 * kSecond) << topic << ": of what was there when 60 s had been recorded";
    const std::uint64_t step = topic == std::string(kDisplayTopic) ? 3 : 1;  // a sample is due each quarter of a second
    for (std::size_t i = 1; i < times.size(); ++i) ASSERT_EQ(times[i] - times[i - 1], step * kSecond / 10) << topic;
  }
  const auto source = open_native_log(file, {});
  int fixes = 0;
  while (const auto event = source->next()) ++fixes;
  EXPECT_GE(fixes, 540);
}

/// As long as it lives, no file can grow beyond a size.
class SmallDisk {
 public:
  explicit SmallDisk(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit small = before_;
    small.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &small);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

// A full disk ends the recording, and nothing else: it is said once, and what is missing is counted.
TEST(RunRecorder, AFullDiskEndsTheRecordingAndNothingElse) {
  const auto file = test::scratch_folder() / "full.mcap";
  {
    RunRecorder recorder(file, {});
    DisplayState items;
    {
      const SmallDisk disk(60'000);
      EXPECT_NO_THROW(record(recorder, items, 0, 600));
    }
    EXPECT_THAT(recorder.problem(), testing::HasSubstr("full.mcap: byte"));
    EXPECT_THAT(recorder.problem(), testing::HasSubstr("cannot be written"));
    const std::uint64_t left_out = recorder.left_out();
    EXPECT_GT(left_out, 1000u);
    recorder.on_event(Event(test::fix_at(0, 0)));
    EXPECT_EQ(recorder.left_out(), left_out + 1) << "there is room again, but a gap would be no better";
    EXPECT_NO_THROW(recorder.close());
  }
  McapIndex index(file);
  EXPECT_GT(times_in(index, "/navigation").size(), 50u) << "what was written stays readable";
}

}  // namespace
}  // namespace isobath

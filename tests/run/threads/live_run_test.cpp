// A live run that is looked at: the page shows all of it, the recording holds what the page showed, the mission ends as
// it does without, and whoever maps waits for neither.
#include <fcntl.h>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/onboard/onboard.hpp>
#include <isobath/recording/recorded_display.hpp>
#include <isobath/run/run.hpp>
#include <isobath/run/run_display.hpp>
#include <sys/stat.h>
#include <tests/support/data.hpp>
#include <tests/support/display_records.hpp>
#include <tests/support/mission_runs.hpp>
#include <thread>
#include <unistd.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Kind = DisplayKind;
using RunPicture = std::map<std::pair<Kind, std::uint64_t>, std::string>;

fs::path mission_1() { return test::source_folder() / "scenarios" / "simulated_mission_1.toml"; }

RunPicture run_picture(const DisplayState& items) {
  RunPicture picture = test::as_map(items.changes_after(0).records);
  std::erase_if(picture, [](const auto& item) { return item.first.first == Kind::kTimes; });  // of no recording
  return picture;
}

RunRequest live_request(const fs::path& out) {
  RunRequest request;
  request.input = mission_1();
  request.out = out;
  request.live_speed = 0;
  return request;
}

// ledger: S5-59 S6-31
TEST(LiveRun, IsShownAndRecordedAsItGoesAndEndsAsItDoesWithout) {
  const fs::path folder = test::scratch_folder();
  const RunOutcome alone = run(live_request(folder / "alone"));
  ASSERT_TRUE(alone.mission);
  ASSERT_EQ(alone.mission->failure(), "");

  DisplayState items;
  RunRequest request = live_request(folder / "shown");
  request.record = folder / "run.mcap";
  request.watch.emplace();
  request.watch->display = &items;
  const RunOutcome shown = run(request);
  ASSERT_TRUE(shown.mission && shown.live);
  EXPECT_EQ(shown.mission->failure(), "");
  EXPECT_EQ(shown.mission->report.phase, alone.mission->report.phase);
  EXPECT_EQ(shown.mission->report.reached, alone.mission->report.reached);
  EXPECT_EQ(shown.mission->report.dropped, alone.mission->report.dropped);
  EXPECT_EQ(shown.live->lost_pings, 0u);
  EXPECT_EQ(shown.live->unshown_pings + shown.live->unshown_notes, 0u);
  EXPECT_EQ(shown.recording_problem, "");

  std::map<Kind, std::size_t> kinds;
  for (const auto& [key, payload] : test::as_map(items.changes_after(0).records)) ++kinds[key.first];
  for (const Kind kind : {Kind::kScene, Kind::kVehicle, Kind::kTrack, Kind::kSonar, Kind::kEchoes, Kind::kGrid,
                          Kind::kObstacles, Kind::kWay, Kind::kDecision, Kind::kHealth, Kind::kTimes}) {
    EXPECT_GT(kinds[kind], 0u) << "no item of kind " << static_cast<int>(kind);
  }
  EXPECT_EQ(kinds[Kind::kDecision], shown.mission->decisions.size());

  // What was to be seen at any time is in the recording: a vehicle on its way, and in the end all there was.
  RecordedDisplay recorded(request.record);
  const auto span = recorded.span();
  ASSERT_TRUE(span);
  const auto place = [&](double share) {
    DisplayState then;
    recorded.seek(span->first + seconds(share * to_seconds(span->last - span->first)), then);
    const std::string vehicle = run_picture(then).at({Kind::kVehicle, 0});
    return Eigen::Vector2d(test::number_at<double>(vehicle, 0), test::number_at<double>(vehicle, 8));
  };
  EXPECT_GT((place(0.5) - place(0.1)).norm(), 5);
  EXPECT_GT((place(0.8) - place(0.5)).norm(), 5);
  DisplayState end;
  recorded.seek(span->last, end);
  EXPECT_TRUE(run_picture(end) == run_picture(items));

  // Heard again, it is decided anew, and not held against what threads decided.
  RunRequest again;
  again.input = request.record;
  again.mission = mission_1();
  again.out = folder / "again";
  const RunOutcome heard = run(again);
  ASSERT_TRUE(heard.mission);
  EXPECT_FALSE(heard.mission->recorded) << "no claim that it must be the same";
  EXPECT_EQ(heard.mission->report.reached, shown.mission->report.reached);
  EXPECT_EQ(heard.counts.pings, shown.counts.pings) << "every ping is in the recording";
}

/// The river bridge, whose fans make voxels, with a sounder that makes depths.
fs::path bridge_with_a_sounder(const fs::path& folder) {
  std::string text = text_of_file((test::source_folder() / "scenarios" / "bridge.toml").string());
  const std::string vehicles = "../vehicles";
  text.replace(text.find(vehicles), vehicles.size(), (test::source_folder() / "vehicles").string());
  std::ofstream(folder / "scene.toml") << text << "\n[[sonar]]\npreset = \"altimeter\"\n";
  return folder / "scene.toml";
}

// Whoever maps goes on with its maps while they are shown.
TEST(LiveRun, MapsOfAllKindsAreShownWhileTheyAreMade) {
  const fs::path folder = test::scratch_folder();
  DisplayState items;
  RunRequest request = live_request(folder / "out");
  request.input = bridge_with_a_sounder(folder);
  request.record = folder / "run.mcap";
  request.configuration.simulation.duration_s = 20;
  request.watch.emplace();
  request.watch->display = &items;
  const RunOutcome outcome = run(request);
  ASSERT_TRUE(outcome.live && outcome.voxels && outcome.depth);
  EXPECT_EQ(outcome.live->unshown_pings + outcome.live->unshown_notes, 0u);
  const auto shown = test::records_of(items.changes_after(0).records);
  for (const Kind kind : {Kind::kGrid, Kind::kDepth, Kind::kVoxels}) {
    const auto maps = test::of_kind(shown, kind);
    ASSERT_FALSE(maps.empty()) << "no item of kind " << static_cast<int>(kind);
    EXPECT_GT(to_seconds(maps.back().time - items.times().first), 17) << "to the end";
  }
  RecordedDisplay recorded(request.record);
  DisplayState end;
  recorded.seek(recorded.span()->last, end);
  EXPECT_TRUE(run_picture(end) == run_picture(items));
}

TEST(LiveRun, FollowsWhatIsOrderedAtThePage) {
  DisplayState items;
  bool ordered = false;
  RunRequest request = live_request(test::scratch_folder() / "out");
  request.watch.emplace();
  request.watch->display = &items;
  request.watch->ordered = [&]() -> std::optional<OperatorCommand> {
    const auto [first, last] = items.times();
    if (ordered || to_seconds(last - first) < 20) return std::nullopt;
    ordered = true;
    return OperatorCommand{OperatorCommand::Kind::kAbort};
  };
  const RunOutcome outcome = run(request);
  ASSERT_TRUE(outcome.mission);
  EXPECT_EQ(outcome.mission->report.phase, MissionPhase::kAborted);
  EXPECT_THAT(outcome.mission->failure(), testing::HasSubstr("operator"));
}

TEST(LiveRun, EndsDecentlyWhereItIsStopped) {
  DisplayState items;
  RunRequest request = live_request(test::scratch_folder() / "out");
  request.record = request.out / "run.mcap";
  fs::create_directories(request.out);
  request.watch.emplace();
  request.watch->display = &items;
  request.watch->stopped = [&] {
    const auto [first, last] = items.times();
    return to_seconds(last - first) > 15;
  };
  const RunOutcome outcome = run(request);
  ASSERT_TRUE(outcome.mission);
  EXPECT_EQ(outcome.mission->report.phase, MissionPhase::kUnderWay);
  EXPECT_LT(outcome.log_s, 20);
  EXPECT_TRUE(fs::exists(request.out / "report.html"));
  RecordedDisplay recorded(request.record);
  EXPECT_TRUE(recorded.complete());
  DisplayState end;
  recorded.seek(recorded.span()->last, end);
  EXPECT_TRUE(run_picture(end) == run_picture(items));
}

// The sweep that the end cuts short is the last that is seen: in the recording, too.
TEST(RunDisplay, TheRecordingsLastPictureIsTheRunsLast) {
  DisplayState items;
  RunRequest request;
  request.input = mission_1();
  request.out = test::scratch_folder() / "out";
  request.record = request.out / "run.mcap";
  fs::create_directories(request.out);
  request.configuration.simulation.duration_s = 21;
  request.configuration.recorder.display_s = 0.01;  // so that a sample is taken after the very last event
  request.watch.emplace();
  request.watch->display = &items;
  run(request);
  RecordedDisplay recorded(request.record);
  DisplayState end;
  recorded.seek(recorded.span()->last, end);
  EXPECT_TRUE(run_picture(end) == run_picture(items));
}

/// A file for which no reader has come yet: whoever writes to it waits, until it is drained.
class StalledDisk {
 public:
  explicit StalledDisk(const fs::path& file) {
    EXPECT_EQ(::mkfifo(file.c_str(), 0600), 0);
    reader_ = ::open(file.c_str(), O_RDONLY | O_NONBLOCK);  // so that its writer can open it
    EXPECT_GE(reader_, 0);
    ::fcntl(reader_, F_SETPIPE_SZ, 1 << 17);  // all that the recording begins with, and little more
  }
  StalledDisk(const StalledDisk&) = delete;
  StalledDisk& operator=(const StalledDisk&) = delete;
  ~StalledDisk() {
    drain();
    if (drained_.joinable()) drained_.join();
    ::close(reader_);
  }
  /// From now on it takes all, until its writer has closed it.
  void drain() {
    if (drained_.joinable()) return;
    ::fcntl(reader_, F_SETFL, 0);
    drained_ = std::thread([this] {
      char bytes[4096];
      while (::read(reader_, bytes, sizeof bytes) > 0) continue;
    });
  }

 private:
  int reader_ = -1;
  std::thread drained_;
};

struct Drained {
  StalledDisk& disk;
  ~Drained() { disk.drain(); }
};

// Nobody reads what is recorded, so that the display's thread stands still in the middle of a note: all pings get into
// the map nevertheless.
// ledger: S6-31
TEST(RunDisplay, OneThatStandsStillDoesNotHoldTheMapping) {
  const fs::path folder = test::scratch_folder();
  StalledDisk disk(folder / "run.mcap");
  DisplayState items;
  RunRequest request = live_request(folder);
  request.record = folder / "run.mcap";
  request.configuration.recorder.log.chunk_kib = 1;
  request.watch.emplace();
  request.watch->display = &items;
  const Scenario scenario = test::scenario_of("simulated_mission_1");
  RunInput input(request.input, scenario, request.configuration, {}, 1);
  RunDisplay display(request, std::nullopt, input);
  const Drained drained{disk};  // whatever happens: else the display could not end
  DepthModel depths(request.configuration, {});
  Onboard onboard(request.configuration, depths, {.live = true});
  onboard.show_to(display);
  std::uint64_t pings = 0;
  Time last;
  while (pings < 2 * RunDisplay::kWaiting.pings) {
    auto event = input.next();
    ASSERT_TRUE(event);
    last = time_of(*event);
    pings += std::holds_alternative<Ping>(*event) ? 1 : 0;
    onboard.on_event(std::move(*event));
    display.sample(last);
    onboard.settle();  // that it comes back at all is what is shown
  }
  EXPECT_EQ(onboard.lost_pings(), 0u);
  const PipelineCounts& counts = onboard.pipeline().counts();
  EXPECT_EQ(counts.pings + counts.vertical, pings);
  const RunPicture stalled = run_picture(items);
  EXPECT_GT(display.left_out().pings, 0u) << "it stood still all the while, and that is counted";

  disk.drain();
  display.settle();
  EXPECT_FALSE(run_picture(items) == stalled) << "it goes on with the newest";
  const auto shown = test::records_of(items.changes_after(0).records);
  const auto echoes = test::of_kind(shown, Kind::kEchoes);
  ASSERT_FALSE(echoes.empty());
  EXPECT_LT(to_seconds(last - echoes.back().time), 5);
  display.finish(last);
}

}  // namespace
}  // namespace isobath

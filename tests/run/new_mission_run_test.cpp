// A run whose mission a page replaces under way.
#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/recording/recorded_display.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <isobath/run/mission_desk.hpp>
#include <isobath/run/run.hpp>
#include <tests/support/data.hpp>
#include <tests/support/display_records.hpp>
#include <thread>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kScene = R"([scene]
duration_s = 150
[bottom]
kind = 'flat'
material = 'mud'
depth = 30
extent_m = 300
[vehicle]
start = [0, 0, 15]
speed = 1.5
[navigation]
kind = 'drift'
[mission]
speed = 1.5
[geofence]
corners = [[-50, -100], [150, -100], [150, 100], [-50, 100]]
[[mission_point]]
north = 100
east = 0
depth_m = 15
[[sonar]]
preset = 'oculus_m750d'
range_m = 50
bins = 100
interval_s = 0.5
)";

class NewMissionRun : public testing::Test {
 protected:
  NewMissionRun() : folder(test::scratch_folder()) {
    request.input = folder / "scene.toml";
    std::ofstream(request.input) << kScene;
    request.out = folder / "out";
    request.record = folder / "run.mcap";
    request.watch.emplace();
    request.watch->display = &items;
    request.watch->desk = &desk;
    request.watch->ordered = [this]() -> std::optional<OperatorCommand> {
      const auto [first, last] = items.times();
      if (!sent && to_seconds(last - first) > 20) {
        sent = true;
        refusal = desk.send(draft, "the page at 10.0.0.1");
      }
      return desk.next();
    };
  }
  /// Where the vehicle came nearest to a place, by its estimate.
  static double nearest_m(const MissionOutcome& mission, const Eigen::Vector2d& place) {
    double nearest = INFINITY;
    for (const auto& believed : mission.believed) nearest = std::min(nearest, (believed.north_east - place).norm());
    return nearest;
  }
  static bool decided(const std::vector<Decision>& decisions, const std::string& what, const std::string& reason) {
    return std::ranges::any_of(
        decisions, [&](const Decision& d) { return d.what == what && d.reason.find(reason) != std::string::npos; });
  }

  const fs::path folder;
  RunRequest request;
  DisplayState items;
  MissionDesk desk;
  MissionDraft draft;
  bool sent = false;
  std::string refusal;
};

TEST_F(NewMissionRun, ReachesTheNewPointAndNotTheOldOne) {
  draft.points = {{{}, {20, 40}, 15, {}, 0}};
  const RunOutcome outcome = run(request);
  EXPECT_EQ(refusal, "");
  ASSERT_TRUE(outcome.mission);
  EXPECT_EQ(outcome.mission->report.phase, MissionPhase::kFinished);
  EXPECT_EQ(outcome.mission->report.reached, 1u);
  ASSERT_EQ(outcome.mission->plan.points.size(), 1u);
  EXPECT_EQ(outcome.mission->plan.points[0].north_east, Eigen::Vector2d(20, 40));
  EXPECT_LT(nearest_m(*outcome.mission, {20, 40}), 5);
  EXPECT_GT(nearest_m(*outcome.mission, {100, 0}), 40);
  EXPECT_TRUE(decided(outcome.mission->decisions, "new mission", "1 point, sent by the page at 10.0.0.1"));

  const auto scenes = [](DisplayState& shown) {
    return test::of_kind(test::records_of(shown.changes_after(0).records), DisplayKind::kScene);
  };
  ASSERT_EQ(scenes(items).size(), 1u);
  EXPECT_THAT(scenes(items)[0].payload, HasSubstr(R"("mission_number":1)"));
  RecordedDisplay recorded(request.record);
  DisplayState early, late;
  recorded.seek(recorded.span()->first + seconds(10), early);
  recorded.seek(recorded.span()->last, late);
  EXPECT_THAT(scenes(early)[0].payload, HasSubstr(R"("mission_number":0)"));
  EXPECT_THAT(scenes(late)[0].payload, HasSubstr(R"("mission_number":1)"));

  RunRequest again;  // the recording holds the operator's frames, so that a replay decides the same
  again.input = request.record;
  again.mission = request.input;
  again.out = folder / "again";
  const RunOutcome replay = run(again);
  ASSERT_TRUE(replay.mission);
  EXPECT_TRUE(decided(replay.mission->decisions, "new mission", "1 point, sent by the page at 10.0.0.1"));
  EXPECT_EQ(replay.mission->as_recorded, replay.mission->recorded.value_or(0));
}

TEST_F(NewMissionRun, ThatTheChecksRefuseLetsTheOldOneGoOn) {
  draft.points = {{{}, {500, 40}, 15, {}, 0}};
  const RunOutcome outcome = run(request);
  EXPECT_THAT(refusal, HasSubstr("outside the fence"));
  ASSERT_TRUE(outcome.mission);
  EXPECT_EQ(outcome.mission->plan.points[0].north_east, Eigen::Vector2d(100, 0));
  EXPECT_LT(nearest_m(*outcome.mission, {100, 0}), 5);
}

TEST_F(NewMissionRun, IsPreviewedByThePlannerOfTheVehicleAndOneAtATime) {
  draft.points = {{{}, {20, 40}, 15, {}, 0}};
  std::string answer, second;
  bool asked = false;
  request.configuration.simulation.duration_s = 30;
  const auto ordered = request.watch->ordered;
  request.watch->ordered = [&]() -> std::optional<OperatorCommand> {
    const auto [first, last] = items.times();
    if (asked || to_seconds(last - first) < 15) return std::nullopt;
    asked = true;
    EXPECT_EQ(desk.preview(draft, 7), "");
    second = desk.preview(draft, 8);
    // Where the first one has ended already, the second takes its place.
    const std::uint64_t planned = second.empty() ? 8 : 7, other = second.empty() ? 7 : 8;
    while (answer.empty()) {
      EXPECT_FALSE(desk.preview_text(other));
      answer = desk.preview_text(planned).value_or("");
      std::this_thread::yield();
    }
    return std::nullopt;
  };
  (void)run(request);
  EXPECT_THAT(answer, HasSubstr(R"("way_m":[[)"));
  EXPECT_THAT(answer, HasSubstr(R"("unknown_m":)"));
  if (!second.empty()) {
    EXPECT_THAT(second, HasSubstr("another preview"));
  }
  draft.mission = 3;
  EXPECT_THAT(desk.send(draft, "the page"), HasSubstr("the mission has changed"));
  desk.close();
  EXPECT_EQ(desk.order({OperatorCommand::Kind::kHold}), "the mission is over");
}

}  // namespace
}  // namespace isobath

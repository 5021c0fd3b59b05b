// What a run knows of its mission when it is stopped on the way.
#include <gtest/gtest.h>
#include <isobath/onboard/agents_helm.hpp>

namespace isobath::mission_log {
namespace {

Envelope of(Message message) { return {1, Time{}, "executive officer", std::move(message)}; }

/// The Executive Officer reports a mission when its phase changes, and each point when it has been reached or dropped.
TEST(MissionLog, CountsThePointsOfAMissionThatIsUnderWay) {
  using Kind = PointReport::Kind;
  MissionLog log;
  log.note(of(MissionReport{MissionPhase::kUnderWay, 0, 0, ""}));
  for (const Kind kind : {Kind::kTaken, Kind::kReached, Kind::kAvoiding, Kind::kReached, Kind::kDropped}) {
    log.note(of(PointReport{kind, 0, "A"}));
  }
  EXPECT_EQ(log.report.phase, MissionPhase::kUnderWay);
  EXPECT_EQ(log.report.reached, 2u);
  EXPECT_EQ(log.report.dropped, 1u);
  log.note(of(MissionReport{MissionPhase::kFinished, 3, 1, ""}));
  EXPECT_EQ(log.report.reached, 3u) << "the report counts for itself";
}

}  // namespace
}  // namespace isobath::mission_log

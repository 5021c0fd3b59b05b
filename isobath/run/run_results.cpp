#include <fmt/format.h>
#include <isobath/io/input/pose_track.hpp>
#include <isobath/onboard/event_gate.hpp>
#include <isobath/run/run_results.hpp>
#include <string>

namespace isobath {
namespace {

constexpr std::uint64_t kFew = 100;  // one event of so many

/// Problems of the input itself, as one line. A damaged part in the middle is not a problem in this sense.
void judge_input(RunOutcome& outcome) {
  const SourceReport& source = outcome.source;
  if (!source.damages.empty() && source.bytes_total > 0) {
    const Damage& last = source.damages.back();
    if (last.offset + last.bytes >= source.bytes_total) {
      outcome.cut = true;
      outcome.problem =
          fmt::format("the log is cut off: its last {} bytes, from byte {}, are not a complete record ({})", last.bytes,
                      last.offset, last.reason);
      return;
    }
  }
  for (const char* reason : {EventGate::kBadNavigation, EventGate::kBackwards, kBadPose, kPoseBackwards}) {
    const auto found = outcome.rejected.find(reason);
    if (found == outcome.rejected.end()) continue;
    const PipelineCounts& n = outcome.counts;
    const std::uint64_t all = found->second + n.pings + n.navigation + n.ranges + n.swaths;
    const bool few = kFew * found->second < all;
    const std::string text = fmt::format("{}: {} of {} events were rejected for this", reason, found->second, all);
    if (!few) {
      outcome.problem = text;
      return;
    }
    outcome.warning += (outcome.warning.empty() ? "" : "; ") + text;
  }
}

}  // namespace

void add_results(RunOutcome& outcome, const Pipeline& pipeline, const DepthModel& depths, bool mapped) {
  outcome.counts = pipeline.counts();
  outcome.rejected = outcome.source.rejected;
  for (const auto& [reason, count] : pipeline.rejected()) outcome.rejected[reason] += count;
  if (outcome.counts.pings > 0) outcome.undecided = pipeline.undecided();
  outcome.fan = pipeline.departure();
  outcome.alarms = alarms_of(pipeline.emergencies());
  for (const Alarm& alarm : alarms_of(depths.emergencies())) outcome.alarms.push_back(alarm);
  judge_input(outcome);
  if (outcome.counts.pings + outcome.counts.vertical + outcome.counts.ranges + outcome.counts.swaths == 0 &&
      outcome.problem.empty())
    outcome.problem = "no ping, range or sounding of the input could be used";
  if (outcome.counts.pings + outcome.counts.vertical == 0 && outcome.counts.scans == 0 && !depths.snapshot() &&
      !mapped && outcome.problem.empty())
    outcome.problem = "no range or sounding has a position; give the track of the vehicle (input.navigation)";
}

}  // namespace isobath

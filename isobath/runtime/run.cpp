#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/io/open.hpp>
#include <isobath/io/pose_track.hpp>
#include <isobath/runtime/prefetch.hpp>
#include <isobath/runtime/run.hpp>
#include <isobath/runtime/run_folder.hpp>
#include <isobath/runtime/scenario.hpp>

namespace isobath {
namespace {

using Clock = std::chrono::steady_clock;  // for timings alone: no result depends on it

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::unique_ptr<Source> open(const RunRequest& request) {
  std::unique_ptr<Source> source = open_source(request.input, request.configuration.input);
  if (request.threads > 1) source = std::make_unique<PrefetchSource>(std::move(source));
  return source;
}

/// A scene is simulated here and now; it uses the threads itself.
std::unique_ptr<SimulatedSource> simulate(const RunRequest& request) {
  if (!is_scene(request.input)) return nullptr;
  return std::make_unique<SimulatedSource>(open_scene(request.input), request.configuration.simulation,
                                           std::min(request.threads, 2));
}

/// What the folder keeps and, for a simulated run, what the truth says of it.
class Sinks : public ResultSink {
 public:
  Sinks(RunFolder& folder, TruthJudge* judge) : folder_(folder), judge_(judge) {}
  void on_ping(const PosedPing& ping) override {
    folder_.on_ping(ping);
    if (judge_) judge_->on_ping(ping);
  }
  void on_scan(const ScanResult& scan) override {
    folder_.on_scan(scan);
    if (judge_) judge_->on_scan(scan);
  }

 private:
  RunFolder& folder_;
  TruthJudge* judge_;
};

RunTimings timings_of(std::vector<double>& ping_ms, double wall_ms) {
  RunTimings timings;
  timings.wall_s = wall_ms / 1000;
  if (ping_ms.empty()) return timings;
  std::sort(ping_ms.begin(), ping_ms.end());
  timings.ping_median_ms = ping_ms[ping_ms.size() / 2];
  timings.ping_p99_ms = ping_ms[ping_ms.size() * 99 / 100];
  return timings;
}

/// What makes the input itself wrong, as one line. A damaged stretch in the middle is none of these.
std::string problem_of(const RunOutcome& outcome) {
  const SourceReport& source = outcome.source;
  if (!source.damages.empty() && source.bytes_total > 0) {
    const Damage& last = source.damages.back();
    if (last.offset + last.bytes >= source.bytes_total) {
      return fmt::format("the log is cut off: its last {} bytes, from byte {}, are no whole record ({})", last.bytes,
                         last.offset, last.reason);
    }
  }
  for (const char* reason : {EventGate::kBadNavigation, EventGate::kBackwards, kBadPose, kPoseBackwards}) {
    const auto found = outcome.rejected.find(reason);
    if (found != outcome.rejected.end()) {
      return fmt::format("{}: {} of {} events were refused for it", reason, found->second,
                         found->second + outcome.counts.pings + outcome.counts.navigation + outcome.counts.ranges);
    }
  }
  return {};
}

}  // namespace

RunOutcome run(const RunRequest& request) {
  const auto simulated = simulate(request);
  const auto opened = simulated ? nullptr : open(request);
  Source* source = simulated ? static_cast<Source*>(simulated.get()) : opened.get();
  std::optional<TruthJudge> judge;
  if (simulated) simulated->tell_truth_to(&judge.emplace(simulated->simulator()));
  RunFolder folder(request.out, request.configuration);
  Sinks sinks(folder, judge ? &*judge : nullptr);
  Pipeline pipeline(request.configuration, sinks);
  RunOutcome outcome;

  const auto start = Clock::now();
  std::vector<double> ping_ms;
  Time first = Time::max(), last = Time::min();
  while (auto event = source->next()) {
    const bool is_ping = std::holds_alternative<Ping>(*event);
    const Time time = time_of(*event);
    const auto begun = Clock::now();
    const std::uint64_t mapped = pipeline.counts().pings;
    pipeline.take(std::move(*event));
    if (is_ping || pipeline.counts().pings > mapped) ping_ms.push_back(milliseconds_since(begun));
    first = std::min(first, time);
    last = std::max(last, time);
    if (request.progress) request.progress(source->report(), pipeline.counts());
  }
  pipeline.finish();
  outcome.timings = timings_of(ping_ms, milliseconds_since(start));
  outcome.counts = pipeline.counts();
  outcome.source = source->report();
  outcome.rejected = outcome.source.rejected;
  for (const auto& [reason, count] : pipeline.rejected()) outcome.rejected[reason] += count;
  outcome.log_s = last > first ? to_seconds(last - first) : 0;
  outcome.undecided = pipeline.undecided();
  outcome.problem = problem_of(outcome);
  if (outcome.counts.pings + outcome.counts.ranges == 0 && outcome.problem.empty())
    outcome.problem = "no ping in it could be used";
  if (judge) {
    outcome.truth = judge->score();
    folder.show_truth(judge->outlines());
  }
  folder.write(request, pipeline.grid(), outcome);
  return outcome;
}

}  // namespace isobath

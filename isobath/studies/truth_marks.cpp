#include <algorithm>
#include <deque>
#include <isobath/base/error.hpp>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/sim/world.hpp>
#include <isobath/studies/truth_marks.hpp>

namespace isobath {
namespace {

/// Gives the truth of each ping, in the order of the log.
class TruthOfPings {
 public:
  explicit TruthOfPings(const std::filesystem::path& log) : reader_(log) {}

  std::optional<EchoTruth> take(const Ping& ping) {
    while (read_to_ < ping.time || waiting_.empty()) {
      auto next = reader_.next();
      if (!next) break;
      auto* echoes = std::get_if<EchoTruth>(&*next);
      if (!echoes) continue;
      read_to_ = echoes->time;
      waiting_.push_back(std::move(*echoes));
    }
    const auto own = std::find_if(waiting_.begin(), waiting_.end(), [&ping](const EchoTruth& t) {
      return t.time == ping.time && t.beams == ping.intensity.beams() && t.bins == ping.window.bins;
    });
    if (own == waiting_.end()) return std::nullopt;
    EchoTruth truth = std::move(*own);
    waiting_.erase(own);
    while (!waiting_.empty() && waiting_.front().time < ping.time) waiting_.pop_front();
    return truth;
  }

 private:
  TruthReader reader_;
  Time read_to_ = Time::min();
  std::deque<EchoTruth> waiting_;
};

}  // namespace

TruthMarks read_truth_marks(const std::filesystem::path& log, const InputConfig& config, const std::string& sonar) {
  TruthMarks marks;
  TruthOfPings truths(log);
  std::string wanted = sonar;
  const auto source = open_source(log, config);
  while (const auto event = source->next()) {
    const auto* ping = std::get_if<Ping>(&*event);
    if (!ping || check(*ping) != PingFault::kNone) continue;
    const std::optional<EchoTruth> truth = truths.take(*ping);
    if (!truth) continue;
    if (wanted.empty()) wanted = truth->sonar;
    if (truth->sonar != wanted) continue;
    MarkedFrame frame{*ping, true, {}};
    bool direct = false;
    for (const EchoLabel label : truth->labels) {
      if (label.target() < kFirstBody) continue;
      frame.background = false;
      direct |= label.path() == EchoPath::kDirect;
    }
    if (!frame.background && !direct) {
      ++marks.left_out;
      continue;
    }
    if (!frame.background) {
      for (const EchoLabel label : truth->labels) {
        frame.marked.push_back(label.target() >= kFirstBody && label.path() == EchoPath::kDirect ? 1 : 0);
      }
    }
    marks.frames.push_back(std::move(frame));
  }
  if (marks.frames.empty()) {
    throw Error(sonar.empty() ? "the log has no ground truth" : "the log has no ground truth of a sonar " + sonar,
                {.file = log.string()}, "a log of isobath sim");
  }
  return marks;
}

}  // namespace isobath

#include <isobath/onboard/stage_cpu_time.hpp>
#include <isobath/onboard/stage_times.hpp>
#include <utility>

namespace isobath {
namespace {

constexpr std::size_t kMaxUndecided = 64;  // sweeps; bounds the list if the Navigator is lost and decides on none

double milliseconds(StageTimes::Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

class TimedAgent final : public Agent {
 public:
  TimedAgent(std::unique_ptr<Agent> agent, std::shared_ptr<StageTimes> times, bool plans)
      : agent_(std::move(agent)), times_(std::move(times)), plans_(plans) {}

  void on_message(const Message& message, Time now, Outbox& out) override {
    const auto from = StageTimes::Clock::now();
    const std::int64_t worked = thread_nanoseconds();
    agent_->on_message(message, now, out);
    times_->worked(thread_nanoseconds() - worked);
    const auto* scan = plans_ ? std::get_if<ObstacleScan>(&message) : nullptr;
    if (scan) times_->planned(scan->time, from, StageTimes::Clock::now());
  }
  void tick(Time now, Outbox& out) override {
    const std::int64_t worked = thread_nanoseconds();
    agent_->tick(now, out);
    times_->worked(thread_nanoseconds() - worked);
  }

 private:
  std::unique_ptr<Agent> agent_;
  std::shared_ptr<StageTimes> times_;
  bool plans_;
};

}  // namespace

void StageTimes::heard(Clock::duration lasted) {
  const std::lock_guard lock(mutex_);
  heard_.add(milliseconds(lasted));
}

void StageTimes::begin(Clock::time_point taken) {
  const std::lock_guard lock(mutex_);
  taken_ = taken;
  since_ = Clock::now();
}

void StageTimes::mapped() {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  mapped_.add(milliseconds(now - since_));
}

void StageTimes::detected(Time sweep) {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  detected_.add(milliseconds(now - since_));
  sweeps_[sweep] = taken_;
  if (sweeps_.size() > kMaxUndecided) sweeps_.erase(sweeps_.begin());
}

void StageTimes::aside() {
  const std::lock_guard lock(mutex_);
  aside_since_ = Clock::now();
}

void StageTimes::resume() {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  taken_ += now - aside_since_;
  since_ = now;
}

void StageTimes::planned(Time scan, Clock::time_point from, Clock::time_point to) {
  const std::lock_guard lock(mutex_);
  planned_.add(milliseconds(to - from));
  const auto sweep = sweeps_.find(scan);
  if (sweep == sweeps_.end()) return;
  decided_.add(milliseconds(to - sweep->second));
  sweeps_.erase(sweep);
}

MissionTimings StageTimes::timings() const {
  const std::lock_guard lock(mutex_);
  return {.event_to_agents = heard_.time(),
          .ping_to_grid = mapped_.time(),
          .detection = detected_.time(),
          .planning = planned_.time(),
          .scan_to_decision = decided_.time(),
          .cycle = {},
          .agents_s = 1e-9 * static_cast<double>(agents_ns_.load())};
}

AgentSlot timed(AgentSlot slot, std::shared_ptr<StageTimes> times, bool plans) {
  slot.agent = std::make_unique<TimedAgent>(std::move(slot.agent), std::move(times), plans);
  return slot;
}

}  // namespace isobath

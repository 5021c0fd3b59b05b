#include <atomic>
#include <isobath/mission/command/threaded_executor.hpp>
#include <isobath/onboard/threaded_helm.hpp>
#include <mutex>
#include <utility>

namespace isobath {

struct ThreadedHelm::State {
  State(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config)
      : executor(
            std::move(slots), vehicle, config, [this] { return Time(Duration(now.load())); },
            [this](const Envelope& envelope) { note(envelope); }) {}

  void note(const Envelope& envelope) {
    const std::lock_guard lock(book_mutex);
    book.note(envelope);
    if (book.frames.size() > kMaxFrames) book.frames.erase(book.frames.begin());
    if (listener) listener(envelope);
  }

  /// Copies what is new in the book for the thread that steers.
  void read_book() {
    const std::lock_guard lock(book_mutex);
    read.report = book.report;
    for (std::size_t i = read.decisions.size(); i < book.decisions.size(); ++i) {
      read.decisions.push_back(book.decisions[i]);
    }
  }

  std::mutex book_mutex;
  std::atomic<Duration::rep> now = 0;
  MissionLog book, read;
  Recorder listener;
  ThreadedExecutor executor;  ///< last, because its threads use all other members
};

ThreadedHelm::ThreadedHelm(std::vector<AgentSlot> slots, const VehicleParameters& vehicle, const ExecutorConfig& config,
                           std::shared_ptr<const MissionPlan> plan, WorldSnapshot chart, double echo_contrast)
    : AgentsHelm(std::move(plan), std::move(chart), echo_contrast),
      state_(std::make_unique<State>(std::move(slots), vehicle, config)) {
  steer_by(state_->executor);
}

ThreadedHelm::~ThreadedHelm() = default;

void ThreadedHelm::moved(Time now) { state_->now.store(now.time_since_epoch().count()); }

Setpoint ThreadedHelm::steer() {
  const Setpoint setpoint = state_->executor.helm();
  state_->read_book();
  return setpoint;
}

std::uint64_t ThreadedHelm::served() const { return state_->executor.served(); }

void ThreadedHelm::settle() {
  state_->executor.settle();
  state_->read_book();
}

MissionReport ThreadedHelm::progress() const { return state_->read.report; }

const std::vector<Decision>& ThreadedHelm::decisions() const { return state_->read.decisions; }

std::vector<FrameBytes> ThreadedHelm::to_operator() {
  const std::lock_guard lock(state_->book_mutex);
  return std::exchange(state_->book.frames, {});
}

std::vector<FrameBytes> ThreadedHelm::to_group() {
  const std::lock_guard lock(state_->book_mutex);
  return std::exchange(state_->book.group_frames, {});
}

std::optional<SonarOrder> ThreadedHelm::take_sonar_order() {
  const std::lock_guard lock(state_->book_mutex);
  return std::exchange(state_->book.sonar, std::nullopt);
}

bool ThreadedHelm::take_acknowledgement() {
  const std::lock_guard lock(state_->book_mutex);
  return std::exchange(state_->book.acknowledged, false);
}

void ThreadedHelm::show_messages_to(const Recorder& recorder) {
  const std::lock_guard lock(state_->book_mutex);
  state_->listener = recorder;
}

ExecutorCounts ThreadedHelm::executor_counts() const { return state_->executor.counts(); }

}  // namespace isobath

#include <atomic>
#include <isobath/mission/threaded_crew.hpp>
#include <isobath/runtime/live_helm.hpp>
#include <mutex>
#include <utility>

namespace isobath {

struct LiveHelm::State {
  State(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config)
      : crew(
            std::move(seats), vehicle, config, [this] { return Time(Duration(now.load())); },
            [this](const Envelope& envelope) { note(envelope); }) {}

  void note(const Envelope& envelope) {
    const std::lock_guard lock(book_mutex);
    book.note(envelope);
    if (book.frames.size() > kMostFrames) book.frames.erase(book.frames.begin());
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
  Logbook book, read;
  Recorder listener;
  ThreadedCrew crew;  ///< last, because its threads use all other members
};

LiveHelm::LiveHelm(std::vector<Seat> seats, const VehicleSheet& vehicle, const CrewConfig& config,
                   std::shared_ptr<const MissionPlan> plan, ChartUpdate chart, double echo_contrast)
    : CrewHelm(std::move(plan), std::move(chart), echo_contrast),
      state_(std::make_unique<State>(std::move(seats), vehicle, config)) {}

LiveHelm::~LiveHelm() = default;

void LiveHelm::moved(Time now) { state_->now.store(now.time_since_epoch().count()); }

void LiveHelm::say(Message message, Time /*now*/) { state_->crew.hear(std::move(message)); }

void LiveHelm::fail(const std::string& agent, bool hangs) { inject_failure(state_->crew, agent, hangs); }

Setpoint LiveHelm::steer() {
  const Setpoint setpoint = state_->crew.helm();
  state_->read_book();
  return setpoint;
}

void LiveHelm::settle() {
  state_->crew.settle();
  state_->read_book();
}

MissionReport LiveHelm::progress() const { return state_->read.report; }

const std::vector<Decision>& LiveHelm::decisions() const { return state_->read.decisions; }

std::vector<FrameBytes> LiveHelm::to_operator() {
  const std::lock_guard lock(state_->book_mutex);
  return std::exchange(state_->book.frames, {});
}

void LiveHelm::show_messages_to(const Recorder& recorder) {
  const std::lock_guard lock(state_->book_mutex);
  state_->listener = recorder;
}

CrewCounts LiveHelm::crew_counts() const { return state_->crew.counts(); }

}  // namespace isobath

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <isobath/runtime/live_loop.hpp>
#include <mutex>
#include <thread>

namespace isobath {

/// The ears are used by two threads, one at a time; the crew below them has locks of its own.
struct LiveLoop::State : public ResultSink {
  State(std::vector<Seat> seats, const VehicleSheet& vehicle, std::shared_ptr<const MissionPlan> plan,
        const Configuration& configuration)
      : ears(
            std::move(plan), configuration.safety.echo_contrast,
            [this](Message message, Time time) {
              now.store(time.time_since_epoch().count());
              crew.hear(std::move(message));
            },
            [](const std::string&, bool) {}),  // faults of agents are for crews that take turns
        pipeline(configuration, *this),
        crew(
            std::move(seats), vehicle, configuration.crew, [this] { return Time(Duration(now.load())); },
            [this](const Envelope& envelope) { note(envelope); }),
        mapping([this] { map(); }) {}

  ~State() override {
    {
      const std::lock_guard lock(queue_mutex);
      stop = true;
    }
    queue_changed.notify_all();
    mapping.join();
  }

  void note(const Envelope& envelope) {
    const std::lock_guard lock(note_mutex);
    if (const auto* decision = std::get_if<Decision>(&envelope.message)) decisions.push_back(*decision);
    if (const auto* said = std::get_if<MissionReport>(&envelope.message)) report = *said;
  }

  void on_ping(const PosedPing& ping) override {
    const std::lock_guard lock(ears_mutex);
    ears.on_ping(ping);
  }
  void on_scan(const ScanResult& scan) override {
    const std::lock_guard lock(ears_mutex);
    ears.on_scan(scan);
  }

  void hear(const Event& event) {
    const std::lock_guard lock(ears_mutex);
    ears.hear(event);
    now.store(ears.now().time_since_epoch().count());
  }

  void queue_up(Event event) {
    {
      const std::lock_guard lock(queue_mutex);
      if (queue.size() >= kLongestQueue) {
        const auto oldest =
            std::find_if(queue.begin(), queue.end(), [](const Event& e) { return std::holds_alternative<Ping>(e); });
        if (oldest != queue.end()) {
          queue.erase(oldest);
          ++lost_pings;
        }
      }
      queue.push_back(std::move(event));
    }
    queue_changed.notify_all();
  }

  void map() {
    std::unique_lock lock(queue_mutex);
    while (true) {
      queue_changed.wait(lock, [this] { return stop || !queue.empty(); });
      if (queue.empty()) return;
      Event event = std::move(queue.front());
      queue.pop_front();
      busy = true;
      lock.unlock();
      pipeline.take(std::move(event));
      lock.lock();
      busy = false;
      if (queue.empty()) queue_changed.notify_all();
    }
  }

  void wait_for_mapping() {
    std::unique_lock lock(queue_mutex);
    queue_changed.wait(lock, [this] { return queue.empty() && !busy; });
  }

  std::mutex ears_mutex, note_mutex, queue_mutex;
  std::condition_variable queue_changed;
  std::atomic<Duration::rep> now = 0;
  MissionReport report;
  std::vector<Decision> decisions;
  std::deque<Event> queue;
  std::uint64_t lost_pings = 0;
  bool busy = false, stop = false;
  MissionEars ears;
  Pipeline pipeline;
  ThreadedCrew crew;
  std::thread mapping;  ///< last: it uses all the others
};

LiveLoop::LiveLoop(std::vector<Seat> seats, const VehicleSheet& vehicle, std::shared_ptr<const MissionPlan> plan,
                   const Configuration& configuration)
    : state_(std::make_unique<State>(std::move(seats), vehicle, std::move(plan), configuration)) {}

LiveLoop::~LiveLoop() = default;

void LiveLoop::take(Event event) {
  state_->hear(event);
  state_->queue_up(std::move(event));
}

Setpoint LiveLoop::steer() { return state_->crew.helm(); }

void LiveLoop::settle() {
  state_->wait_for_mapping();
  state_->crew.settle();
}

MissionReport LiveLoop::progress() const {
  const std::lock_guard lock(state_->note_mutex);
  return state_->report;
}

std::vector<Decision> LiveLoop::decisions() const {
  const std::lock_guard lock(state_->note_mutex);
  return state_->decisions;
}

LiveCounts LiveLoop::counts() {
  settle();
  return {state_->pipeline.counts(), state_->crew.counts(), state_->lost_pings};
}

LoopResult run_live_loop(const Scenario& scenario, std::vector<Seat> seats, const VehicleSheet& vehicle,
                         const Configuration& configuration) {
  SimulatedSource source(scenario.scene, configuration.simulation, 1);
  Simulator& simulator = source.simulator();
  TrueTrack truth(simulator);
  source.tell_truth_to(&truth);
  LiveLoop loop(std::move(seats), vehicle, std::make_shared<const MissionPlan>(scenario.mission), configuration);
  double settled_s = 0;
  EndOfMission end;
  while (auto event = source.next()) {
    loop.take(std::move(*event));
    if (simulator.now_s() - settled_s >= to_seconds(kTick)) {
      loop.settle();
      settled_s = simulator.now_s();
      if (end.reached(loop.progress().phase, settled_s)) break;
    }
    simulator.command(loop.steer());
  }
  const LiveCounts counts = loop.counts();
  return {truth.truth(), loop.decisions(), loop.progress(), counts.pipeline, simulator.now_s(), {}};
}

}  // namespace isobath

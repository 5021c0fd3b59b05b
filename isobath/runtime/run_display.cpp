#include <isobath/runtime/run_display.hpp>
#include <memory>
#include <utility>

namespace isobath {
namespace {

constexpr Duration kLookInterval = std::chrono::milliseconds(950);

}  // namespace

/// A ping for later: its samples stay where they are.
struct RunDisplay::KeptPing {
  explicit KeptPing(const PosedPing& posed) : ping(posed.ping), X_WB(posed.X_WB), decisions(posed.decisions) {}
  [[nodiscard]] PosedPing posed() const { return {ping, X_WB, decisions}; }
  Ping ping;
  Pose X_WB;
  EchoDecisions decisions;
};

struct RunDisplay::KeptScan {
  explicit KeptScan(const ScanResult& scan)
      : number(scan.number), posed(scan.posed), detection(scan.detection), grid(scan.grid) {}
  [[nodiscard]] ScanResult result() const { return {number, posed, detection, grid}; }
  int number;
  bool posed;
  Detection detection;
  BodyGrid grid;
};

RunDisplay::RunDisplay(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input) {
  if (!request.record.empty()) begin_recording(request, setup, input);
  if (request.watch && request.watch->display) shown_ = request.watch->display;
  if (RunFilm::wanted(request.configuration.report) && !request.live_speed) film_.emplace(request.configuration.report);
  if (!request.watch && !recorder_ && !film_) return;
  display_.emplace(*shown_);
  if (!request.live_speed) return;
  voxels_.emplace(*shown_);
  thread_.emplace();
}

void RunDisplay::begin_recording(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input) {
  recorder_.emplace(request.record, request.configuration);
  if (SimulatedSource* simulated = input.simulated()) {
    recorder_->describe(simulated->simulator(), scenario_text(request.input), request.live_speed.has_value());
  } else {
    recorder_->describe(input.report());
  }
  if (setup) recorder_->describe(*setup);
}

void RunDisplay::hear(const Event& event, const std::optional<GeoOrigin>& origin) {
  if (!thread_) return show_event(event, origin);
  const Kind kind = std::holds_alternative<Ping>(event) ? Kind::kPing : Kind::kNote;
  thread_->take(kind, [this, event, origin] { show_event(event, origin); });
}

void RunDisplay::show_event(const Event& event, const std::optional<GeoOrigin>& origin) {
  if (recorder_) {
    if (origin) recorder_->locate(*origin);
    recorder_->take(event);
  }
  display_->hear(event);
}

template <class Truth>
void RunDisplay::take_truth(const Truth& truth) {
  if (!recorder_) return;
  if (!thread_) return recorder_->take(truth);
  thread_->take(Kind::kNote, [this, truth] { recorder_->take(truth); });
}
template void RunDisplay::take_truth(const EchoTruth& truth);
template void RunDisplay::take_truth(const TrueMotion& truth);

void RunDisplay::steered(Time time, const Setpoint& setpoint, const std::vector<Decision>& decisions) {
  if (!thread_) {
    display_->want(setpoint);
    if (!recorder_) return;
    recorder_->decided(decisions);
    recorder_->setpoint(time, setpoint);
    return;
  }
  thread_->take(Kind::kNote, [this, time, setpoint] {
    display_->want(setpoint);
    if (recorder_) recorder_->setpoint(time, setpoint);
  });
}

bool RunDisplay::wants_scene(Time time) {
  if (!thread_) return display_->wants_counts(time);
  if (!show_again(scene_shown_, time, kLookInterval)) return false;
  scene_shown_ = time;
  return true;
}

void RunDisplay::show(Time time, const DisplayScene& scene) {
  if (!thread_) return display_->show(time, scene);
  thread_->take(Kind::kNote, [this, time, scene] { display_->show(time, scene); });
}

void RunDisplay::show(Time time, const MissionTimings& timings, std::uint64_t lost_pings) {
  if (!thread_) {
    if (shown_ != &items_) display_->show(time, timings);  // no recording holds what a real clock measured
    return;
  }
  thread_->take(Kind::kNote, [this, time, timings, lost_pings] {
    lost_pings_ = lost_pings;
    display_->show(time, timings);
  });
}

void RunDisplay::take_ping(const PosedPing& ping, void (RunDisplay::*show)(const PosedPing&)) {
  if (!thread_) return (this->*show)(ping);
  thread_->take(Kind::kPing,
                [this, show, kept = std::make_shared<const KeptPing>(ping)] { (this->*show)(kept->posed()); });
}

void RunDisplay::on_ping(const PosedPing& ping) { take_ping(ping, &RunDisplay::show_ping); }
void RunDisplay::on_upright(const PosedPing& ping) { take_ping(ping, &RunDisplay::show_upright); }

void RunDisplay::show_ping(const PosedPing& ping) {
  if (recorder_) recorder_->on_ping(ping);
  display_->on_ping(ping);
}

void RunDisplay::show_upright(const PosedPing& ping) {
  if (recorder_) recorder_->on_upright(ping);
  display_->on_upright(ping);
}

void RunDisplay::on_scan(const ScanResult& scan) {
  if (!thread_) return show_scan(scan);
  thread_->take(Kind::kPing, [this, kept = std::make_shared<const KeptScan>(scan)] { show_scan(kept->result()); });
}

void RunDisplay::show_scan(const ScanResult& scan) {
  if (recorder_) recorder_->on_scan(scan);
  display_->on_scan(scan);
}

void RunDisplay::on_jump(const Eigen::Vector3d& by_W) {
  if (!thread_) return display_->on_jump(by_W);
  voxels_->voxels_moved(counted_.value_or(Time{}));
}

void RunDisplay::look(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) {
  if (!thread_) return display_->look(time, pipeline, depths, voxels);
  if (const VoxelMap* map = voxels.map()) voxels_->show(time, *map);
  if (show_again(depths_shown_, time, MapDisplay::kDepthInterval)) {
    depths_shown_ = time;
    if (auto snapshot = depths.snapshot()) {
      thread_->take(Kind::kNote, [this, time, snapshot] { display_->show(time, snapshot); });
    }
  }
  if (!show_again(counted_, time, kLookInterval)) return;
  counted_ = time;
  thread_->take(Kind::kNote, [this, time, counts = display_counts(pipeline, depths)] {
    counts_ = counts;
    show_counts(time);
  });
}

void RunDisplay::show_counts(Time time) {
  counts_->lost_pings = lost_pings_;
  counts_->left_out = thread_->left_out();
  display_->show(time, *counts_);
}

void RunDisplay::heard(const Envelope& envelope) {
  if (!thread_) return show_message(envelope);
  thread_->take(Kind::kNote, [this, envelope] { show_message(envelope); });
}

void RunDisplay::show_message(const Envelope& envelope) {
  display_->heard(envelope);
  if (recorder_) recorder_->heard(envelope);
  if (!thread_) return;
  const auto* decision = std::get_if<Decision>(&envelope.message);
  if (decision && recorder_) {
    decisions_.push_back(*decision);
    recorder_->decided(decisions_);
  }
  if (counts_ && display_->wants_counts(envelope.time)) show_counts(envelope.time);  // a fault is shown at once
}

void RunDisplay::sample(Time time) {
  if (!thread_) return show_sample(time);
  thread_->take(Kind::kNote, [this, time] { show_sample(time); });
}

void RunDisplay::show_sample(Time time) {
  if (recorder_) recorder_->sample(time, *shown_);
  if (film_) film_->sample(time, *shown_);
}

void RunDisplay::settle() {
  if (thread_) thread_->settle();
}

void RunDisplay::finish(Time last) {
  if (thread_) thread_->close();
  if (!recorder_) return;
  recorder_->sample(last, *shown_, true);
  recorder_->close();
}

DisplayThread::LeftOut RunDisplay::left_out() const { return thread_ ? thread_->left_out() : DisplayThread::LeftOut{}; }

std::string RunDisplay::problem() const { return thread_ ? thread_->problem() : std::string(); }

}  // namespace isobath

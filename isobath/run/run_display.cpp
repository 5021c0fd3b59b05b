#include <isobath/run/run_display.hpp>
#include <memory>
#include <utility>

namespace isobath {
namespace {

constexpr Duration kLookInterval = std::chrono::milliseconds(950);

}  // namespace

/// A copy of a ping for the display thread. It shares the samples.
struct RunDisplay::KeptPing {
  Ping ping;
  Pose X_WB;
  EchoDecisions decisions;
};

struct RunDisplay::KeptScan {
  int number;
  bool posed;
  Detection detection;
  BodyGrid grid;
};

std::shared_ptr<const RunDisplay::KeptPing> RunDisplay::keep(const PosedPing& ping) {
  return std::make_shared<const KeptPing>(KeptPing{ping.ping, ping.X_WB, ping.decisions});
}

std::shared_ptr<const RunDisplay::KeptScan> RunDisplay::keep(const ScanResult& scan) {
  return std::make_shared<const KeptScan>(KeptScan{scan.number, scan.posed, scan.detection, scan.grid});
}

namespace {

/// Turns the kept copy into the argument of the call.
template <class Kept>
const Kept& as_told(const Kept& kept) {
  return kept;
}
template <class Kept>
auto as_told(const std::shared_ptr<const Kept>& kept) requires requires {
  kept->decisions;
}
{ return PosedPing{kept->ping, kept->X_WB, kept->decisions}; }
template <class Kept>
auto as_told(const std::shared_ptr<const Kept>& kept) requires requires {
  kept->detection;
}
{ return ScanResult{kept->number, kept->posed, kept->detection, kept->grid}; }

}  // namespace

template <class... Told>
void RunDisplay::post(Kind kind, void (RunDisplay::*show)(const Told&...), const Told&... told) {
  if (!thread_) return (this->*show)(told...);
  thread_->push(kind, [this, show, ... kept = keep(told)] { (this->*show)(as_told(kept)...); });
}

RunDisplay::RunDisplay(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input)
    : input_(input) {
  if (!request.record.empty()) begin_recording(request, setup, input);
  if (request.watch && request.watch->display) shown_ = request.watch->display;
  if (EmbeddedReplay::wanted(request.configuration.report) && !request.has_real_threads())
    replay_.emplace(request.configuration.report);
  if (!request.watch && !recorder_ && !replay_) return;
  display_.emplace(*shown_);
  if (request.watch && request.watch->viewers)
    show_to(*request.watch->viewers, request.configuration.recorder.foxglove);
  if (!request.has_real_threads()) return;
  voxels_.emplace(*shown_);
  thread_.emplace(kWaiting);
}

void RunDisplay::begin_recording(const RunRequest& request, const std::optional<MissionSetup>& setup, RunInput& input) {
  recorder_.emplace(request.record, request.configuration);
  if (SimulatedSource* simulated = input.simulated()) {
    recorder_->describe(simulated->simulator(), scenario_text(request.input), request.live_speed.has_value());
  } else {
    recorder_->describe(input.report(), request.has_real_threads());
  }
  if (setup) recorder_->describe(*setup);
}

void RunDisplay::show_to(ViewerFeed& viewers, const FoxgloveConfig& config) {
  viewers_ = &viewers;
  foxglove_.emplace(
      FoxgloveLog::Channels{
          [&viewers](FoxgloveKind kind, const std::string& topic) {
            return viewers.open({topic, foxglove_name(kind), foxglove_schema(kind), kind == FoxgloveKind::kLog});
          },
          [&viewers](std::size_t channel, Time time, const std::string& message) {
            viewers.write(channel, time, message);
          }},
      config);
}

// Called by the source thread ----------------------------------------------------------------------------------------

void RunDisplay::on_event(const Event& event) {
  const Kind kind = std::holds_alternative<Ping>(event) ? Kind::kPing : Kind::kNote;
  post(kind, &RunDisplay::show_event, event, input_.origin());
}

void RunDisplay::show_event(const Event& event, const std::optional<GeoOrigin>& origin) {
  if (recorder_) {
    if (origin) recorder_->locate(*origin);
    recorder_->on_event(event);
  }
  if (foxglove_ && origin) foxglove_->locate(*origin);
  if (!std::holds_alternative<Navigation>(event)) display_->on_event(event);
}

void RunDisplay::on_fix(const Navigation& fix) { post(Kind::kNote, &RunDisplay::show_fix, fix); }

void RunDisplay::show_fix(const Navigation& fix) {
  if (recorder_) recorder_->on_fix(fix);
  if (foxglove_) foxglove_->on_fix(fix);
  display_->on_event(fix);
}

void RunDisplay::on_truth(const EchoTruth& echoes) {
  if (recorder_) post(Kind::kNote, &RunDisplay::show_truth<EchoTruth>, echoes);
}

void RunDisplay::on_truth(const TrueMotion& motion) {
  if (recorder_) post(Kind::kNote, &RunDisplay::show_truth<TrueMotion>, motion);
}

template <class Truth>
void RunDisplay::show_truth(const Truth& truth) {
  recorder_->on_truth(truth);
}

void RunDisplay::on_setpoint(Time time, const Setpoint& setpoint) {
  post(Kind::kNote, &RunDisplay::show_setpoint, time, setpoint);
}

void RunDisplay::servo(Time time, std::uint64_t parent, const ServoCommands& commands) {
  post(Kind::kNote, &RunDisplay::show_servo, time, parent, commands);
}

void RunDisplay::show_servo(const Time& time, const std::uint64_t& parent, const ServoCommands& commands) {
  display_->on_servo(time, parent, commands.text);
  if (recorder_) recorder_->servo(time, parent, commands.values);
}

void RunDisplay::show_setpoint(const Time& time, const Setpoint& setpoint) {
  display_->want(setpoint);
  if (recorder_) recorder_->setpoint(time, setpoint);
}

bool RunDisplay::wants_scene(Time time) {
  if (!thread_) return display_->wants_counts(time);
  if (!show_again(scene_shown_, time, kLookInterval)) return false;
  scene_shown_ = time;
  return true;
}

void RunDisplay::show(Time time, const DisplayScene& scene) { post(Kind::kNote, &RunDisplay::show_scene, time, scene); }

void RunDisplay::show_scene(const Time& time, const DisplayScene& scene) { display_->show(time, scene); }

void RunDisplay::show(Time time, const MissionTimings& timings, std::uint64_t lost_pings) {
  post(Kind::kNote, &RunDisplay::show_timings, time, timings, lost_pings);
}

/// Times of a real clock must not enter the recording of a sequential run.
void RunDisplay::show_timings(const Time& time, const MissionTimings& timings, const std::uint64_t& lost_pings) {
  lost_pings_ = lost_pings;
  if (thread_ || shown_ != &items_) display_->show(time, timings);
}

void RunDisplay::sample(Time time) { post(Kind::kNote, &RunDisplay::show_sample, time); }

void RunDisplay::show_sample(const Time& time) {
  if (recorder_) recorder_->sample(time, *shown_);
  if (replay_) replay_->sample(time, *shown_);
  if (!foxglove_ || !show_again(foxglove_sampled_, time, kLookInterval)) return;
  foxglove_sampled_ = time;
  const DisplayState::Changes changes = shown_->changes_after(foxglove_stamp_);
  foxglove_stamp_ = changes.stamp;
  foxglove_->on_display(time, changes.records);
}

// Called by the mapping thread ---------------------------------------------------------------------------------------

void RunDisplay::on_ping(const PosedPing& ping) { post(Kind::kPing, &RunDisplay::show_ping, ping); }

void RunDisplay::show_ping(const PosedPing& ping) {
  if (recorder_) recorder_->on_ping(ping);
  if (foxglove_ && viewers_->watched()) foxglove_->on_ping(ping);
  display_->on_ping(ping);
}

void RunDisplay::on_vertical_ping(const PosedPing& ping) { post(Kind::kPing, &RunDisplay::show_vertical_ping, ping); }

void RunDisplay::show_vertical_ping(const PosedPing& ping) {
  if (recorder_) recorder_->on_vertical_ping(ping);
  if (foxglove_ && viewers_->watched()) foxglove_->on_ping(ping);
  display_->on_vertical_ping(ping);
}

void RunDisplay::on_scan(const ScanResult& scan) { post(Kind::kPing, &RunDisplay::show_scan, scan); }

void RunDisplay::show_scan(const ScanResult& scan) {
  if (recorder_) recorder_->on_scan(scan);
  if (foxglove_) foxglove_->on_scan(scan);
  display_->on_scan(scan);
}

void RunDisplay::on_jump(const Eigen::Vector3d& by_W) {
  if (!thread_) return display_->on_jump(by_W);
  voxels_->voxels_moved(counted_.value_or(Time{}));
}

void RunDisplay::on_mapped(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) {
  if (thread_) look(time, pipeline, depths, voxels);
}

void RunDisplay::on_sphere(Time time, const std::shared_ptr<const GridSnapshot>& sphere) {
  post(Kind::kNote, &RunDisplay::show_sphere, time, sphere);
}

void RunDisplay::show_sphere(const Time& time, const std::shared_ptr<const GridSnapshot>& sphere) {
  display_->show(time, *sphere);
}

void RunDisplay::on_contacts(Time time, std::span<const Contact> contacts) {
  post(Kind::kNote, &RunDisplay::show_contacts, time, std::vector<Contact>(contacts.begin(), contacts.end()));
}

void RunDisplay::show_contacts(const Time& time, const std::vector<Contact>& contacts) {
  display_->show(time, std::span<const Contact>(contacts));
}

void RunDisplay::look(Time time, const Pipeline& pipeline, const DepthModel& depths, const VoxelModel& voxels) {
  if (!thread_) return display_->look(time, pipeline, depths, voxels);
  if (const VoxelMap* map = voxels.map()) voxels_->show(time, *map);
  if (show_again(depths_shown_, time, MapDisplay::kDepthInterval)) {
    depths_shown_ = time;
    if (const auto snapshot = depths.snapshot()) post(Kind::kNote, &RunDisplay::show_depths, time, snapshot);
  }
  if (!show_again(counted_, time, kLookInterval)) return;
  counted_ = time;
  post(Kind::kNote, &RunDisplay::take_counts, time, display_counts(pipeline, depths));
}

void RunDisplay::show_depths(const Time& time, const std::shared_ptr<const DepthSnapshot>& snapshot) {
  display_->show(time, snapshot);
}

void RunDisplay::take_counts(const Time& time, const DisplayCounts& counts) {
  counts_ = counts;
  show_counts(time);
}

void RunDisplay::show_counts(Time time) {
  counts_->lost_pings = lost_pings_;
  counts_->left_out = thread_->left_out();
  display_->show(time, *counts_);
}

// Called by the agents' threads --------------------------------------------------------------------------------------

void RunDisplay::on_message(const Envelope& envelope) { post(Kind::kNote, &RunDisplay::show_message, envelope); }

void RunDisplay::show_message(const Envelope& envelope) {
  display_->on_message(envelope);
  if (recorder_) recorder_->on_message(envelope);
  if (foxglove_) foxglove_->on_message(envelope);
  if (counts_ && display_->wants_counts(envelope.time)) show_counts(envelope.time);  // shows a fault at once
}

// The end ------------------------------------------------------------------------------------------------------------

void RunDisplay::settle() {
  if (thread_) thread_->settle();
}

void RunDisplay::finish(Time last) {
  if (thread_) thread_->close();
  if (!recorder_) return;
  recorder_->sample(last, *shown_, true);
  recorder_->close();
}

TaskThread::LeftOut RunDisplay::left_out() const { return thread_ ? thread_->left_out() : TaskThread::LeftOut{}; }

std::string RunDisplay::problem() const { return thread_ ? words_of(thread_->failure()) : std::string(); }

}  // namespace isobath

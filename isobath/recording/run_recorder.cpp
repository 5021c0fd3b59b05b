#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/display/decision_json.hpp>
#include <isobath/mission/plan/mission_file.hpp>
#include <isobath/recording/message_json.hpp>
#include <isobath/recording/run_recorder.hpp>
#include <isobath/recording/track_json.hpp>

namespace isobath {
namespace {

constexpr const char* kRealThreads = "real threads; a replay may decide otherwise";

/// Groups of channels. Each group has its own chunks, so that a reader of one kind reads nothing else. Events have 0.
enum ChannelGroup : int { kDisplayGroup = 1, kWholeGroup, kMessageGroup, kFoxgloveGroup };

constexpr const char* kToml = "application/toml";

constexpr const char* kRecordLayout =
    "Records, one after the other, little-endian; each replaces the item of its kind and number.\n"
    "u8 kind; u8 flags (bit 0: the item is gone, and there is no payload; bit 1: forget all items before); u16 0;\n"
    "u32 bytes of payload; u64 number; i64 time, ns since 1970; payload; zeros up to a multiple of 8 bytes.\n"
    "Kinds and payloads: docs/live-page.md of Isobath.\n";

const std::filesystem::path& checked_log_name(const std::filesystem::path& file) {
  if (file.extension() == ".mcap") return file;
  throw Error("cannot write this kind of file", {file.string(), {}, {}, {}, {}}, "a name that ends in .mcap");
}

bool same_setpoint(const Setpoint& a, const Setpoint& b) {
  return a.heading.radians() == b.heading.radians() && a.depth == b.depth && a.speed == b.speed &&
         a.sway_speed == b.sway_speed;
}

/// Leaves out the times of a real clock, so that the same run gives the same bytes.
std::string of_the_run(const std::string& records) {
  std::string kept;
  for_each_record(records, [&](const DisplayRecord& record) {
    if (record.kind == DisplayKind::kTimes) return;
    append_record(kept, record.kind, record.number, record.time, record.payload, record.gone);
  });
  return kept;
}

}  // namespace

RunRecorder::RunRecorder(const std::filesystem::path& file, const Configuration& configuration)
    : config_(configuration.recorder), log_(checked_log_name(file), configuration.recorder.log) {
  if (config_.foxglove.on) {
    foxglove_.emplace(
        FoxgloveLog::Channels{[this](FoxgloveKind kind, const std::string& topic) -> std::size_t {
                                const McapSchema schema{0, foxglove_name(kind), "jsonschema", foxglove_schema(kind)};
                                return log_.add_channel(topic, "json", schema, kFoxgloveGroup);
                              },
                              [this](std::size_t channel, Time time, const std::string& message) {
                                log_.write(static_cast<std::uint16_t>(channel), time, message);
                              }},
        config_.foxglove);
  }
  const McapSchema layout{0, "isobath.Display", "text", kRecordLayout};
  display_ = log_.add_channel(kDisplayTopic, "isobath.display", layout, kDisplayGroup);
  whole_ = log_.add_channel(kWholeDisplayTopic, "isobath.display", layout, kWholeGroup);
  log_.attach(kConfigurationAttachment, kToml, to_toml(configuration, false));
  log_.flush();  // so that a reader finds the channels at once
}

void RunRecorder::guarded(const std::function<void()>& write) {
  const std::lock_guard lock(mutex_);
  if (problem_.empty()) {
    try {
      write();
      return;
    } catch (const std::exception& e) {
      problem_ = e.what();
    }
  }
  ++left_out_;
}

void RunRecorder::describe(const Simulator& simulator, const std::string& scenario_toml, bool live) {
  guarded([&] {
    std::map<std::string, std::string> details{{"scene", simulator.scene().about.title},
                                               {"seed", fmt::format("{}", simulator.seed())}};
    if (live) details[kLiveDetail] = kRealThreads;
    log_.set_details(details);
    log_.attach(kScenarioAttachment, kToml, scenario_toml);
  });
  if (const auto origin = simulator.scene().origin()) locate(*origin);
}

void RunRecorder::describe(const SourceReport& source, bool live) {
  guarded([&] {
    std::map<std::string, std::string> details = source.details;
    if (live) details[kLiveDetail] = kRealThreads;
    log_.set_details(details);
  });
  if (source.origin) locate(*source.origin);
}

void RunRecorder::describe(const MissionSetup& setup) {
  guarded([&] {
    VehicleParameters vehicle = setup.vehicle;
    log_.attach(kMissionAttachment, kToml, write_mission(setup.plan));
    log_.attach(kVehicleAttachment, kToml, write_toml(vehicle_sections(vehicle), false));
  });
}

void RunRecorder::locate(const GeoOrigin& origin) {
  guarded([&] {
    if (located_) return;
    located_ = true;
    log_.set_origin(origin);
    if (foxglove_) foxglove_->locate(origin);
  });
}

void RunRecorder::on_event(const Event& event) {
  guarded([&] { log_.write(event); });
}

void RunRecorder::on_fix(const Navigation& fix) {
  if (!foxglove_) return;
  guarded([&] { foxglove_->on_fix(fix); });
}

void RunRecorder::on_truth(const EchoTruth& echoes) {
  guarded([&] { log_.write(echoes); });
}

void RunRecorder::on_truth(const TrueMotion& motion) {
  guarded([&] { log_.write(motion); });
}

void RunRecorder::on_ping(const PosedPing& ping) {
  if (!foxglove_) return;
  guarded([&] { foxglove_->on_ping(ping); });
}

void RunRecorder::on_scan(const ScanResult& scan) {
  guarded([&] {
    const bool moves = std::ranges::any_of(scan.detection.obstacles, &Obstacle::moves);
    if (moves && tracks_ == 0) {
      tracks_ =
          log_.add_channel(kTracksTopic, "json", {0, "isobath.Tracks", "jsonschema", tracks_schema()}, kMessageGroup);
    }
    if (tracks_ != 0) log_.write(tracks_, scan.detection.time, tracks_json(scan));
    if (foxglove_) foxglove_->on_scan(scan);
  });
}

void RunRecorder::on_message(const Envelope& envelope) {
  guarded([&] {
    if (messages_ == 0) {
      messages_ = log_.add_channel(kMessagesTopic, "json", {0, "isobath.Message", "jsonschema", message_schema()},
                                   kMessageGroup);
    }
    log_.write(messages_, envelope.time, message_json(envelope));
    if (foxglove_) foxglove_->on_message(envelope);
  });
  const auto* decision = std::get_if<Decision>(&envelope.message);
  if (decision) guarded([&] { log_.write_decision(decision->time, decision_json(*decision)); });
}

void RunRecorder::setpoint(Time time, const Setpoint& setpoint) {
  if (last_setpoint_ && same_setpoint(*last_setpoint_, setpoint)) return;
  last_setpoint_ = setpoint;
  guarded([&] { log_.write(time, setpoint); });
}

void RunRecorder::servo(Time time, std::uint64_t parent, const ActuatorVector& commands) {
  guarded([&] {
    if (servo_ == 0) {
      servo_ = log_.add_channel(kServoTopic, "json", {0, "isobath.Servo", "jsonschema", servo_schema()}, kMessageGroup);
    }
    log_.write(servo_, time, servo_json(time, parent, commands));
  });
}

bool RunRecorder::sample(Time time, const DisplayState& items, bool at_once) {
  if (sampled_ && (time < *sampled_ || (!at_once && time - *sampled_ < seconds(config_.display_s)))) return false;
  sampled_ = time;
  guarded([&] {
    const DisplayState::Changes changes = items.changes_after(stamp_);
    stamp_ = changes.stamp;
    std::string records = of_the_run(changes.records);
    if (changes.whole) mark_as_whole(records);
    if (!records.empty()) {
      log_.write(display_, time, records);
      bytes_since_whole_ += records.size();
    }
    if (foxglove_) foxglove_->on_display(time, records);
    const bool due =
        whole_at_ && time - *whole_at_ >= seconds(config_.keyframe_s) && bytes_since_whole_ > items.bytes();
    const bool hidden = whole_at_ == time && !records.empty();  // a seek reads only changes after the complete sample
    if (whole_at_ && !due && !hidden) return;
    std::string whole = of_the_run(items.changes_after(0).records);
    if (whole.empty()) return;
    mark_as_whole(whole);
    log_.write(whole_, time, whole);
    whole_at_ = time;
    bytes_since_whole_ = 0;
  });
  return true;
}

void RunRecorder::close() {
  guarded([&] { log_.close(); });
}

std::string RunRecorder::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

std::uint64_t RunRecorder::left_out() const {
  const std::lock_guard lock(mutex_);
  return left_out_;
}

}  // namespace isobath

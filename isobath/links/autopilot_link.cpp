#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/secret_file.hpp>
#include <isobath/links/autopilot_link.hpp>
#include <isobath/links/obstacle_ring.hpp>
#include <utility>
#include <vector>

namespace isobath {
namespace {

using namespace mavlink;

constexpr std::uint8_t kAutopilotComponent = 1;
constexpr std::uint16_t kRequestMessage = 512;
constexpr Duration kBeat = std::chrono::seconds(1), kSyncInterval = std::chrono::seconds(2);
constexpr Duration kAskInterval = std::chrono::seconds(2);

std::uint32_t milliseconds(Duration since) {
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(since).count());
}

const char* words_for(Authority authority) {
  switch (authority) {
    case Authority::kNoAutopilot: return "no autopilot";
    case Authority::kDisarmed: return "waits: disarmed";
    case Authority::kOtherMode: return "hands back: not GUIDED";
    case Authority::kOurs: return "steers: GUIDED, armed";
  }
  return "";
}

}  // namespace

AutopilotLink::AutopilotLink(const FrontSeatConfig& config, LinkSource& events)
    : FrontSeat(config, events),
      vehicle_(input_, report_),
      frames_(mavlink_frame_at),
      writer_(static_cast<std::uint8_t>(std::max(1, config.system)), kObstacleAvoidance) {
  if (config.system > 0) vehicle_.expect({.system = static_cast<std::uint8_t>(config.system), .local = true});
  if (config.key_file.empty()) return;
  const MavlinkKey key(secret_of_file(config.key_file));
  writer_.sign_with(key);
  trust_.emplace(key);
}

void AutopilotLink::send(std::uint32_t id, const PayloadBytes& body) {
  link_->send(writer_.frame(id, body, hub_->now()));
}

void AutopilotLink::on_open(Time /*time*/) { events_.note("autopilot", fmt::format("MAVLink at {}", config_.link)); }

void AutopilotLink::on_bytes(Bytes bytes, Time time) {
  frames_.push(bytes, time, offset_);
  offset_ += bytes.size();
  while (const auto found = frames_.next(report_)) {
    const char* const refused = trust_ ? to_text(trust_->judge(found->frame)) : nullptr;
    if (refused) {
      ++report_.rejected[refused];
    } else {
      on_frame(mavlink_frame(found->frame), time);
    }
  }
  tell_refused(report_);
}

void AutopilotLink::on_frame(const MavlinkFrame& frame, Time time) {
  if (frame.checksum != MavlinkFrame::Checksum::kRight) return;
  if (frame.id == Heartbeat::kId) on_heartbeat(frame, time);
  if (!vehicle_.system() || frame.system != *vehicle_.system()) return;
  const MavlinkPayload p(frame.payload);
  if (frame.id == TimeSync::kId) on_timesync(TimeSync::of(p), time);
  if (frame.component != kAutopilotComponent) return;
  if (download_) {
    download_->on_frame(frame, time);
    const std::lock_guard lock(mutex_);
    if (download_->done()) plan_ = download_->plan();
  }
  if (frame.id == SystemStatus::kId) {
    const std::lock_guard lock(mutex_);
    const int percent = SystemStatus::of(p).battery_percent;
    if (percent >= 0 && percent <= 100) battery_ = percent / 100.0;
  }
  auto event = vehicle_.take(time, frame);
  if (report_.origin) {
    events_.locate(*report_.origin, LinkSource::Locates::kFirst);
    const std::lock_guard lock(mutex_);
    origin_ = report_.origin;
  }
  if (!event) return;
  if (const auto* fix = std::get_if<Navigation>(&*event)) {
    const std::lock_guard lock(mutex_);
    fix_ = *fix;
    if (!gives_navigation_) return;
  }
  events_.give(std::move(*event));
}

void AutopilotLink::on_heartbeat(const MavlinkFrame& frame, Time time) {
  const auto beat = Heartbeat::of(MavlinkPayload(frame.payload));
  if (beat.autopilot != kArduPilot || frame.component != kAutopilotComponent) return;
  if (!vehicle_.system()) {
    vehicle_.expect({.system = frame.system, .local = true});
    writer_.set_system(frame.system);
  }
  if (frame.system != *vehicle_.system()) return;
  const std::lock_guard lock(mutex_);
  heard_ = time;
  heartbeat_ = beat;
  system_ = frame.system;
}

void AutopilotLink::on_timesync(const TimeSync& sync, Time time) {
  const std::int64_t now = time.time_since_epoch().count();
  if (sync.tc1_ns == 0) return send(TimeSync::kId, TimeSync{now, sync.ts1_ns}.body());
  if (sync.ts1_ns > now || now - sync.ts1_ns > kBeat.count()) return;  // not an answer to a late request of ours
  const std::lock_guard lock(mutex_);
  boot_ = Duration(sync.tc1_ns - (sync.ts1_ns + now) / 2);
}

Authority AutopilotLink::authority_at(Time now) const {
  if (!heard_ || now - *heard_ > kSilence) return Authority::kNoAutopilot;
  if (!heartbeat_.armed()) return Authority::kDisarmed;
  const bool guided = heartbeat_.custom_mode == static_cast<std::uint32_t>(SubMode::kGuided);
  return guided ? Authority::kOurs : Authority::kOtherMode;
}

std::string AutopilotLink::mode() const {
  const std::lock_guard lock(mutex_);
  if (!heard_) return "not heard";
  return fmt::format("{}, {}", mode_text(heartbeat_.custom_mode), heartbeat_.armed() ? "armed" : "disarmed");
}

std::optional<GeoOrigin> AutopilotLink::origin() const {
  const std::lock_guard lock(mutex_);
  return origin_;
}

void AutopilotLink::want_mission() {
  const std::lock_guard lock(mutex_);
  wants_mission_ = true;
}

std::optional<std::string> AutopilotLink::mission() const {
  const std::lock_guard lock(mutex_);
  if (!mission_problem_.empty()) throw Error(mission_problem_, {config_.link}, "", "try again, or name a mission file");
  return plan_ ? std::optional(qground_text(*plan_)) : std::nullopt;
}

void AutopilotLink::ask_for_messages() {
  const auto interval = static_cast<float>(1e6 / config_.rate_hz);
  const std::uint8_t system = *vehicle_.system();
  for (const std::uint32_t id : {Attitude::kId, LocalPosition::kId}) {
    send(CommandLong::kId,
         CommandLong{{static_cast<float>(id), interval}, kSetMessageInterval, system, kAutopilotComponent}.body());
  }
  send(CommandLong::kId,
       CommandLong{{static_cast<float>(SystemStatus::kId), 1e6F}, kSetMessageInterval, system, kAutopilotComponent}
           .body());
  send(CommandLong::kId,
       CommandLong{{static_cast<float>(Origin::kId)}, kRequestMessage, system, kAutopilotComponent}.body());
}

void AutopilotLink::report_health(Time now) {
  if (authority_at(now) == Authority::kNoAutopilot) return;
  events_.give(Health{
      .time = now,
      .source = "vehicle",
      .battery_share = static_cast<float>(battery_.value_or(1)),
      .note = fmt::format("{}, {}", mode_text(heartbeat_.custom_mode), heartbeat_.armed() ? "armed" : "disarmed")});
}

void AutopilotLink::on_tick(Time now) {
  if (now - beat_ >= kBeat) {
    beat_ = now;
    send(Heartbeat::kId, Heartbeat{0, kOnboardController, kNoAutopilot, 0, kStateActive}.body());
  }
  if (now - sync_ >= kSyncInterval) {
    sync_ = now;
    send(TimeSync::kId, TimeSync{0, now.time_since_epoch().count()}.body());
  }
  if (!vehicle_.system()) return;
  std::optional<std::string> news;
  {
    const std::lock_guard lock(mutex_);
    if (now - health_ >= kBeat) {
      health_ = now;
      report_health(now);
    }
    const Authority held = authority_at(now);
    if (std::exchange(told_, held) != held) news = std::string("Isobath ") + words_for(held);
    if (wants_mission_ && !download_ && heard_) {
      download_.emplace(*vehicle_.system(), kAutopilotComponent,
                        [this](std::uint32_t id, const PayloadBytes& body) { send(id, body); });
    }
    if (download_) mission_problem_ = download_->problem();
  }
  if (news) say(told_ == Authority::kOurs ? 6 : 4, *news);
  if (download_) download_->on_tick(now);
  const bool idle = !fix_ || !origin_ || now - fix_->time > kAskInterval;
  if (idle && now - asked_ >= kAskInterval) {
    asked_ = now;
    ask_for_messages();
  }
}

bool AutopilotLink::command(const Setpoint& setpoint, const VehicleParameters& limits, Time answers) {
  const Time now = hub_->now();
  VelocityTarget target;
  {
    const std::lock_guard lock(mutex_);
    if (!admits_setpoint(now, answers, fix_ && boot_)) return false;
    const double rate = std::min(config_.max_dive_rate, limits.limits.max_climb_rate);
    const double depth_error = setpoint.depth - fix_->X_WB.translation.z();
    const double c = cos(setpoint.heading), s = sin(setpoint.heading);
    target.vx = static_cast<float>(c * setpoint.speed - s * setpoint.sway_speed);
    target.vy = static_cast<float>(s * setpoint.speed + c * setpoint.sway_speed);
    target.vz = static_cast<float>(limited_to(config_.depth_gain * depth_error, rate));
    target.yaw = static_cast<float>(setpoint.heading.wrapped().radians());
    target.boot_ms = milliseconds(answers.time_since_epoch() + *boot_);
    target.system = system_;
  }
  hub_->post([this, body = target.body(), answers] {
    if (releases_setpoint(hub_->now(), answers)) send(VelocityTarget::kId, body);
  });
  return true;
}

void AutopilotLink::say(int severity, const std::string& text) {
  hub_->post(
      [this, body = StatusText{static_cast<std::uint8_t>(severity), text}.body()] { send(StatusText::kId, body); });
}

void AutopilotLink::show(const ObstacleDistance& ring) {
  hub_->post([this, body = ring.body()] { send(ObstacleDistance::kId, body); });
}

void AutopilotLink::show(const Surroundings& around, const Navigation& fix, Time now) {
  const ObstacleDistance ring = obstacle_ring(around, fix, now);
  if (config_.obstacle_points) {
    show(ring_points(ring));
  } else {
    show(ring);
  }
  show_value("nearest", nearest_m(around, fix));
}

void AutopilotLink::show(const std::vector<ObstacleDistance3d>& points) {
  std::uint32_t boot_ms = 0;
  {
    const std::lock_guard lock(mutex_);
    if (boot_) boot_ms = milliseconds(hub_->now().time_since_epoch() + *boot_);
  }
  std::vector<PayloadBytes> bodies;
  for (ObstacleDistance3d point : points) {
    point.boot_ms = boot_ms;
    bodies.push_back(point.body());
  }
  hub_->post([this, bodies = std::move(bodies)] {
    for (const PayloadBytes& body : bodies) send(ObstacleDistance3d::kId, body);
  });
}

void AutopilotLink::show_motion(const BodyMotion& motion) {
  constexpr double kUseless = 0.4;  // m/s: standard deviation of no confidence at all
  VisionDelta delta;
  {
    const std::lock_guard lock(mutex_);
    if (!fix_ || authority_at(motion.time) == Authority::kNoAutopilot) return;
    const Rotation R_WB = fix_->X_WB.rotation;
    const std::optional<Moved> last = std::exchange(moved_, Moved{motion.time, R_WB});
    if (!last || motion.time <= last->time || motion.time - last->time > kMotionGap) return;
    const Eigen::AngleAxisd turned((last->R_WB.inverse() * R_WB).quaternion());
    const double dt_s = to_seconds(motion.time - last->time);
    for (int i = 0; i < 3; ++i) {
      delta.turned[i] = static_cast<float>(turned.angle() * turned.axis()[i]);
      delta.moved[i] = static_cast<float>(dt_s * motion.v_B[i]);
    }
    const auto microseconds = [](Duration d) {
      return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(d).count());
    };
    delta.time_us = microseconds(motion.time.time_since_epoch());
    delta.since_us = microseconds(motion.time - last->time);
    delta.confidence = static_cast<float>(100 * (1 - std::min(1.0, motion.sigma / kUseless)));
  }
  send(VisionDelta::kId, delta.body());
}

void AutopilotLink::show_value(const std::string& name, double value) {
  NamedValue named{0, static_cast<float>(value), name};
  {
    const std::lock_guard lock(mutex_);
    if (boot_) named.boot_ms = milliseconds(hub_->now().time_since_epoch() + *boot_);
  }
  hub_->post([this, body = named.body()] { send(NamedValue::kId, body); });
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <isobath/standin/autopilot_stand_in.hpp>

namespace isobath {
namespace {

using namespace mavlink;

constexpr Duration kTargetEnds = std::chrono::seconds(3);
constexpr Duration kBeatInterval = std::chrono::seconds(1), kBoot = std::chrono::seconds(10);
constexpr double kDepthLeash_m = 1;  // between the wanted depth and the vehicle's
constexpr std::uint16_t kRequestMessage = 512;
constexpr std::uint16_t kAccelerationMask = 64 | 128 | 256, kVelocityMask = 8 | 16 | 32;

std::int32_t e7(double degrees) { return static_cast<std::int32_t>(std::lround(degrees * 1e7)); }

}  // namespace

AutopilotStandIn::AutopilotStandIn(AutopilotPlan plan, const GeoOrigin& origin, double guided_after_s,
                                   std::vector<PilotTurn> turns, const UnplugConfig& unplug)
    : FrontSeatStandIn(unplug), plan_(std::move(plan)), origin_(origin), pilot_(guided_after_s, std::move(turns)) {}

std::uint32_t AutopilotStandIn::boot_ms(Time now) const {
  const Duration since = now - booted_.value_or(now) + kBoot;
  return static_cast<std::uint32_t>(std::chrono::duration_cast<std::chrono::milliseconds>(since).count());
}

void AutopilotStandIn::send(std::uint32_t id, const PayloadBytes& body, Time now) {
  link_.send(writer_.frame(id, body, now), now);
}

void AutopilotStandIn::on_bytes(Bytes bytes, Time time) {
  frames_.push(bytes, time, offset_);
  offset_ += bytes.size();
  const std::lock_guard lock(mutex_);
  while (const auto found = frames_.next(report_)) {
    if (trust_ && trust_->judge(found->frame) != SignatureCheck::Verdict::kTrusted) {
      ++counts_.untrusted;
    } else {
      on_frame(mavlink_frame(found->frame), time);
    }
  }
  report_ = SourceReport{};
}

void AutopilotStandIn::on_frame(const MavlinkFrame& frame, Time now) {
  if (frame.checksum != MavlinkFrame::Checksum::kRight) return;
  const MavlinkPayload p(frame.payload);
  switch (frame.id) {
    case Heartbeat::kId:
      if (Heartbeat::of(p).type != kOnboardController) return;
      pilot_.on_companion(now);
      return;
    case TimeSync::kId: {
      const TimeSync sync = TimeSync::of(p);
      const Duration own = now - booted_.value_or(now) + kBoot;
      if (sync.tc1_ns == 0) send(TimeSync::kId, TimeSync{own.count(), sync.ts1_ns}.body(), now);
      return;
    }
    case CommandLong::kId: {
      const CommandLong command = CommandLong::of(p);
      if (command.command == kSetMessageInterval && command.params[0] == float{Attitude::kId} && command.params[1] > 0)
        interval_ = seconds(std::clamp(double{command.params[1]} * 1e-6, 0.02, 10.0));
      if (command.command == kRequestMessage && command.params[0] == float{Origin::kId})
        send(Origin::kId, Origin{e7(origin_.latitude_deg), e7(origin_.longitude_deg)}.body(), now);
      return send(CommandAck::kId, CommandAck{command.command, 0}.body(), now);
    }
    case VelocityTarget::kId: return on_target(VelocityTarget::of(p), now);
    case ObstacleDistance::kId: ++counts_.rings; return;
    case ObstacleDistance3d::kId: ++counts_.points; return;
    case VisionDelta::kId: {
      const VisionDelta delta = VisionDelta::of(p);
      counts_.moved_m += std::hypot(delta.moved[0], delta.moved[1], delta.moved[2]);
      return;
    }
    case StatusText::kId:
      ++counts_.texts;
      counts_.last_text = StatusText::of(p).text;
      return;
    default: return on_mission_frame(frame, p, now);
  }
}

void AutopilotStandIn::on_target(const VelocityTarget& target, Time now) {
  const bool right = target.frame == kLocalNed && (target.mask & kAccelerationMask) == kAccelerationMask &&
                     (target.mask & kVelocityMask) == 0 &&
                     std::isfinite(target.vx + target.vy + target.vz + target.yaw);
  if (!steers() || !right || target.system != 1) {
    ++counts_.refused;
    return;
  }
  ++counts_.setpoints;
  const auto age_ms = static_cast<std::int32_t>(boot_ms(now) - target.boot_ms);
  counts_.oldest_s = std::max(counts_.oldest_s, age_ms / 1000.0);
  if (target_) counts_.longest_gap_s = std::max(counts_.longest_gap_s, to_seconds(now - target_time_));
  target_ = target;
  target_time_ = now;
}

const std::vector<MissionItem>& AutopilotStandIn::items(MissionKind kind) const {
  if (kind == MissionKind::kFence) return plan_.fence;
  return kind == MissionKind::kRally ? plan_.rally : plan_.mission;
}

void AutopilotStandIn::on_mission_frame(const MavlinkFrame& frame, const MavlinkPayload& p, Time now) {
  if (frame.id == MissionRequestList::kId) {
    const MissionKind kind = MissionRequestList::of(p).kind;
    const auto count = static_cast<std::uint16_t>(items(kind).size());
    send(MissionCount::kId, MissionCount{count, frame.system, frame.component, kind}.body(), now);
  } else if (frame.id == MissionRequest::kId || frame.id == MissionRequest::kOldId) {
    const MissionRequest request = MissionRequest::of(p);
    const auto& list = items(request.kind);
    if (request.sequence >= list.size()) return;
    MissionItem item = list[request.sequence];
    item.system = frame.system;
    item.component = frame.component;
    item.kind = request.kind;
    item.sequence = request.sequence;
    send(MissionItem::kId, item.body(), now);
  }
}

void AutopilotStandIn::choose_mode(Time now) {
  const StandInPilot::Holder holder = pilot_.holder(now);
  if (holder == StandInPilot::Holder::kNotYet) return;
  const bool taken = holder == StandInPilot::Holder::kPilot;
  mode_ = taken ? SubMode::kPositionHold : SubMode::kGuided;
  armed_ = true;
  if (taken) target_.reset();
}

void AutopilotStandIn::beat(Time now) {
  const auto base = static_cast<std::uint8_t>(kCustomMode | (armed_ ? kArmed : 0));
  const Heartbeat heartbeat{static_cast<std::uint32_t>(mode_), kSubmarine, kArduPilot, base, kStateActive};
  send(Heartbeat::kId, heartbeat.body(), now);
  send(SystemStatus::kId, SystemStatus{static_cast<std::int8_t>(std::lround(battery_ * 100))}.body(), now);
}

void AutopilotStandIn::on_tick(Time now) {
  const std::lock_guard lock(mutex_);
  if (!booted_) booted_ = now;
  const mavlink::SubMode before = mode_;
  choose_mode(now);
  if (now - beat_ >= kBeatInterval || before != mode_) {
    beat_ = now;
    beat(now);
  }
}

void AutopilotStandIn::on_fix(const Navigation& fix, Time now) {
  const std::lock_guard lock(mutex_);
  fix_ = fix;
  if (!heading_known_) heading_ = fix.X_WB.rotation.heading();
  heading_known_ = true;
  if (!booted_) booted_ = now;
  if (now < state_due_) return;
  state_due_ = std::max(state_due_ + interval_, now);  // keeps the rate where fixes come a little early
  const Pose& X = fix.X_WB;
  const auto f = [](double value) { return static_cast<float>(value); };
  const Eigen::Vector3d v = fix.v_WB.value_or(Eigen::Vector3d::Zero());
  send(Attitude::kId,
       Attitude{boot_ms(now), f(X.rotation.roll().radians()), f(X.rotation.pitch().radians()),
                f(X.rotation.heading().radians())}
           .body(),
       now);
  send(LocalPosition::kId,
       LocalPosition{boot_ms(now), f(X.translation.x()), f(X.translation.y()), f(X.translation.z()), f(v.x()), f(v.y()),
                     f(v.z())}
           .body(),
       now);
}

void AutopilotStandIn::on_battery(double share) {
  const std::lock_guard lock(mutex_);
  battery_ = share;
}

Setpoint AutopilotStandIn::setpoint(double dt_s) {
  const std::lock_guard lock(mutex_);
  Setpoint setpoint;
  if (!fix_) return setpoint;
  const double depth = fix_->X_WB.translation.z();
  if (!depth_) depth_ = depth;
  if (target_ && hub_->now() - target_time_ > kTargetEnds) target_.reset();
  if (target_) {
    heading_ = Angle::radians(target_->yaw);
    const double c = cos(heading_), s = sin(heading_);
    setpoint.speed = c * target_->vx + s * target_->vy;
    setpoint.sway_speed = -s * target_->vx + c * target_->vy;
    depth_ = std::clamp(*depth_ + target_->vz * dt_s, depth - kDepthLeash_m, depth + kDepthLeash_m);
  }
  setpoint.heading = heading_;
  setpoint.depth = std::max(0.0, *depth_);
  return setpoint;
}

bool AutopilotStandIn::deserted() const {
  const std::lock_guard lock(mutex_);
  return pilot_.deserted(hub_->now());
}

AutopilotCounts AutopilotStandIn::counts() const {
  const std::lock_guard lock(mutex_);
  AutopilotCounts counts = counts_;
  counts.pulled = link_.pulled();
  return counts;
}

}  // namespace isobath

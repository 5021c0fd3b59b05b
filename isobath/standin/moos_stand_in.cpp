#include <algorithm>
#include <cmath>
#include <isobath/io/formats/moos/given_obstacle.hpp>
#include <isobath/standin/moos_stand_in.hpp>
#include <utility>

namespace isobath {
namespace {

using Type = MoosMessage::Type;
constexpr const char* kCommunity = "stand-in";

double unix_s(Time time) { return to_seconds(time.time_since_epoch()); }

/// The number that a packet gives a variable.
std::optional<double> number_of(const std::vector<MoosMessage>& messages, std::string_view key) {
  for (const MoosMessage& m : messages) {
    if (m.type == Type::kNotify && m.kind == MoosMessage::Kind::kNumber && m.key == key && std::isfinite(m.value))
      return m.value;
  }
  return std::nullopt;
}

}  // namespace

void MoosStandIn::on_open(Time /*time*/) {
  const std::lock_guard lock(mutex_);
  stage_ = Stage::kNew;
  frames_ = FrameStream(moos_frame_at);
  registered_.clear();
  mail_.clear();
}

void MoosStandIn::on_bytes(Bytes bytes, Time time) {
  const std::lock_guard lock(mutex_);
  frames_.push(bytes, time, 0);
  while (const auto found = frames_.next(report_)) {
    const bool greeting = is_moos_greeting(found->frame);
    if (greeting != (stage_ == Stage::kNew)) {
      ++counts_.malformed;  // a packet before the greeting, or a second greeting
    } else if (greeting) {
      stage_ = Stage::kGreeted;
    } else {
      on_packet(moos_messages_of(found->frame, report_), time);
    }
  }
  counts_.malformed += report_.bytes_skipped > 0 ? 1 : 0;
  for (const auto& [reason, count] : report_.rejected) counts_.malformed += count;
  report_ = SourceReport{};
}

void MoosStandIn::on_packet(const std::vector<MoosMessage>& messages, Time now) {
  pilot_.on_companion(now);
  if (stage_ == Stage::kGreeted) {
    MoosMessage verdict;
    const bool named = messages.size() == 1 && messages[0].type == Type::kData && !messages[0].text.empty();
    verdict.type = named ? Type::kWelcome : Type::kPoison;
    verdict.community = kCommunity;
    if (!named) verdict.text = "a client must give its name";
    if (named) stage_ = Stage::kTalking;
    return answer({verdict}, now);
  }
  for (const MoosMessage& message : messages) on_message(message);
  on_desired(messages, now);
  MoosMessage time;
  time.value = unix_s(now);
  std::vector<MoosMessage> mail{time};
  mail.insert(mail.end(), mail_.begin(), mail_.end());
  mail_.clear();
  answer(std::move(mail), now);
}

void MoosStandIn::answer(std::vector<MoosMessage> messages, Time now) { link_.send(moos_packet(messages), now); }

void MoosStandIn::on_message(const MoosMessage& message) {
  if (message.type == Type::kRegister) {
    registered_.insert(message.key);
    if (const auto known = variables_.find(message.key); known != variables_.end()) post(known->second);
  } else if (message.type == Type::kUnregister) {
    registered_.erase(message.key);
  } else if (message.type == Type::kNotify && message.key == "GIVEN_OBSTACLE") {
    ++(given_obstacle_of(message.text) ? counts_.obstacles : counts_.malformed);
  } else if (message.type == Type::kNotify && message.key == "ISOBATH_DECISION") {
    ++counts_.texts;
    counts_.last_text = message.text;
  }
}

void MoosStandIn::on_desired(const std::vector<MoosMessage>& messages, Time now) {
  const auto speed = number_of(messages, "DESIRED_SPEED"), heading = number_of(messages, "DESIRED_HEADING"),
             depth = number_of(messages, "DESIRED_DEPTH");
  if (!speed && !heading && !depth) return;
  if (speed == 0.0 && !heading && !depth) {  // a stop is always obeyed
    target_.reset();
    return;
  }
  const bool whole = speed && heading && depth && *speed >= 0 && *heading >= 0 && *heading <= 360;
  if (!whole || override_) {
    ++counts_.refused;
    return;
  }
  ++counts_.setpoints;
  for (const MoosMessage& m : messages) {
    if (m.key == "DESIRED_SPEED") counts_.oldest_s = std::max(counts_.oldest_s, unix_s(now) - m.time_s);
  }
  if (last_target_) counts_.longest_gap_s = std::max(counts_.longest_gap_s, to_seconds(now - *last_target_));
  last_target_ = now;
  target_ = Target{Angle::degrees(*heading), *speed, *depth, now};
}

void MoosStandIn::post(const MoosMessage& message) {
  if (mail_.size() == kMaxMail) mail_.pop_front();
  mail_.push_back(message);
}

void MoosStandIn::publish(MoosMessage message) {
  message.source = "stand-in";
  message.community = kCommunity;
  if (registered_.contains(message.key)) post(message);
  variables_[message.key] = std::move(message);
}

void MoosStandIn::on_tick(Time now) {
  const std::lock_guard lock(mutex_);
  const bool held = pilot_.holder(now) != StandInPilot::Holder::kCompanion;
  if (std::exchange(override_, held) == held && variables_.contains("MOOS_MANUAL_OVERRIDE")) return;
  if (held) {
    target_.reset();
    last_target_.reset();
  }
  publish(moos_text("MOOS_MANUAL_OVERRIDE", held ? "true" : "false", unix_s(now)));
}

void MoosStandIn::on_fix(const Navigation& fix, Time /*now*/) {
  const std::lock_guard lock(mutex_);
  fix_ = fix;
  const Time now = hub_->now();
  if (now - told_ < kNavigationInterval) return;
  told_ = now;
  const Pose& X = fix.X_WB;
  const double speed = fix.v_WB.value_or(Eigen::Vector3d::Zero()).head<2>().norm();
  const std::pair<const char*, double> values[] = {{"NAV_X", X.translation.y()},
                                                   {"NAV_Y", X.translation.x()},
                                                   {"NAV_HEADING", X.rotation.heading().wrapped_positive().degrees()},
                                                   {"NAV_DEPTH", X.translation.z()},
                                                   {"NAV_SPEED", speed}};
  for (const auto& [key, value] : values) publish(moos_number(key, value, unix_s(now)));
}

Setpoint MoosStandIn::setpoint(double /*dt_s*/) {
  const std::lock_guard lock(mutex_);
  Setpoint setpoint;
  if (!fix_) return setpoint;
  if (!heading_) heading_ = fix_->X_WB.rotation.heading();
  if (!depth_) depth_ = fix_->X_WB.translation.z();
  if (target_ && hub_->now() - target_->time > kTargetEnds) target_.reset();
  if (target_) {
    heading_ = target_->heading;
    depth_ = target_->depth;
    setpoint.speed = target_->speed;
  }
  setpoint.heading = *heading_;
  setpoint.depth = std::max(0.0, *depth_);
  return setpoint;
}

bool MoosStandIn::deserted() const {
  const std::lock_guard lock(mutex_);
  return pilot_.deserted(hub_->now());
}

AutopilotCounts MoosStandIn::counts() const {
  const std::lock_guard lock(mutex_);
  AutopilotCounts counts = counts_;
  counts.pulled = link_.pulled();
  return counts;
}

}  // namespace isobath

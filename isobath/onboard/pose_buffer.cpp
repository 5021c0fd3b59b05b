#include <algorithm>
#include <cmath>
#include <isobath/onboard/pose_buffer.hpp>

namespace isobath {

std::vector<Field> fields(PoseBufferConfig& c) {
  return {Field::real("wait_s", &c.wait_s, {0, 60}, "s",
                      "How long, in log time, a ping waits for the fix that follows it."),
          Field::real("extrapolate_s", &c.extrapolate_s, {-1, 1}, "s",
                      "A measurement that comes no later than this after the newest fix is placed at once, with the "
                      "velocity and the rate of turn so far, where the fix states a velocity; 0: it waits for the "
                      "next fix. -1: 0.15 s aboard a vehicle, else 0."),
          Field::real("max_extrapolation_s", &c.max_extrapolation_s, {0, 60}, "s",
                      "Maximum time beyond the newest fix for which a pose is extrapolated with the last velocity."),
          Field::real("max_gap_s", &c.max_gap_s, {0, 3600}, "s",
                      "Maximum gap between two fixes across which a pose is interpolated on a straight line."),
          Field::real("jump_m", &c.jump_m, {0.01, 1e6}, "m",
                      "A fix farther than this from the predicted position counts as a correction of the position: "
                      "the maps around the vehicle move along with it.")};
}

const char* to_text(PoseFault fault) {
  switch (fault) {
    case PoseFault::kNoFixYet: return "no navigation yet";
    case PoseFault::kBeforeFirst: return "ping before the first fix";
    case PoseFault::kGap: return "gap in the navigation";
    case PoseFault::kStale: return "navigation is stale";
  }
  return "unknown";
}

PoseBuffer::PoseBuffer(const PoseBufferConfig& config) : config_(config), ring_(kCapacity) {}

Eigen::Vector3d PoseBuffer::add(const Navigation& fix) {
  const Eigen::Vector3d jump = jump_to(fix);
  const Eigen::Vector3d moved = count_ > 0 ? fix.X_WB.translation - newest().X_WB.translation : jump;
  const double dt = count_ > 0 ? to_seconds(fix.time - newest().time) : 0;
  if (!jump.isZero(0)) move(jump);
  if (!fix.v_WB && moved.isZero(0)) {
    stood_s_ += dt;
  } else if (dt > 0) {
    apart_s_ = dt + stood_s_;
    velocity_ = (moved - jump) / apart_s_;
    doubted_.reset();
    if (!jump.isZero(0)) doubted_ = moved / apart_s_;
    stood_s_ = 0;
  }
  ring_[next_] = fix;
  next_ = (next_ + 1) % kCapacity;
  count_ = std::min(count_ + 1, kCapacity);
  return jump;
}

void PoseBuffer::move(const Eigen::Vector3d& by_W) {
  for (std::size_t age = 0; age < count_; ++age)
    ring_[(next_ + kCapacity - 1 - age) % kCapacity].X_WB.translation += by_W;
}

void PoseBuffer::clear() {
  count_ = 0;
  velocity_.reset();
  doubted_.reset();
  stood_s_ = 0;
}

/// The part of the displacement to a fix that no plausible motion explains.
Eigen::Vector3d PoseBuffer::jump_to(const Navigation& fix) const {
  constexpr double kAcceleration = 1, kFastest = 30;  // m/s2, m/s
  constexpr double kJitter = 0.1;                     // m, of a fix: limits the accuracy of a velocity from two fixes
  if (count_ == 0) return Eigen::Vector3d::Zero();
  const double dt = to_seconds(fix.time - newest().time);
  const Eigen::Vector3d moved = fix.X_WB.translation - newest().X_WB.translation;
  std::optional<Eigen::Vector3d> jump;
  const auto explains = [&](const Eigen::Vector3d& velocity, double over_s, double allowed_m) {
    const Eigen::Vector3d rest = moved - over_s * velocity;
    if (!jump || rest.norm() < jump->norm()) jump = rest;
    return rest.norm() <= config_.jump_m + allowed_m;
  };
  const auto& stated = newest().v_WB;
  if (stated && explains(*stated, dt, 0.5 * kAcceleration * dt * dt)) return Eigen::Vector3d::Zero();
  const double way_s = dt + stood_s_;
  for (const auto& velocity : {velocity_, doubted_}) {
    const double allowed = velocity ? 0.5 * kAcceleration * way_s * (way_s + apart_s_) + kJitter * way_s / apart_s_ : 0;
    if (velocity && explains(*velocity, way_s, allowed)) return Eigen::Vector3d::Zero();
  }
  if (!jump && explains(Eigen::Vector3d::Zero(), 0, kFastest * way_s)) return Eigen::Vector3d::Zero();
  return *jump;
}

/// From the last two fixes, in the body, rad/s; empty where they lie too far apart to say what it is now.
std::optional<Eigen::Vector3d> PoseBuffer::rate_of_turn() const {
  constexpr double kApart_s = 0.5;
  if (count_ < 2) return std::nullopt;
  const double dt = to_seconds(newest().time - fix(1).time);
  if (!(dt > 0 && dt <= kApart_s)) return std::nullopt;
  return (fix(1).X_WB.rotation.inverse() * newest().X_WB.rotation).log() / dt;
}

bool PoseBuffer::settled(Time time) const {
  if (count_ == 0) return false;
  const double ahead = to_seconds(time - newest().time);
  return ahead <= 0 || (ahead <= config_.extrapolate_s && newest().v_WB && rate_of_turn());
}

Result<Pose, PoseFault> PoseBuffer::at(Time time) const {
  if (count_ == 0) return tl::make_unexpected(PoseFault::kNoFixYet);
  if (time >= newest().time) {
    const double ahead = to_seconds(time - newest().time);
    if (ahead > config_.max_extrapolation_s) return tl::make_unexpected(PoseFault::kStale);
    Pose pose = newest().X_WB;
    if (newest().v_WB) pose.translation += ahead * *newest().v_WB;
    const double turning_s = std::min(ahead, config_.extrapolate_s);
    const std::optional<Eigen::Vector3d> rate = turning_s > 0 ? rate_of_turn() : std::nullopt;
    if (rate) pose.rotation = pose.rotation * Rotation::exp(turning_s * *rate);
    return pose;
  }
  std::size_t age = 1;  // the newest fix at or before the time
  while (age < count_ && fix(age).time > time) ++age;
  if (age == count_) return tl::make_unexpected(PoseFault::kBeforeFirst);
  const Navigation &before = fix(age), &after = fix(age - 1);
  const double gap = to_seconds(after.time - before.time);
  if (gap > config_.max_gap_s) return tl::make_unexpected(PoseFault::kGap);
  return interpolate(before.X_WB, after.X_WB, to_seconds(time - before.time) / gap);
}

bool PoseBuffer::knows_its_motion() const {
  constexpr double kGood = 0.1;  // m/s: in the 4 s of a scan the error is less than one cell of a grid
  return count_ == 0 || !newest().v_sigma || *newest().v_sigma <= kGood;
}

double PoseBuffer::heading_variance() const {
  return count_ > 0 && newest().covariance ? (*newest().covariance)(5, 5) : 0;
}

double PoseBuffer::sigma_m() const {
  if (count_ == 0 || !newest().covariance) return 0;
  const auto& c = *newest().covariance;
  const double mean = 0.5 * (c(0, 0) + c(1, 1));
  const double apart = 0.5 * (c(0, 0) - c(1, 1));
  return std::sqrt(std::max(0.0, mean + std::hypot(apart, c(0, 1))));
}

}  // namespace isobath

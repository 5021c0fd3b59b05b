#include <algorithm>
#include <cmath>
#include <isobath/runtime/pose_buffer.hpp>

namespace isobath {

std::vector<Field> fields(PoseBufferConfig& c) {
  return {Field::real("wait_s", &c.wait_s, {0, 60}, "s",
                      "How long, in log time, a ping waits for the fix that follows it."),
          Field::real("max_extrapolation_s", &c.max_extrapolation_s, {0, 60}, "s",
                      "How far beyond the newest fix a pose is carried on with the last velocity."),
          Field::real("max_gap_s", &c.max_gap_s, {0, 3600}, "s",
                      "The longest gap between two fixes that is still bridged by a straight line.")};
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

void PoseBuffer::add(const Navigation& fix) {
  ring_[next_] = fix;
  next_ = (next_ + 1) % kCapacity;
  count_ = std::min(count_ + 1, kCapacity);
}

Result<Pose, PoseFault> PoseBuffer::at(Time time) const {
  if (count_ == 0) return tl::make_unexpected(PoseFault::kNoFixYet);
  if (time >= newest().time) {
    const double ahead = to_seconds(time - newest().time);
    if (ahead > config_.max_extrapolation_s) return tl::make_unexpected(PoseFault::kStale);
    Pose pose = newest().X_WB;
    if (newest().v_WB) pose.translation += ahead * *newest().v_WB;
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
  constexpr double kGood = 0.1;  // m/s: in the 4 s of a scan less than the cell of a grid
  return count_ == 0 || !newest().v_sigma || *newest().v_sigma <= kGood;
}

double PoseBuffer::sigma_m() const {
  if (count_ == 0 || !newest().covariance) return 0;
  const auto& c = *newest().covariance;
  const double mean = 0.5 * (c(0, 0) + c(1, 1));
  const double apart = 0.5 * (c(0, 0) - c(1, 1));
  return std::sqrt(std::max(0.0, mean + std::hypot(apart, c(0, 1))));
}

}  // namespace isobath

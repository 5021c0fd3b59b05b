#include <algorithm>
#include <cmath>
#include <isobath/sonar/reading_prefilter.hpp>

namespace isobath {
namespace {

bool same_device(const RangeReading& a, const RangeReading& b) {
  return a.max_range_m == b.max_range_m && a.width == b.width && a.X_BS.translation == b.X_BS.translation &&
         a.X_BS.rotation.quaternion().coeffs() == b.X_BS.rotation.quaternion().coeffs();
}

}  // namespace

std::vector<Field> fields(ReadingPrefilterConfig& c) {
  return {
      Field::real("range_m", &c.range_m, {0, 100}, "m",
                  "Readings are merged only if their ranges differ by at most this."),
      Field::real("position_m", &c.position_m, {0, 100}, "m",
                  "Readings are merged only if the vehicle has moved by at most this."),
      Field::degrees("attitude_deg", &c.attitude, {0, 180},
                     "Readings are merged only if the vehicle has turned by at most this."),
      Field::integer("max_readings", &c.max_readings, {1, 100}, "readings",
                     "Maximum number of readings merged into one; 1 merges none.")
          .was("most"),
      Field::real("hold_s", &c.hold_s, {0, 3600}, "s", "Time for which a reading waits for similar ones."),
  };
}

bool ReadingPrefilter::alike(const Group& group, const RangeReading& reading, const Pose& X_WB) const {
  const RangeReading& first = group.first;
  if (reading.range_m.has_value() != first.range_m.has_value() || !same_device(reading, first)) return false;
  // Comparisons are written so that values that are not finite are not similar.
  if (reading.range_m && !(std::abs(*reading.range_m - *first.range_m) <= config_.range_m)) return false;
  if (!((X_WB.translation - group.X_WB.translation).norm() <= config_.position_m)) return false;
  const double turn = group.X_WB.rotation.quaternion().angularDistance(X_WB.rotation.quaternion());
  return turn <= config_.attitude.radians() && reading.time >= group.last &&
         to_seconds(reading.time - first.time) < config_.hold_s;
}

void ReadingPrefilter::take(Group& group, const RangeReading& reading, const Pose& X_WB) {
  if (group.count == 0) {
    group = {group.sensor, 0, reading, X_WB, reading.time};
  }
  const Eigen::Vector4d q = X_WB.rotation.quaternion().coeffs();
  const double sign = q.dot(group.X_WB.rotation.quaternion().coeffs()) < 0 ? -1 : 1;
  group.range_sum += reading.range_m.value_or(0);
  group.confidence_sum += reading.confidence;
  group.position_sum += X_WB.translation;
  group.rotation_sum += sign * q;
  group.last = reading.time;
  ++group.count;
}

void ReadingPrefilter::close(Group& group, std::vector<MergedReading>& out) {
  if (group.count == 0) return;
  MergedReading merged{group.sensor, group.first, group.X_WB, group.count};
  if (group.count > 1) {  // a single reading stays unchanged, bit for bit
    merged.reading.time = group.last;
    merged.reading.confidence = static_cast<float>(group.confidence_sum / group.count);
    if (merged.reading.range_m) merged.reading.range_m = group.range_sum / group.count;
    merged.X_WB.translation = group.position_sum / group.count;
    merged.X_WB.rotation = Rotation::from_quaternion(Eigen::Quaterniond(group.rotation_sum));
  }
  out.push_back(merged);
  group.count = 0;
}

void ReadingPrefilter::add(int sensor, const RangeReading& reading, const Pose& X_WB, std::vector<MergedReading>& out) {
  auto group = std::find_if(groups_.begin(), groups_.end(), [sensor](const Group& g) { return g.sensor == sensor; });
  if (group == groups_.end()) {
    groups_.emplace_back().sensor = sensor;
    group = groups_.end() - 1;
  }
  if (group->count > 0 && !alike(*group, reading, X_WB)) close(*group, out);
  take(*group, reading, X_WB);
  if (group->count >= config_.max_readings) close(*group, out);
}

void ReadingPrefilter::flush_due(Time now, std::vector<MergedReading>& out) {
  for (Group& group : groups_) {
    if (group.count > 0 && to_seconds(now - group.first.time) >= config_.hold_s) close(group, out);
  }
}

void ReadingPrefilter::flush(std::vector<MergedReading>& out) {
  for (Group& group : groups_) close(group, out);
}

}  // namespace isobath

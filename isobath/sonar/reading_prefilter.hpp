// ReadingPrefilter: merges successive similar readings of one sensor into one, with a count (Oskard 1990, V; ledger
// S1-68, S1-69). This saves repeated updates; the weight of the merged reading grows with the count (S1-E06).
//
// Two readings are similar if both have an echo or both have none; if they come from the same sensor with the same
// mounting, beam width and maximum range; and if range, position and attitude differ by no more than the tolerances.
// Readings are compared with the first of the group, so that a slow drift cannot extend the group. The attitude is
// compared as one angle, because a change of pitch moves a beam as much as a change of heading. A group closes when it
// is full, when a reading is not similar, or when its first reading is `hold_s` old.
//
// A merged reading has the mean range, mean confidence, mean position and mean rotation of its group (unit quaternion
// nearest to all; on the circle for headings), and the time of the last reading. Times of a sensor must not decrease; a
// decreasing time closes the group. Readings that are not finite pass through alone.
//
// Once all sensors have been seen, `add` allocates nothing if `out` has room for two more readings, because one reading
// closes at most two groups.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <vector>

namespace isobath {

struct ReadingPrefilterConfig {
  double range_m = 0.5;
  double position_m = 1;
  Angle attitude = Angle::degrees(3);
  int max_readings = 4;  ///< maximum number of readings in a group
  double hold_s = 2.4;   ///< four readings at the paper's 0.6 s
};

std::vector<Field> fields(ReadingPrefilterConfig& config);

struct MergedReading {
  int sensor = 0;
  RangeReading reading;
  Pose X_WB;
  int count = 1;
};

class ReadingPrefilter {
 public:
  explicit ReadingPrefilter(const ReadingPrefilterConfig& config = {}) : config_(config) {}

  /// Appends the groups that this reading closes or completes.
  void add(int sensor, const RangeReading& reading, const Pose& X_WB, std::vector<MergedReading>& out);
  /// Appends the groups that are due, in order of their sensors' first readings.
  void flush_due(Time now, std::vector<MergedReading>& out);
  void flush(std::vector<MergedReading>& out);

 private:
  struct Group {
    int sensor = 0;
    int count = 0;
    RangeReading first;
    Pose X_WB;  ///< pose of the first
    Time last;
    double range_sum = 0;
    double confidence_sum = 0;
    Eigen::Vector3d position_sum = Eigen::Vector3d::Zero();
    Eigen::Vector4d rotation_sum = Eigen::Vector4d::Zero();
  };
  [[nodiscard]] bool alike(const Group& group, const RangeReading& reading, const Pose& X_WB) const;
  static void take(Group& group, const RangeReading& reading, const Pose& X_WB);
  static void close(Group& group, std::vector<MergedReading>& out);

  ReadingPrefilterConfig config_;
  std::vector<Group> groups_;  ///< one per sensor; few
};

}  // namespace isobath

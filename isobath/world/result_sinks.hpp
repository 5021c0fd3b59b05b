// ResultSink and SoundingSink: what the maps and the observers of a run get from the pipeline.
#pragma once

#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/voxel/occupancy_snapshot.hpp>
#include <isobath/perception/contact_tracker.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/range_reading.hpp>
#include <isobath/sonar/swath.hpp>
#include <optional>

namespace isobath {

/// A ping with the pose at its transmit time. Without navigation the vehicle is assumed to stand still.
struct PosedPing {
  const Ping& ping;
  Pose X_WB;
  const EchoDecisions& decisions;   ///< one per sample
  const FanLooks* looks = nullptr;  ///< the same as independent looks; null: the samples are independent

  [[nodiscard]] const Ping& look_ping() const { return looks ? looks->ping : ping; }
  [[nodiscard]] const EchoDecisions& look_decisions() const { return looks ? looks->decisions : decisions; }
};

/// The end of one sweep: the body grid, and the obstacles in it.
struct ScanResult {
  int number = 0;              ///< from 1
  bool posed = false;          ///< whether the pose comes from navigation
  const Detection& detection;  ///< with the time and the pose of the last ping
  const BodyGrid& grid;
};

/// A pose of the vehicle and the standard deviation of its horizontal position, m; 0: not stated.
struct PoseEstimate {
  Pose X_WB;
  double sigma_m = 0;
};

/// Receives the results. References are valid only during the call.
class ResultSink {
 public:
  virtual ~ResultSink() = default;
  virtual void on_ping(const PosedPing& ping) = 0;
  virtual void on_scan(const ScanResult& scan) = 0;
  /// A ping of a vertical fan. It is not mapped into the horizontal body grid.
  virtual void on_vertical_ping(const PosedPing& /*ping*/) {}
  /// Occupancy around the vehicle (W) from sensors that resolve height, for the labels of obstacles; null: none.
  [[nodiscard]] virtual const OccupancySnapshot* heights() const { return nullptr; }
  /// The position jumped by this much, m in W. Maps that are right relative to the vehicle must move along. All later
  /// poses agree with the new position, also those of measurements that were made before and had to wait.
  virtual void on_jump(const Eigen::Vector3d& /*by_W*/) {}
  /// Each range once, with the pose at its time. Without navigation there is none.
  virtual void on_reading(const RangeReading& /*reading*/, const Pose& /*X_WB*/) {}
  /// Each passive bearing once, with the pose at its time. Without navigation there is none.
  virtual void on_bearing(const PassiveBearing& /*heard*/, const ListeningPose& /*pose*/) {}
  /// Each swath once. Without any navigation the vehicle is assumed to stand still.
  virtual void on_soundings(const Swath& /*swath*/, const Pose& /*X_WB*/) {}
};

/// Receives depth measurements in order, each with the pose at its time. References are valid only during the call.
class SoundingSink {
 public:
  virtual ~SoundingSink() = default;
  virtual void on_range(const RangeReading& reading, const PoseEstimate& pose) = 0;
  virtual void on_swath(const Swath& swath, const PoseEstimate& pose) = 0;
  /// A pose that the vehicle has reached: one call per fix.
  virtual void on_passage(Time time, const Pose& X_WB) = 0;
  /// Depth of the bottom at a position (north, east), m below the datum; empty: unknown.
  [[nodiscard]] virtual std::optional<double> bottom_depth(const Eigen::Vector2d& /*north_east*/) const { return {}; }
};

}  // namespace isobath

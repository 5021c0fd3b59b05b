// Baselines: simple helms that Isobath's agents are compared with, on the same runs (ledger S6-62).
//
// Each baseline uses the vehicle's own navigation and holds its course by line of sight with integral action, as the
// agents do. They differ in how they use the sonar:
//
// LineOfSightHelm       ignores it: straight from mission point to mission point.
// PotentialFieldHelm    Khatib 1986 (Int. J. Robotics Research 5 (1), 90-98): the mission point attracts with force 1,
//                       every obstacle of the last scan nearer than `reach_m` repels with eta (1/d - 1/reach) / d^2, d
//                       from the hull, eta such that it balances the attraction at the clearance. The helm steers along
//                       the sum, and more slowly the further its heading is from it. Known to be trapped by concave
//                       obstacles.
// ImageThresholdHelm    detects the samples of a scan above a threshold (ledger S6-62; Ganesan 2015, 2.1): 75 % of its
//                       maximum, or the least frequent level between the two highest modes of its histogram. A sample
//                       is confirmed if each of the scans before, `scans` with its own, had one within `same_m`; there
//                       is no grid. The route planner of the agents avoids the echoes confirmed in the last three
//                       scans. Without a route the vehicle stops, and gives up after `patience_s`. Its confirmed echoes
//                       are what is scored as its obstacles, those within `same_m` of each other as one.
//
// Each is a function of its inputs. Where a method differs from the agents', its source is named above.
#pragma once

#include <deque>
#include <isobath/mission/plan/mission_plan.hpp>
#include <isobath/onboard/helm.hpp>
#include <isobath/planning/route_planner.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <optional>
#include <span>

namespace isobath {

/// Follows way-points and reports progress; by itself, the baseline without avoidance.
class LineOfSightHelm : public Helm {
 public:
  LineOfSightHelm(const MissionPlan& mission, const VehicleParameters& vehicle);

  void on_event(const Event& event) override;
  void on_ping(const PosedPing&) override {}
  void on_scan(const ScanResult&) override {}
  [[nodiscard]] Setpoint steer() override { return setpoint_; }
  [[nodiscard]] MissionReport progress() const override { return report_; }
  [[nodiscard]] const std::vector<Decision>& decisions() const override { return decisions_; }

 protected:
  /// Called after every fix: the set-point, given that of line of sight.
  virtual Setpoint decide(const Setpoint& wanted) { return wanted; }
  /// A path to the next mission point instead of the straight one; its last point is the mission point.
  void follow(const std::vector<Eigen::Vector2d>& way);
  void give_up(const std::string& why);
  void decided(const std::string& what, const std::string& why, const std::optional<Eigen::Vector2d>& obstacle = {});

  [[nodiscard]] const VehicleState& state() const { return state_; }
  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] const VehicleParameters& vehicle() const { return vehicle_; }
  [[nodiscard]] Eigen::Vector2d here() const { return state_.X_WB.translation.head<2>(); }
  [[nodiscard]] const MissionPoint& point() const { return mission_.points[point_]; }
  /// The rest of the path to it, from here.
  [[nodiscard]] std::vector<Eigen::Vector2d> way_ahead() const;

 private:
  [[nodiscard]] double speed() const { return point().speed > 0 ? point().speed : mission_.speed; }
  void next_point();

  MissionPlan mission_;
  VehicleParameters vehicle_;
  std::size_t point_ = 0;
  std::optional<LineOfSight> guidance_;
  std::vector<Eigen::Vector2d> way_;
  VehicleState state_;
  Time now_;
  bool fixed_ = false;
  Setpoint setpoint_;
  MissionReport report_;
  std::vector<Decision> decisions_;
};

/// The outlines of all obstacles of a scan, in W.
std::vector<Polygon> outlines_of(const ScanResult& scan);

struct PotentialFieldConfig {
  double clearance_m = 3;
  double reach_m = 15;
};

class PotentialFieldHelm : public LineOfSightHelm {
 public:
  PotentialFieldHelm(const MissionPlan& mission, const VehicleParameters& vehicle, const PotentialFieldConfig& config);
  void on_scan(const ScanResult& scan) override;

 protected:
  Setpoint decide(const Setpoint& wanted) override;

 private:
  PotentialFieldConfig config_;
  std::vector<Polygon> outlines_;  ///< in W
};

enum class ImageThreshold : std::uint8_t { kShareOfMaximum, kBetweenModes };

/// The level between the two highest modes of a histogram of 128 levels from 0 to the largest sample, each smoothed
/// with its neighbours; infinite where there are no two modes.
float threshold_between_modes(std::span<const float> samples);

struct ImageThresholdConfig {
  ImageThreshold threshold = ImageThreshold::kShareOfMaximum;
  double share = 0.75;    ///< of the scan's maximum
  std::size_t scans = 3;  ///< that confirm an echo
  double same_m = 1.5;    ///< echoes of two scans this near belong to the same object
  double patience_s = 60;
  RouteConfig route;
};

class ImageThresholdHelm : public LineOfSightHelm {
 public:
  ImageThresholdHelm(const MissionPlan& mission, const VehicleParameters& vehicle, const ImageThresholdConfig& config);
  void on_ping(const PosedPing& posed) override;
  void on_scan(const ScanResult& scan) override;
  /// Confirmed echoes of the last scan, in W.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& believed() const { return believed_.back(); }
  [[nodiscard]] const std::vector<Obstacle>* own_obstacles() const override { return &found_; }

 protected:
  Setpoint decide(const Setpoint& wanted) override;

 private:
  using Points = std::vector<Eigen::Vector2d>;
  struct Beam {
    std::vector<float> samples;
    RangeWindow window;
    double blanking_m = 0;
    Pose X_WS;
    Angle azimuth;
  };
  [[nodiscard]] Points echoes() const;
  /// The confirmed echoes of the last scan as obstacles, in L at this pose.
  [[nodiscard]] std::vector<Obstacle> obstacles_at(const Pose& X_WL) const;
  void replan();

  ImageThresholdConfig config_;
  std::vector<Beam> scan_;
  double bin_m_ = 0;
  std::deque<Points> echoes_;    ///< detected in the last three scans
  std::deque<Points> believed_;  ///< confirmed in the last three, never empty
  std::vector<Obstacle> found_;
  std::optional<Time> stopped_;  ///< since when
};

}  // namespace isobath

// NavigationParts: makes fixes of the vehicle for logs that state attitude, position and depth in records of their own
// (ROS topics of sensors, MAVLink, ArduPilot DataFlash).
//
// Each attitude gives a Navigation: the position is the newest one, moved on by its velocity, and at most kHold old;
// the depth is the newest one that is at most kHold old, else 0. Where a log has no attitudes, each position gives one,
// level, with the course as heading while the speed is over kMinSpeed. Attitudes without any position give none.
// A position on the globe is placed on the local plane of the report's origin, which is the first one if there is none.
// There is a covariance if the position states its standard deviation; it then has that of kTiltSigma and
// SurveyInput::heading_sigma for the attitude. One thread at a time.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/input/survey_input.hpp>

namespace isobath {

class NavigationParts {
 public:
  static constexpr Duration kHold = std::chrono::seconds(2);
  static constexpr double kMinSpeed = 0.5;  ///< m/s

  /// The arguments must outlive this object.
  NavigationParts(const SurveyInput& config, SourceReport& report) : config_(config), report_(report) {}

  std::optional<Navigation> on_attitude(Time time, const Rotation& R_WB);
  /// `v_WB`: velocity in W. `sigma_m`: of north and of east each; 0: not stated.
  std::optional<Navigation> on_position(Time time, const Eigen::Vector2d& north_east,
                                        std::optional<Eigen::Vector3d> v_WB, double sigma_m = 0);
  /// Ignores positions that are invalid, 0 N 0 E, or over 1000 km from the origin.
  std::optional<Navigation> on_position(Time time, const GeoPoint& point, const std::optional<Eigen::Vector3d>& v_WB,
                                        double sigma_m = 0);
  void on_depth(Time time, double depth_m);

 private:
  struct Position {
    Time time;
    Eigen::Vector2d north_east;
    std::optional<Eigen::Vector3d> v_WB;
    double sigma_m;
  };
  [[nodiscard]] std::optional<Navigation> fix_at(Time time, const Rotation& R_WB) const;

  const SurveyInput& config_;
  SourceReport& report_;
  std::optional<Position> position_;
  std::optional<Time> attitude_time_, depth_time_;
  double depth_m_ = 0;
  Angle course_;
};

}  // namespace isobath

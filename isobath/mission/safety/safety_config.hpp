// SafetyConfig: every threshold of the Safety Officer; docs/faults.md says which fault each belongs to.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <vector>

namespace isobath {

/// What the vehicle does when the link to the operator is lost.
enum class LinkPolicy : std::uint8_t { kContinue, kReturn, kSurface };

struct SafetyConfig {
  double startup_s = 10;
  double clear_after_s = 3;
  double clear_share = 0.8;
  double slow_speed = 0.5;  ///< m/s
  MissionEnd abort_end = MissionEnd::kSurface;

  double sonar_silent_s = 1.5;
  int frozen_looks = 4;
  int bad_looks = 5;
  int good_looks = 10;
  double saturated_share = 0.5;
  double garbled_roughness = 0.25;
  double deaf_s = 5;
  double blind_share = 0.1;
  int blind_looks = 10;
  double sonar_abort_s = 20;
  double blind_abort_s = 60;

  double navigation_silent_s = 1;
  double navigation_surface_s = 10;
  double jump_m = 3;
  double jump_abort_s = 20;
  double depth_sensor_abort_s = 5;
  double altitude_silent_s = 2;
  double altitude_abort_s = 30;
  double clock_jump_s = 1;

  double cross_track_m = 15;
  double off_route_s = 3;
  double progress_m = 2;
  double progress_s = 20;
  double route_abort_s = 30;
  double blocked_abort_s = 75;  ///< longer than executive.route_timeout_s, after which another point is tried
  double budget_stop_s = 3;
  double budget_abort_s = 30;

  double echo_contrast = 6;
  double confirm_m = 1.5;
  double confirm_s = 8;
  double memory_s = 15;
  double reaction_s = 0.6;
  double collision_margin_m = 1;
  double height_margin_m = 0.8;
  double side_margin_m = 0.5;
  double escape_s = 15;
  double escape_moving_s = 3;
  double unknown_current = 0.5;
  double collision_abort_s = 60;

  double depth_slack_m = 0.5;
  double depth_abort_s = 10;
  double low_altitude_abort_s = 20;
  double agent_surface_s = 5;
  double health_silent_s = 5;
  double thruster_abort_s = 5;
  double link_silent_s = 30;
  double link_abort_s = 60;
  LinkPolicy link_policy = LinkPolicy::kContinue;
};

/// Minimum turning radius that is assumed, also for a vehicle that turns on the spot, m.
inline constexpr double kMinRadius = 0.5;

std::vector<Field> fields(SafetyConfig& config);

}  // namespace isobath

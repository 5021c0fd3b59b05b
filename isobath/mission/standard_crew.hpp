// The standard crew: the seats that every vehicle has, and all that can be set of them (Ganesan 2015, 5.1; ledger
// S6-32). Others (Safety Officer, Signaling Officer, back-seat drivers, those of libraries) are added to the list.
#pragma once

#include <isobath/mission/captain.hpp>
#include <isobath/mission/executive_officer.hpp>
#include <isobath/mission/fls_detector.hpp>
#include <isobath/mission/navigator.hpp>
#include <isobath/mission/pilot.hpp>

namespace isobath {

struct MissionConfig {
  CaptainConfig captain;
  ExecutiveConfig executive;
  NavigatorConfig navigator;
  RouteConfig route;
  PilotConfig pilot;
  GuidanceConfig guidance = {.acceptance_radius = 1};  ///< of corners: an obstacle stands inside of each
  StationConfig station;
  DepthKeeperConfig depth_keeping;
  FlsDetectorConfig fls_detector;
  ObstacleMemoryConfig memory = {.least_seen = 0.95, .confirmations = 3};  ///< what is kept must be sure
};

/// Bound to `config`.
std::vector<Section> sections(MissionConfig& config);

/// In the order in which they hear: fls detector, navigator, captain, executive officer, pilot.
std::vector<Seat> standard_crew(const MissionConfig& config, const VehicleSheet& vehicle);

}  // namespace isobath

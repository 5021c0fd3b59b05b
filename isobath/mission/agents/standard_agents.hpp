// The standard agents: those that every vehicle has, and their configuration (Ganesan 2015, 5.1; ledger S6-32, S6-40,
// S6-41). Others (the Safety Officer, those of libraries) are added to the list.
#pragma once

#include <isobath/mission/agents/back_seat.hpp>
#include <isobath/mission/agents/captain.hpp>
#include <isobath/mission/agents/chart_room.hpp>
#include <isobath/mission/agents/closer_look.hpp>
#include <isobath/mission/agents/commodore.hpp>
#include <isobath/mission/agents/executive_officer.hpp>
#include <isobath/mission/agents/fls_detector.hpp>
#include <isobath/mission/agents/goal_selector.hpp>
#include <isobath/mission/agents/navigator.hpp>
#include <isobath/mission/agents/pilot.hpp>
#include <isobath/mission/agents/signaling_officer.hpp>
#include <isobath/mission/plan/timing_table.hpp>

namespace isobath {

struct MissionConfig {
  TimingTable timing;
  CaptainConfig captain;
  CommodoreConfig commodore;
  ExecutiveConfig executive;
  NavigatorConfig navigator;
  RouteConfig route;
  SpaceRouteConfig space_route;
  OpeningConfig opening;
  GoalSelectorConfig goal_selector;
  PilotConfig pilot;
  GuidanceConfig guidance = {.acceptance_radius = 1};  ///< of corners: each goes round an obstacle
  StationConfig station;
  DepthKeeperConfig depth_keeping;
  FlsDetectorConfig fls_detector;
  ObstacleMemoryConfig memory = {.min_initial_existence = 0.95, .confirmations = 3};  ///< only sure obstacles are kept
  ChartRoomConfig chart_room;
  SignalingConfig signaling;
  SurveyConfig survey;
  CircleConfig circle;
  CloserLookConfig closer_look;
};

/// Bound to `config`.
std::vector<Section> sections(MissionConfig& config);

/// In the order in which they receive messages: fls detector, navigator, captain, commodore, executive officer,
/// goal selector, pilot, chart room, signaling officer; then the back-seat drivers, survey and circle.
std::vector<AgentSlot> standard_agents(const MissionConfig& config, const VehicleParameters& vehicle);

}  // namespace isobath

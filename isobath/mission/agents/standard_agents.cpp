#include <isobath/mission/agents/standard_agents.hpp>

namespace isobath {

std::vector<Section> sections(MissionConfig& c) {
  return {
      {"timing", "How often each level of command plans, and how far ahead.", fields(c.timing)},
      {"captain", "The agent that starts and ends missions.", fields(c.captain)},
      {"commodore", "The agent that shares a search area with other vehicles.", fields(c.commodore)},
      {"executive", "The agent that takes the vehicle from point to point.", fields(c.executive)},
      {"navigator", "When a route is kept, changed or given up.", fields(c.navigator)},
      {"route", "How a path past obstacles is searched.", fields(c.route)},
      {"space_route", "How a path over, under or between obstacles is searched, where a sonar measures height.",
       fields(c.space_route)},
      {"opening", "What is done about an opening that the route leads through.", fields(c.opening)},
      {"goal_selector", "How motions past moving bodies are planned in time.", fields(c.goal_selector)},
      {"pilot", "How way-points become set-points.", fields(c.pilot)},
      {"guidance", "How a line is followed.", fields(c.guidance)},
      {"station", "How a position is held.", fields(c.station)},
      {"depth_keeping", "How depth and altitude are kept.", fields(c.depth_keeping)},
      {"fls_detector", "Which obstacles are sent to the Navigator.", fields(c.fls_detector)},
      {"memory", "How long obstacles are remembered, and how well.", fields(c.memory)},
      {"chart_room", "Which parts of the chart are hazards.", fields(c.chart_room)},
      {"signaling", "The vehicle's end of the link to the operator.", fields(c.signaling)},
      {"survey", "The back-seat driver that surveys in lanes.", fields(c.survey)},
      {"circle", "The back-seat driver that circles a point.", fields(c.circle)},
      {"closer_look", "The back-seat driver that looks at an obstacle from nearby.", fields(c.closer_look)},
  };
}

std::vector<AgentSlot> standard_agents(const MissionConfig& c, const VehicleParameters& vehicle) {
  std::vector<AgentSlot> slots;
  const auto slot = [&](const char* name, AgentLevel level, std::unique_ptr<Agent> agent) {
    slots.push_back({name, level, std::move(agent)});
  };
  slot("fls detector", AgentLevel::kVehicle, std::make_unique<FlsDetector>(c.fls_detector, c.memory));
  slot("navigator", AgentLevel::kMission,
       std::make_unique<Navigator>(c.navigator, c.route, vehicle, c.space_route, c.opening, c.timing));
  slot("captain", AgentLevel::kSupervisory, std::make_unique<Captain>(c.captain, c.timing));
  slot("commodore", AgentLevel::kSupervisory, std::make_unique<Commodore>(c.commodore, c.timing));
  slot("executive officer", AgentLevel::kMission, std::make_unique<ExecutiveOfficer>(c.executive, c.timing));
  slot("goal selector", AgentLevel::kMission, std::make_unique<GoalSelector>(c.goal_selector, vehicle));
  slot("pilot", AgentLevel::kVehicle,
       std::make_unique<Pilot>(c.pilot, c.guidance, c.station, c.depth_keeping, vehicle, c.timing));
  slot("chart room", AgentLevel::kMission, std::make_unique<ChartRoom>(c.chart_room));
  slot("signaling officer", AgentLevel::kSupervisory, std::make_unique<SignalingOfficer>(c.signaling));
  const double turning_radius_m = vehicle.limits.turning_radius;
  slot("survey", AgentLevel::kMission, std::make_unique<SurveyDriver>(c.survey, turning_radius_m));
  slot("circle", AgentLevel::kMission, std::make_unique<CircleDriver>(c.circle, turning_radius_m));
  slot("closer look", AgentLevel::kMission,
       std::make_unique<CloserLookDriver>(c.closer_look, c.route.clearance_m + vehicle.half_width_m, turning_radius_m));
  return slots;
}

}  // namespace isobath

#include <isobath/mission/standard_crew.hpp>

namespace isobath {

std::vector<Section> sections(MissionConfig& c) {
  return {
      {"captain", "Who starts and ends missions.", fields(c.captain)},
      {"executive", "Who leads from point to point.", fields(c.executive)},
      {"navigator", "When a way is kept, changed or given up.", fields(c.navigator)},
      {"route", "How a way past obstacles is searched.", fields(c.route)},
      {"space_route", "How a way over, under or between them is searched, where a sonar tells height.",
       fields(c.space_route)},
      {"pilot", "How way-points become set-points.", fields(c.pilot)},
      {"guidance", "How a line is followed.", fields(c.guidance)},
      {"station", "How a place is kept.", fields(c.station)},
      {"depth_keeping", "How depth and altitude are kept.", fields(c.depth_keeping)},
      {"fls_detector", "What the Navigator is told of obstacles.", fields(c.fls_detector)},
      {"memory", "How long obstacles are remembered, and how well.", fields(c.memory)},
      {"chart_room", "What of the chart is in the way.", fields(c.chart_room)},
      {"signaling", "The vehicle's end of the link to the operator.", fields(c.signaling)},
      {"survey", "The back-seat driver that surveys in lanes.", fields(c.survey)},
      {"circle", "The back-seat driver that goes round a place.", fields(c.circle)},
  };
}

std::vector<Seat> standard_crew(const MissionConfig& c, const VehicleSheet& vehicle) {
  std::vector<Seat> seats;
  const auto seat = [&](const char* name, AgentLevel level, std::unique_ptr<Agent> agent) {
    seats.push_back({name, level, std::move(agent)});
  };
  seat("fls detector", AgentLevel::kVehicle, std::make_unique<FlsDetector>(c.fls_detector, c.memory));
  seat("navigator", AgentLevel::kMission, std::make_unique<Navigator>(c.navigator, c.route, vehicle, c.space_route));
  seat("captain", AgentLevel::kSupervisory, std::make_unique<Captain>(c.captain));
  seat("executive officer", AgentLevel::kMission, std::make_unique<ExecutiveOfficer>(c.executive));
  seat("pilot", AgentLevel::kVehicle,
       std::make_unique<Pilot>(c.pilot, c.guidance, c.station, c.depth_keeping, vehicle));
  seat("chart room", AgentLevel::kMission, std::make_unique<ChartRoom>(c.chart_room));
  seat("signaling officer", AgentLevel::kSupervisory, std::make_unique<SignalingOfficer>(c.signaling));
  const double turning_radius_m = vehicle.limits.turning_radius;
  seat("survey", AgentLevel::kMission, std::make_unique<SurveyDriver>(c.survey, turning_radius_m));
  seat("circle", AgentLevel::kMission, std::make_unique<CircleDriver>(c.circle, turning_radius_m));
  return seats;
}

}  // namespace isobath

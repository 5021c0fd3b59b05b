// Runs a mission in a simulated scene, in a closed loop, and prints what the agents decided and why.
//
//   7_mission_in_a_scene [SCENARIO.toml]    without a file: three points in a reservoir, two buoys on the way
#include <cstdio>
#include <isobath/run/closed_loop.hpp>

using namespace isobath;

int main(int argc, char** argv) {
  const Scenario scenario = open_scenario(argc > 1 ? argv[1] : "");
  LoopRequest request;
  request.configuration.mission.route.clearance_m = 4;  // as every other setting: docs/configuration.md
  const LoopResult result = run_closed_loop(scenario, request);

  for (const Decision& decision : result.decisions) std::printf("%s\n", to_text(decision).c_str());
  std::printf("%s: %zu of %zu points reached in %.0f s and %.0f m\n", to_text(result.report.phase),
              result.report.reached, scenario.mission.points.size(), result.duration_s, result.length_m);
  if (result.contact_s >= 0) return std::printf("contact with %s\n", result.contact_with.c_str()), 1;
  std::printf("nearest body: %s, %.1f m from the hull\n", result.nearest_body.c_str(), result.min_clearance_m);
  return result.report.phase == MissionPhase::kFinished ? 0 : 1;
}

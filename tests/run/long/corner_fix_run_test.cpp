// Missions whose navigation drifts by 1 % of the way, past walls that the chart shows, does not show, or shows wrongly.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <tests/support/mission_runs.hpp>

namespace isobath::corner_fix_run_test {
namespace {

using Eigen::Vector2d;

/// The positions that everything on board uses.
class Believed : public OnboardObserver {
 public:
  std::vector<std::pair<Time, Vector2d>> places;
  void on_fix(const Navigation& fix) override { places.emplace_back(fix.time, fix.X_WB.translation.head<2>()); }
};

struct Voyage {
  LoopResult result;
  double last_m = 0, largest_m = 0;  ///< navigation error
};

Voyage sail(const Scenario& scenario, int seed, bool fixes) {
  Believed believed;
  LoopRequest request;
  request.observers = {&believed};
  request.configuration.simulation.seed = seed;
  request.configuration.corner_fix.on = fixes;
  Voyage voyage{run_closed_loop(scenario, request)};
  for (const auto& [time, place] : believed.places) {
    const auto truth = true_place_at(voyage.result, time);
    if (!truth) continue;
    voyage.last_m = (place - *truth).norm();
    voyage.largest_m = std::max(voyage.largest_m, voyage.last_m);
  }
  return voyage;
}

}  // namespace
}  // namespace isobath::corner_fix_run_test

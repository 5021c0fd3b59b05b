// VehicleGroup: the runs of several vehicles in one water, side by side, joined by what is real between them: they see
// each other as bodies, and their modems share the water (ledger S2-50, S2-51).
//
// The vehicles run in steps of kGroupStep_s. Within a step the others go on with the velocity that they had at its
// begin; packets that a vehicle sends within a step are sent at its end. The result is a function of the runs and the
// seed, on any number of threads. A vehicle that the scene loses neither moves nor speaks from then on.
#pragma once

#include <isobath/base/thread_pool.hpp>
#include <isobath/run/stepped_run.hpp>
#include <isobath/scenario/group_record.hpp>
#include <span>
#include <vector>

namespace isobath {

inline constexpr double kGroupStep_s = 0.1;

class VehicleGroup {
 public:
  /// `scenario`: of the group. `runs`: of its vehicles in their order; they must outlive the group.
  VehicleGroup(const Scenario& scenario, std::vector<SteppedRun*> runs, std::uint64_t seed, int threads);

  /// Runs until each mission is over. Tracks, decisions, reports and bodies of the record are left to the caller.
  GroupRecord run();

 private:
  /// What the others see of a vehicle.
  struct Seen {
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero(), v_W = Eigen::Vector3d::Zero();
  };
  /// Whether the mission of a vehicle that is not lost goes on.
  [[nodiscard]] bool goes_on() const;
  [[nodiscard]] bool is_lost(std::size_t vehicle, double t_s) const;
  void look(double t_s);
  void measure(double t_s);
  void step(double until_s);
  void talk(double t_s);

  std::vector<SteppedRun*> runs_;
  AcousticLink link_;
  ThreadPool pool_;
  std::vector<Seen> seen_;
  std::vector<char> on_;  ///< whether the vehicle's run goes on
  GroupRecord record_;
};

/// The bodies of the scene as a vehicle's run holds them, without the other vehicles.
std::vector<TrueBody> bodies_without_vehicles(SteppedRun& run, const MissionPlan& plan);

}  // namespace isobath

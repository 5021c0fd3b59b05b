#include <algorithm>
#include <exception>
#include <isobath/run/vehicle_group.hpp>

namespace isobath {

VehicleGroup::VehicleGroup(const Scenario& scenario, std::vector<SteppedRun*> runs, std::uint64_t seed, int threads)
    : runs_(std::move(runs)),
      link_(scenario.scene.link, runs_.size(), seed),
      pool_(threads),
      seen_(runs_.size()),
      on_(runs_.size(), 1) {
  record_.plan = scenario.mission;
  for (const GroupMember& member : scenario.mission.group) record_.vehicles.emplace_back().name = member.name;
}

bool VehicleGroup::goes_on() const {
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    if (on_[v] != 0 && !runs_[v]->mission_is_over()) return true;
  }
  return false;
}

bool VehicleGroup::is_lost(std::size_t vehicle, double t_s) const {
  const double lost_s = runs_[vehicle]->scenario().scene.vehicle.lost_s;
  return lost_s > 0 && t_s >= lost_s;
}

/// Each vehicle's world gets the others where they are now.
void VehicleGroup::look(double t_s) {
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    const VehicleState& state = runs_[v]->simulator()->state();
    seen_[v].p_W = state.X_WB.translation;
    seen_[v].v_W = on_[v] != 0 ? Eigen::Vector3d(state.X_WB.rotation * state.v_B) : Eigen::Vector3d::Zero();
  }
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    for (std::size_t other = 0; other < runs_.size() && on_[v] != 0; ++other) {
      if (other == v) continue;
      runs_[v]->simulator()->steer_body(runs_[v]->scenario().body_of(other), t_s, seen_[other].p_W, seen_[other].v_W);
    }
  }
}

void VehicleGroup::measure(double t_s) {
  for (std::size_t a = 0; a < runs_.size(); ++a) {
    for (std::size_t b = a + 1; b < runs_.size(); ++b) {
      const double apart_m = (seen_[a].p_W - seen_[b].p_W).norm() - runs_[a]->simulator()->hull_radius() -
                             runs_[b]->simulator()->hull_radius();
      if (apart_m >= record_.least_separation_m) continue;
      record_.least_separation_m = apart_m;
      record_.least_separation_s = t_s;
    }
  }
  for (const GroupPassage& passage : record_.plan.passages) {
    std::size_t inside = 0;
    for (std::size_t v = 0; v < runs_.size(); ++v) inside += contains(passage.outline, seen_[v].p_W.head<2>());
    if (inside > 1) record_.passage_shared_s += kGroupStep_s;
  }
}

void VehicleGroup::step(double until_s) {
  std::vector<std::exception_ptr> thrown(runs_.size());
  pool_.share(static_cast<int>(runs_.size()), 1, [&](int first, int last) {
    for (int v = first; v < last; ++v) {
      const auto at = static_cast<std::size_t>(v);
      if (on_[at] == 0) continue;
      try {
        if (!runs_[at]->advance(until_s)) on_[at] = 0;
      } catch (...) {
        thrown[at] = std::current_exception();
      }
    }
  });
  for (const std::exception_ptr& one : thrown) {
    if (one) std::rethrow_exception(one);
  }
}

void VehicleGroup::talk(double t_s) {
  const Time now(seconds(t_s));
  std::vector<Eigen::Vector3d> places_W;
  for (SteppedRun* run : runs_) places_W.push_back(run->simulator()->state().X_WB.translation);
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    for (FrameBytes& packet : runs_[v]->take_packets()) link_.send(v, now, std::move(packet), places_W);
  }
  for (AcousticLink::Delivery& packet : link_.arrived(now)) {
    if (on_[packet.to] != 0) runs_[packet.to]->hear({packet.time, std::move(packet.bytes)});
  }
}

GroupRecord VehicleGroup::run() {
  std::int64_t steps = 0;
  double t_s = 0;
  while (goes_on()) {
    for (std::size_t v = 0; v < runs_.size(); ++v) {
      if (on_[v] == 0 || !is_lost(v, t_s)) continue;
      on_[v] = 0;
      record_.vehicles[v].lost_s = t_s;
    }
    look(t_s);
    measure(t_s);
    t_s = kGroupStep_s * static_cast<double>(++steps);
    step(t_s);
    talk(t_s);
  }
  record_.duration_s = t_s;
  for (std::size_t v = 0; v < runs_.size(); ++v) record_.vehicles[v].link = link_.counts()[v];
  return std::move(record_);
}

std::vector<TrueBody> bodies_without_vehicles(SteppedRun& run, const MissionPlan& plan) {
  std::vector<TrueBody> bodies = outlines_of(run.simulator()->world());
  std::erase_if(bodies, [&plan](const TrueBody& body) {
    return std::ranges::any_of(plan.group, [&](const GroupMember& member) { return member.name == body.name; });
  });
  return bodies;
}

}  // namespace isobath

#include <algorithm>
#include <exception>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/thread_pool.hpp>
#include <isobath/run/group_run.hpp>
#include <isobath/run/vehicle_run.hpp>
#include <memory>

namespace isobath {
namespace {

void check_group(const RunRequest& request) {
  const auto refuse = [&request](const char* what) {
    throw Error(fmt::format("{} of a group of vehicles", what), {request.input.string(), {}, {}, {}, {}},
                "a run without it");
  };
  if (request.live_speed) refuse("a live run");
  if (request.watch) refuse("a page");
  if (!request.map.empty()) refuse("a stored map");
  if (!request.mission.empty()) refuse("another mission");
}

class Group {
 public:
  Group(const RunRequest& request, const Scenario& scenario);
  GroupOutcome run();

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
  GroupOutcome finish(double t_s);

  RunRequest request_;
  const Scenario& scenario_;
  std::vector<std::unique_ptr<VehicleRun>> runs_;
  AcousticLink link_;
  ThreadPool pool_;
  std::vector<Seen> seen_;
  std::vector<char> on_;  ///< whether the vehicle's run goes on
  std::vector<std::optional<double>> lost_s_;
  GroupOutcome outcome_;
};

Group::Group(const RunRequest& request, const Scenario& scenario)
    : request_(request),
      scenario_(scenario),
      link_(
          scenario.scene.link, scenario.mission.group.size(),
          static_cast<std::uint64_t>(request.configuration.simulation.seed >= 0 ? request.configuration.simulation.seed
                                                                                : scenario.scene.about.seed)),
      pool_(request.threads),
      seen_(scenario.mission.group.size()),
      on_(scenario.mission.group.size(), 1),
      lost_s_(scenario.mission.group.size()) {
  for (std::size_t v = 0; v < seen_.size(); ++v) {
    RunRequest own = request;
    own.vehicle = v;
    own.out = request.out / scenario.mission.group[v].name;
    own.threads = 1;
    if (!request.record.empty()) {
      own.record.replace_filename(request.record.stem().string() + "-" + scenario.mission.group[v].name +
                                  request.record.extension().string());
    }
    int& seed = own.configuration.simulation.seed;
    if (seed >= 0) seed = seed_of_vehicle(seed, v);
    if (v > 0) own.progress = {};
    runs_.push_back(std::make_unique<VehicleRun>(own));
  }
}

bool Group::goes_on() const {
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    if (on_[v] != 0 && !runs_[v]->mission_is_over()) return true;
  }
  return false;
}

bool Group::is_lost(std::size_t vehicle, double t_s) const {
  const double lost_s = runs_[vehicle]->scenario()->scene.vehicle.lost_s;
  return lost_s > 0 && t_s >= lost_s;
}

/// Each vehicle's world gets the others where they are now.
void Group::look(double t_s) {
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    const VehicleState& state = runs_[v]->simulator()->state();
    seen_[v].p_W = state.X_WB.translation;
    seen_[v].v_W = on_[v] != 0 ? Eigen::Vector3d(state.X_WB.rotation * state.v_B) : Eigen::Vector3d::Zero();
  }
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    for (std::size_t other = 0; other < runs_.size() && on_[v] != 0; ++other) {
      if (other == v) continue;
      runs_[v]->simulator()->steer_body(runs_[v]->scenario()->body_of(other), t_s, seen_[other].p_W, seen_[other].v_W);
    }
  }
}

void Group::measure(double t_s) {
  for (std::size_t a = 0; a < runs_.size(); ++a) {
    for (std::size_t b = a + 1; b < runs_.size(); ++b) {
      const double apart_m = (seen_[a].p_W - seen_[b].p_W).norm() - runs_[a]->simulator()->hull_radius() -
                             runs_[b]->simulator()->hull_radius();
      if (apart_m >= outcome_.least_separation_m) continue;
      outcome_.least_separation_m = apart_m;
      outcome_.least_separation_s = t_s;
    }
  }
}

void Group::step(double until_s) {
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

void Group::talk(double t_s) {
  const Time now(seconds(t_s));
  std::vector<Eigen::Vector3d> places_W;
  for (const auto& run : runs_) places_W.push_back(run->simulator()->state().X_WB.translation);
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    for (FrameBytes& packet : runs_[v]->take_packets()) link_.send(v, now, std::move(packet), places_W);
  }
  for (AcousticLink::Delivery& packet : link_.arrived(now)) {
    if (on_[packet.to] != 0) runs_[packet.to]->hear({packet.time, std::move(packet.bytes)});
  }
}

GroupOutcome Group::run() {
  std::int64_t steps = 0;
  double t_s = 0;
  while (goes_on()) {
    for (std::size_t v = 0; v < runs_.size(); ++v) {
      if (on_[v] == 0 || !is_lost(v, t_s)) continue;
      on_[v] = 0;
      lost_s_[v] = t_s;
    }
    look(t_s);
    measure(t_s);
    t_s = kGroupStep_s * static_cast<double>(++steps);
    step(t_s);
    talk(t_s);
  }
  return finish(t_s);
}

GroupOutcome Group::finish(double t_s) {
  outcome_.plan = scenario_.mission;
  outcome_.duration_s = t_s;
  for (std::size_t v = 0; v < runs_.size(); ++v) {
    GroupVehicleOutcome& vehicle = outcome_.vehicles.emplace_back();
    vehicle.name = scenario_.mission.group[v].name;
    vehicle.lost_s = lost_s_[v];
    vehicle.link = link_.counts()[v];
    vehicle.run = runs_[v]->outcome();
    if (!vehicle.run.mission) continue;
    const MissionReport& report = vehicle.run.mission->report;
    vehicle.lanes = (report.reached + report.dropped) / scenario_.mission.search.stations();
    for (const Decision& decision : vehicle.run.mission->decisions) {
      if (decision.what != "area searched") continue;
      const double done_s = to_seconds(decision.time.time_since_epoch());
      outcome_.all_searched_s = std::min(outcome_.all_searched_s.value_or(done_s), done_s);
    }
  }
  add_searched(outcome_);
  write_whole_file(request_.out / "group.json", group_text(outcome_));
  write_whole_file(request_.out / "group.png", draw_group(outcome_));
  return std::move(outcome_);
}

}  // namespace

GroupOutcome run_group(const RunRequest& request, const Scenario& scenario) {
  check_group(request);
  return Group(request, scenario).run();
}

}  // namespace isobath

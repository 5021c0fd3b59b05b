#include <algorithm>
#include <cmath>
#include <isobath/base/thread_pool.hpp>
#include <isobath/onboard/stage_cpu_time.hpp>
#include <isobath/planning/traffic/reciprocal_avoidance.hpp>
#include <isobath/studies/traffic_gaps.hpp>
#include <isobath/studies/traffic_study.hpp>
#include <memory>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kDeep_m = 0.1;
constexpr int kNeighbours = 20;
constexpr int kWaterSteps = 10;  // from measuring to measuring the water between the discs

/// A vehicle in a scene, moved by one method.
class TrafficRunner {
 public:
  TrafficRunner(const TrafficRequest& request, TrafficMethod method) : request_(request), method_(method) {
    own_.speed = TrafficScene::kSpeed;
    if (method == TrafficMethod::kPlanner || method == TrafficMethod::kSearch) {
      TrafficConfig config = request.planner;
      config.roads = config.roads && method == TrafficMethod::kPlanner;
      planner_ = std::make_unique<TrafficPlanner>(config, request.vehicle);
      planner_->set_goal(TrafficScene::goal(), TrafficScene::kArrival_m);
      own_.speed = request.vehicle.max_speed;
    }
  }

  void step(TrafficScene& scene, TrafficRun& run) {
    scene.sense(own_.p_W, request_.reach_m, request_.known_map, seen_);
    switch (method_) {
      case TrafficMethod::kPlanner:
      case TrafficMethod::kSearch: follow_plan(scene, run); break;
      case TrafficMethod::kStraight: move_by({TrafficScene::kSpeed, 0}); break;
      case TrafficMethod::kOrca: move_by(avoid(0.5)); break;
      case TrafficMethod::kOrcaFull: move_by(avoid(1)); break;
    }
  }
  [[nodiscard]] const MotionState& own() const { return own_; }

 private:
  void follow_plan(const TrafficScene& scene, TrafficRun& run) {
    const TrafficPlan& plan = planner_->step(own_, scene.now(), seen_);
    if (!plan.reason.empty()) ++run.steps_without_motion;
    if (!plan.road_reason.empty()) ++run.steps_without_path;
    if (plan.number != run.plans) {
      run.plans = plan.number;
      run.road_plans += plan.on_road;
      run.mended += plan.mends;
    }
    run.refused_paths = planner_->road_work().refused_paths;
    run.detail = planner_->road_work().detail;
    own_ = plan.trajectory.at(to_seconds(scene.now() - plan.start) + TrafficScene::kStep_s);
  }
  Vector2d avoid(double share) {
    discs_.clear();
    for (const MovingBody& body : seen_) discs_.push_back({body.p_W, body.velocity_W, body.radius_m});
    const auto distance = [&](const AvoidedDisc& disc) { return (disc.p - own_.p_W).squaredNorm(); };
    std::ranges::stable_sort(discs_, {}, distance);
    if (discs_.size() > kNeighbours) discs_.resize(kNeighbours);
    const Vector2d to_goal = TrafficScene::goal() - own_.p_W;
    return reciprocal_velocity(
        {own_.p_W, velocity_, TrafficScene::kRadius_m}, TrafficScene::kSpeed * to_goal.normalized(), discs_,
        {.horizon_s = 10, .step_s = TrafficScene::kStep_s, .share = share, .max_speed = TrafficScene::kSpeed});
  }
  void move_by(const Vector2d& velocity) {
    velocity_ = velocity;
    own_.p_W += TrafficScene::kStep_s * velocity;
    own_.speed = velocity.norm();
    if (own_.speed > 0) own_.heading = std::atan2(velocity.y(), velocity.x());
  }

  const TrafficRequest& request_;
  TrafficMethod method_;
  MotionState own_;
  Vector2d velocity_ = Vector2d::Zero();
  std::unique_ptr<TrafficPlanner> planner_;
  std::vector<MovingBody> seen_;
  std::vector<AvoidedDisc> discs_;
};

/// The value that a share of the sorted values lies below.
double quantile_of(std::vector<double>& values, double share) {
  std::ranges::sort(values);
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::floor(share * last + 0.5))];
}

TrafficRow traffic_row(const TrafficRequest& request, TrafficMethod method, int discs, double max_speed,
                       ThreadPool& pool) {
  std::vector<TrafficRun> runs(request.runs);
  std::vector<LatencyHistogram> times(request.runs);
  pool.share(request.runs, 1, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      runs[i] = run_traffic(request, method, request.first_run + i, discs, max_speed, times[i], false);
    }
  });
  TrafficRow row{.method = method, .discs = discs, .max_speed = max_speed, .runs = request.runs};
  std::vector<double> time, gap, length, deviation, water;
  LatencyHistogram all;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const TrafficRun& run = runs[i];
    row.contacts += run.least_gap_m < 0;
    row.deep_contacts += run.least_gap_m < -kDeep_m;
    row.arrived += run.arrived;
    row.without_motion += run.steps_without_motion > 0;
    if (run.least_gap_m < 0) row.contact_runs.push_back(request.first_run + static_cast<int>(i));
    row.without_path += run.steps_without_path > 0;
    ++row.at_detail[static_cast<std::size_t>(run.detail)];
    row.plans += run.plans;
    row.road_plans += run.road_plans;
    row.mended += run.mended;
    row.refused_paths += run.refused_paths;
    row.curvature_most = std::max(row.curvature_most, run.curvature);
    time.push_back(run.time_s / run.free_time_s);
    length.push_back(run.length_m / (run.free_time_s * TrafficScene::kSpeed));
    gap.push_back(run.least_gap_m);
    deviation.push_back(run.deviation_m);
    water.insert(water.end(), run.water_m.begin(), run.water_m.end());
    all.add(times[i]);
  }
  row.contact_share = wilson_interval(row.contacts, row.runs);
  row.deep_share = wilson_interval(row.deep_contacts, row.runs);
  row.arrived_share = wilson_interval(row.arrived, row.runs);
  row.length_median = quantile_of(length, 0.5);
  row.deviation_median_m = quantile_of(deviation, 0.5);
  row.time_median = quantile_of(time, 0.5);
  row.time_p95 = quantile_of(time, 0.95);
  row.gap_median_m = quantile_of(gap, 0.5);
  row.gap_least_m = gap.front();
  row.water_median_m = quantile_of(water, 0.5);
  row.water_p05_m = quantile_of(water, 0.05);
  row.step = all.time();
  return row;
}

}  // namespace

std::string to_text(TrafficMethod method) {
  switch (method) {
    case TrafficMethod::kPlanner: return "planner";
    case TrafficMethod::kSearch: return "search";
    case TrafficMethod::kOrca: return "orca";
    case TrafficMethod::kOrcaFull: return "orca_full";
    case TrafficMethod::kStraight: break;
  }
  return "straight";
}

std::vector<Section> sections(TrafficRequest& request) {
  return {{"planner", "Planning among moving bodies.", fields(request.planner)},
          {"vehicle", "The vehicle that plans.", fields(request.vehicle)}};
}

TrafficRun run_traffic(const TrafficRequest& request, TrafficMethod method, int run, int discs, double max_speed,
                       LatencyHistogram& times, bool keep_track) {
  TrafficScene scene(request.scenery, run, discs, max_speed);
  TrafficRunner runner(request, method);
  TrafficGaps gaps(scene);
  const Vector2d start = runner.own().p_W;
  TrafficRun result;
  result.free_time_s = scene.free_time_s();
  result.least_gap_m = scene.gap(runner.own().p_W);
  const int steps = static_cast<int>(std::round(TrafficScene::kLimit_s / TrafficScene::kStep_s));
  Vector2d rest = runner.own().p_W;
  double rested_s = 0;
  for (int step = 0; step < steps && !result.arrived && rested_s < TrafficScene::kRest_s; ++step) {
    if (keep_track) result.track.push_back({result.time_s, runner.own()});
    gaps.follow(scene);
    if (step % kWaterSteps == 0) result.water_m.push_back(gaps.widest_m(start, TrafficScene::goal()));
    const MotionState from = runner.own();
    const std::int64_t before = thread_nanoseconds();
    runner.step(scene, result);
    times.add(1e-6 * static_cast<double>(thread_nanoseconds() - before));
    scene.step();
    rested_s += TrafficScene::kStep_s;
    if ((runner.own().p_W - rest).norm() > TrafficScene::kRest_m) {
      rest = runner.own().p_W;
      rested_s = 0;
    }
    const double way_m = (runner.own().p_W - from.p_W).norm();
    result.length_m += way_m;
    result.deviation_m += way_m * std::abs(runner.own().p_W.y() - TrafficScene::goal().y());
    const double turn = std::abs(std::remainder(runner.own().heading - from.heading, 2 * std::numbers::pi));
    // In less than a centimetre the digits of the places count for more than the turn.
    if (way_m > 0.01) result.curvature = std::max(result.curvature, turn / way_m / request.vehicle.max_curvature());
    result.time_s = (step + 1) * TrafficScene::kStep_s;
    result.least_gap_m = std::min(result.least_gap_m, scene.gap(runner.own().p_W));
    result.arrived = (TrafficScene::goal() - runner.own().p_W).norm() <= TrafficScene::kArrival_m;
  }
  if (result.length_m > 0) result.deviation_m /= result.length_m;
  if (keep_track) result.track.push_back({result.time_s, runner.own()});
  return result;
}

TrafficStudy study_traffic(const TrafficRequest& request) {
  const bool has_structures = request.scenery != TrafficScenery::kOpen && request.scenery != TrafficScenery::kCrossing;
  for (const TrafficMethod method : request.methods) {
    if (has_structures && method != TrafficMethod::kPlanner && method != TrafficMethod::kSearch) {
      throw Error("the method " + to_text(method) + " avoids discs only, and the scene " + to_text(request.scenery) +
                      " has structures",
                  {}, "planner or search");
    }
  }
  const TrafficPlanner checked(request.planner, request.vehicle);  // throws here, not on another thread
  TrafficStudy study;
  ThreadPool pool(request.threads);
  for (const TrafficMethod method : request.methods) {
    for (const int discs : request.discs) {
      for (const double speed : request.max_speeds)
        study.rows.push_back(traffic_row(request, method, discs, speed, pool));
    }
  }
  return study;
}

}  // namespace isobath

// TrafficStudy: vehicles that cross moving traffic in random scenes (workload E), by several methods: our planner with
// a vehicle that turns and accelerates like one, and discs that move in any direction by optimal reciprocal collision
// avoidance, or straight ahead (ledger S3-01, S3-D01).
//
// A run ends at the goal, after 400 s, or where the vehicle has stayed within 5 m for 60 s; a contact does not end it.
// Each method sees the discs within its reach, with their exact positions and velocities, and does not know that they
// are reflected. Structures that stand still are known from the start, or, in an unknown map, as far as they have been
// within reach. Results do not depend on the number of threads; only the planning times do, which are processor time of
// the thread.
//
// Times are divided by that of the shortest path past the still structures at full speed; without any, that straight
// ahead.
#pragma once

#include <array>
#include <isobath/base/config.hpp>
#include <isobath/onboard/latency_histogram.hpp>
#include <isobath/planning/traffic/traffic_planner.hpp>
#include <isobath/sonar/roc.hpp>
#include <isobath/studies/traffic_scene.hpp>
#include <string>
#include <vector>

namespace isobath {

enum class TrafficMethod : std::uint8_t {
  kPlanner,   ///< TrafficPlanner
  kSearch,    ///< TrafficPlanner without a road map
  kOrca,      ///< reciprocal avoidance with half of the responsibility
  kOrcaFull,  ///< with all of it, as the discs do not react
  kStraight,  ///< straight ahead
};
inline constexpr std::array kTrafficMethods = {TrafficMethod::kPlanner, TrafficMethod::kSearch, TrafficMethod::kOrca,
                                               TrafficMethod::kOrcaFull, TrafficMethod::kStraight};
/// "planner", "search", "orca", "orca_full", "straight".
std::string to_text(TrafficMethod method);

struct TrafficRequest {
  TrafficScenery scenery = TrafficScenery::kOpen;
  std::vector<int> discs = {20, 50, 100};
  std::vector<double> max_speeds = {0.5, 1, 1.5};  ///< of the discs, m/s
  std::vector<TrafficMethod> methods = {TrafficMethod::kPlanner, TrafficMethod::kOrca, TrafficMethod::kOrcaFull,
                                        TrafficMethod::kStraight};
  bool known_map = true;  ///< structures are known from the start
  double reach_m = 50;    ///< of the sensors
  int runs = 500;
  int first_run = 0;
  int threads = 1;
  TrafficConfig planner;
  TrafficVehicle vehicle;
};

/// All settings, as `--config` and `--set` name them; bound to `request`, which must outlive them.
std::vector<Section> sections(TrafficRequest& request);

/// A moment of a run.
struct TrafficMoment {
  double time_s = 0;
  MotionState own;
};

struct TrafficRun {
  double time_s = 0;  ///< to the goal, or the end of the run
  bool arrived = false;
  double least_gap_m = 0;         ///< below 0: contact
  double free_time_s = 0;         ///< along the shortest path past still structures
  double length_m = 0;            ///< of the track
  double deviation_m = 0;         ///< from the straight way, mean over the length of the track (S3-17)
  double curvature = 0;           ///< the greatest of the track, over the greatest that the vehicle can follow
  int steps_without_motion = 0;   ///< in which no free motion was found
  int steps_without_path = 0;     ///< in which the road map had no path or no motion along one
  int plans = 0, road_plans = 0;  ///< all plans, and those along the road map
  int mended = 0;                 ///< plans along the path before with other speeds
  int refused_paths = 0;          ///< that do not bend as the vehicle needs
  std::vector<double> water_m;    ///< each second: the widest way between the discs (traffic_gaps.hpp)
  ShapeDetail detail = ShapeDetail::kEnclosure;  ///< the finest of any outline
  std::vector<TrafficMoment> track;              ///< if it is asked for
};

TrafficRun run_traffic(const TrafficRequest& request, TrafficMethod method, int run, int discs, double max_speed,
                       LatencyHistogram& times, bool keep_track);

struct TrafficRow {
  TrafficMethod method = TrafficMethod::kPlanner;
  int discs = 0;
  double max_speed = 0;
  int runs = 0, contacts = 0, deep_contacts = 0, arrived = 0, without_motion = 0;
  int without_path = 0;                          ///< runs with a step without a path or a motion along one
  std::array<int, 3> at_detail = {};             ///< runs by the finest level of detail that they needed
  int plans = 0, road_plans = 0, mended = 0;     ///< of all runs
  int refused_paths = 0;                         ///< of all runs
  Interval contact_share = {}, deep_share = {};  ///< Wilson, 95 %
  Interval arrived_share = {};                   ///< Wilson, 95 %
  double time_median = 0, time_p95 = 0;          ///< over the free time, of all runs
  double length_median = 0;                      ///< of the track over the shortest path
  double curvature_most = 0;  ///< the greatest of all tracks, over the greatest that the vehicle can follow
  double gap_median_m = 0, gap_least_m = 0;
  double deviation_median_m = 0;
  double water_median_m = 0, water_p05_m = 0;  ///< over all runs and seconds; 5 % are narrower
  std::vector<int> contact_runs = {};
  StageTime step = {};
};

struct TrafficStudy {
  std::vector<TrafficRow> rows;
};

/// Throws Error if the request is invalid.
TrafficStudy study_traffic(const TrafficRequest& request);

}  // namespace isobath

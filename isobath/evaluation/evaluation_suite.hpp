// Suite: many runs of one scenario that differ only by a seed. It states what varies, which methods are compared, and
// which bars must hold (ledger S6-67). A suite is a TOML file, read as strictly as any other file of Isobath. The
// program also contains the suites of suites/ and opens them by name.
//
// A suite of faults has no scene of its own but one for each row of the fault table. Runs take the rows in turn: the
// run of a seed uses the row seed mod their number, and must show what the row states (fault_injection_check.hpp).
//
// A suite of variants (suite_variants.hpp) takes its variants in turn in the same way. A variant is a combination of a
// vehicle, a sonar, and an altimeter or none.
//
// A suite of encounters (sim/encounters.hpp) takes the 55 situations in turn: the run of a seed uses situation seed mod
// 55. Their bodies meet a vehicle that goes straight from its drawn start to the first mission point.
//
// A suite of groups (group_score.hpp) has a scene with several vehicles and no baselines; a [[group]] of one vehicle is
// what the others are compared with.
//
// A suite of replayed traffic (traffic_replay.hpp) needs a recording of ships, from its file or from the command line.
//
// A suite of a story (mission_story.hpp) states the stages that each run must show, in their order.
//
// A run is a function of the suite and its seed: run k of `runs` has the seed `seed` + k, and each run can be
// reproduced alone from its seed. A run draws, in this order: start and heading, current, drift of the navigation,
// noise level of the sonars, field of obstacles, encounters, replayed traffic, the vehicle of a group that is lost,
// plant, model of the control. Each of these has a random stream of its own; values are uniform. In a group each
// vehicle has a start of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/evaluation/mission_story.hpp>
#include <isobath/evaluation/suite_variants.hpp>
#include <isobath/evaluation/traffic_replay.hpp>
#include <isobath/mission/safety/fault_table.hpp>
#include <isobath/scenario/scenario.hpp>
#include <isobath/sim/clutter.hpp>
#include <isobath/sim/encounters.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// Methods that steer the runs of a suite for comparison with Isobath's agents, on the same runs (ledger S6-62).
enum class Baseline : std::uint8_t {
  kNoAvoidance,
  kPotentialField,
  kImageThreshold,
  kHistogramThreshold,
  kVelocityObstacles,
  kStopAndWait,
  kAsPrinted,
  kWorldFixedGrid
};
const char* to_text(Baseline baseline);

struct SuiteConfig {
  std::string title = "a suite", text;
  std::string scene;
  std::string faults;   ///< or a folder of scenes that are named like the rows of the fault table
  std::string without;  ///< name of a sonar that is switched off
  int runs = 100;
  int seed = 1;
  double duration_s = 240;    ///< 0: the duration of the scene
  double goal_m = 6;          ///< true distance at which the last mission point counts as reached
  double near_body_m = 4;     ///< a replan for an obstacle farther than this from every body counts as false
  double clearance_m = 3;     ///< clearance of the planner with full truth
  double planner_cell_m = 1;  ///< of the planner with full truth
};

/// Half widths of the values drawn about those of the scene; minimum and maximum of drift and factors.
/// A PlantDifference: ranges of the factors, half width of the buoyancy.
struct PlantVariation {
  Eigen::Vector2d mass = {1, 1}, drag = {1, 1};
  double buoyancy = 0;  ///< N
  bool operator==(const PlantVariation&) const = default;
};

struct VariationConfig {
  Eigen::Vector2d start = {0, 0};  ///< north, east, m
  Angle heading;
  double current = 0;                ///< maximum, m/s, any direction; in suites of faults added to that of the scene
  Eigen::Vector2d drift = {0, 0};    ///< share of the distance travelled, with a navigator of the kind `drift`
  Eigen::Vector2d noise = {1, 1};    ///< factor on the noise of all sonars
  Eigen::Vector2d density = {1, 1};  ///< factor on the density of the clutter
  PlantVariation plant, control_model;
  Eigen::Vector2d lost_s = {60, 200};  ///< when a vehicle of a group is lost, s
};

/// The bars for Isobath's agents; a bar of -1 is not applied.
struct BarsConfig {
  int collisions = 0;
  double goals_share = -1;
  double refused_share = -1;
  double path_ratio_median = -1;
  double false_obstacles_20m = -1;  ///< within 20 m of the vehicle, per scan
  double shown_share = -1;          ///< share of the fault runs that show what their rows state
  double story_share = -1;          ///< share of the runs that show the story
  // The following bars hold for every run of a group.
  double searched_share = -1;
  double overlap_share = -1;  ///< where no vehicle is lost
  double separation_m = -1;
  double passage_shared_s = -1;  ///< how long two vehicles are within one passage
  double bit_rate = -1;          ///< bit/s of each vehicle
};

struct Suite {
  std::string name;  ///< file name without its extension
  SuiteConfig about;
  VariationConfig vary;
  BarsConfig bars;
  ClutterConfig clutter;
  EncounterConfig encounters;
  ReplayConfig replay;
  std::optional<TrafficRecording> recording;  ///< that runs replay
  std::vector<Baseline> baselines;
  std::vector<StoryStage> stages;  ///< of the story that each run must show; none: no story
  VariantAxes axes;
  std::vector<SuiteVariant> variants;  ///< the runs take them in turn; none: the scene as it is
  std::vector<std::string> scenes;     ///< files: one, or one per row of the fault table
  std::uint64_t digest = 0;            ///< of the texts of suite, scenes and vehicles, and of the selected variants
};

/// Bound to `suite`, which must outlive it.
Schema schema(Suite& suite);
/// Throws Error with line and column.
Suite load_suite(const std::filesystem::path& file);
/// Keeps only the variants that have every part of `name`. Throws Error if there is none.
void select_variants(Suite& suite, const std::string& name);

/// The recording that the suite replays: this file, or, if it is empty, that of the suite. Throws Error if the suite
/// replays traffic and there is no file, or if there is one and the suite replays no traffic.
void load_recording(Suite& suite, const std::filesystem::path& file);

/// Names of the suites embedded in the program.
std::vector<std::string> embedded_suites();
/// The file of a suite. An embedded suite is written into `folder` together with all files that it names. Throws Error
/// with the names if it is neither an embedded suite nor a file.
std::filesystem::path find_suite(const std::string& name_or_file, const std::filesystem::path& folder);

/// Reads the scenes of the suite; make_run takes them, so that they are read only once.
std::vector<Scenario> load_scenes(const Suite& suite);

/// One run: the scene with all drawn values, and its mission. Without mission points, the way-points of the scene are
/// the mission.
struct SuiteRun {
  std::uint64_t seed = 0;
  Scenario scenario;
  std::string variant;            ///< name of the variant; empty in a suite without variants
  std::string conditions;         ///< the drawn values as text
  const FaultRow* row = nullptr;  ///< the row that the run must show, in a suite of faults
  EncounterSituation encounters;  ///< in a suite of encounters: of the targets, which are the last bodies of the scene
};
/// `scenes`: the scenes of the suite, at least one.
SuiteRun make_run(const Suite& suite, std::span<const Scenario> scenes, std::uint64_t seed);

}  // namespace isobath

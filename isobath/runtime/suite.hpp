// Suite: many runs of one scenario that differ by a seed: what varies, what is compared, and what must hold (ledger
// S6-67). A TOML file, strict as all of them; the ones of suites/ are also in the program, by name.
//
// A suite of faults has a scene for each row of the fault table instead, and takes them in turn: the run of a seed
// sails that of row seed mod their number, and is to show what the row says (fault_proof.hpp).
//
// A suite of variants (suite_variants.hpp) takes them in turn in the same way: vehicles, sonars, with and without an
// altimeter.
//
// A run is a function of the suite and its seed alone: run k of `runs` has the seed `seed` + k, so that any of them can
// be had again as the first of a suite of one. What is drawn: start, heading, current, drift of the navigation, level
// of the sonar's noise, the field of obstacles; each uniformly, in this order, each from a stream of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/mission/fault_table.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/runtime/suite_variants.hpp>
#include <isobath/sim/clutter.hpp>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// What a suite's runs are steered by, beside Isobath's own command: for comparison, on the same runs (ledger S6-62).
enum class Baseline : std::uint8_t { kNoAvoidance, kPotentialField, kImageThreshold, kAsPrinted };
const char* to_text(Baseline baseline);

struct SuiteConfig {
  std::string title = "a suite", text;
  std::string scene;
  std::string faults;   ///< or a folder of scenes that are named like the rows of the fault table
  std::string without;  ///< name of a sonar that is switched off
  int runs = 100;
  int seed = 1;
  double duration_s = 240;    ///< 0: the scene's own
  double goal_m = 6;          ///< the last mission point is reached this near, in truth
  double near_body_m = 4;     ///< a replan for an obstacle further than this from every body was for nothing
  double clearance_m = 3;     ///< that the planner with full truth keeps
  double planner_cell_m = 1;  ///< of the planner with full truth
};

/// Half widths of what is drawn about the scene's own value, and lowest and highest of factors.
struct VariationConfig {
  Eigen::Vector2d start = {0, 0};  ///< north, east, m
  Angle heading;
  double current = 0;                ///< largest, m/s; any direction; with faults on top of the scene's own
  Eigen::Vector2d drift = {0, 0};    ///< share of the way, with a navigator of the kind `drift`
  Eigen::Vector2d noise = {1, 1};    ///< factor on the noise of all sonars
  Eigen::Vector2d density = {1, 1};  ///< factor on the clutter's
};

/// What must hold for the command that is tested; a bar of -1 does not stand.
struct BarsConfig {
  int collisions = 0;
  double goals_share = -1;
  double refused_share = -1;
  double path_ratio_median = -1;
  double false_obstacles_20m = -1;  ///< within 20 m of the vehicle, a scan
  double shown_share = -1;          ///< of the runs of faults, those that show what their rows say
};

struct Suite {
  std::string name;  ///< of the file, without its ending
  SuiteConfig about;
  VariationConfig vary;
  BarsConfig bars;
  ClutterConfig clutter;
  std::vector<Baseline> baselines;
  VariantAxes axes;
  std::vector<SuiteVariant> variants;  ///< that the runs take in turn; none: the scene as it is
  std::vector<std::string> scenes;     ///< files: one, or one a row of the fault table
  std::uint64_t digest = 0;  ///< of the texts of suite, scenes and vehicles, and of the variants that are left
};

/// Bound to `suite`, which must outlive it.
Schema schema(Suite& suite);
/// Throws Error with line and column.
Suite load_suite(const std::filesystem::path& file);
/// Leaves the variants that have every part of `name`. Throws Error where none has.
void select_variants(Suite& suite, const std::string& name);

/// Names of the suites in the program.
std::vector<std::string> embedded_suites();
/// The file of a suite: one that lies there, or one of the program's own, which is laid out under `folder` with all
/// that it names. Throws Error for what is neither, listing the names.
std::filesystem::path find_suite(const std::string& name_or_file, const std::filesystem::path& folder);

/// Read once, by whoever makes runs of the suite.
std::vector<Scenario> load_scenes(const Suite& suite);

/// One run: the scene with all that was drawn, and its mission. A scene without mission points goes along its
/// way-points.
struct SuiteRun {
  std::uint64_t seed = 0;
  Scenario scenario;
  std::string variant;            ///< its name; empty in a suite without variants
  std::string conditions;         ///< what was drawn, in words
  const FaultRow* row = nullptr;  ///< that it is to show, in a suite of faults
};
/// `scenes`: those of the suite, at least one.
SuiteRun make_run(const Suite& suite, std::span<const Scenario> scenes, std::uint64_t seed);

}  // namespace isobath

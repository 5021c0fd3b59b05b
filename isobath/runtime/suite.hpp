// Suite: many runs of one scenario that differ by a seed: what varies, what is compared, and what must hold (ledger
// S6-67). A TOML file, strict as all of them; the ones of suites/ are also in the program, by name.
//
// A run is a function of the suite and its seed alone: run k of `runs` has the seed `seed` + k, so that any of them can
// be had again as the first of a suite of one. What is drawn: start, heading, current, drift of the navigation, level
// of the sonar's noise, the field of obstacles; each uniformly, in this order, each from a stream of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/runtime/scenario.hpp>
#include <isobath/sim/clutter.hpp>
#include <string>
#include <vector>

namespace isobath {

/// What a suite's runs are steered by, beside Isobath's own command: for comparison, on the same runs (ledger S6-62).
enum class Baseline : std::uint8_t { kNoAvoidance, kPotentialField, kImageThreshold, kAsPrinted };
const char* to_text(Baseline baseline);

struct SuiteConfig {
  std::string title = "a suite", text;
  std::string scene;
  int runs = 100;
  int seed = 1;
  double duration_s = 240;
  double goal_m = 6;          ///< the last mission point is reached this near, in truth
  double near_body_m = 4;     ///< a replan for an obstacle further than this from every body was for nothing
  double clearance_m = 3;     ///< that the planner with full truth keeps
  double planner_cell_m = 1;  ///< of the planner with full truth
};

/// Half widths of what is drawn about the scene's own value, and lowest and highest of factors.
struct VariationConfig {
  Eigen::Vector2d start = {0, 0};  ///< north, east, m
  Angle heading;
  double current = 0;                ///< largest, m/s; any direction
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
};

struct Suite {
  std::string name;  ///< of the file, without its ending
  SuiteConfig about;
  VariationConfig vary;
  BarsConfig bars;
  ClutterConfig clutter;
  std::vector<Baseline> baselines;
  std::uint64_t digest = 0;  ///< of the texts of suite, scene and vehicle
};

/// Bound to `suite`, which must outlive it.
Schema schema(Suite& suite);
/// Throws Error with line and column.
Suite load_suite(const std::filesystem::path& file);

/// Names of the suites in the program.
std::vector<std::string> embedded_suites();
/// The file of a suite: one that lies there, or one of the program's own, which is laid out under `folder` with all
/// that it names. Throws Error for what is neither, listing the names.
std::filesystem::path find_suite(const std::string& name_or_file, const std::filesystem::path& folder);

/// One run: the scene with all that was drawn, and its mission. A scene without mission points goes along its
/// way-points.
struct SuiteRun {
  std::uint64_t seed = 0;
  Scenario scenario;
  std::string conditions;  ///< what was drawn, in words
};
/// The suite's own scenario is read once, by whoever runs it.
SuiteRun make_run(const Suite& suite, const Scenario& scenario, std::uint64_t seed);

}  // namespace isobath

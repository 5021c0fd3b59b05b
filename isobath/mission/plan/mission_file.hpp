// Mission files: a MissionPlan as TOML, and the mission files of other programs (Ganesan 2015, 5.1; ledger S6-43,
// S6-58). docs/mission-format.md lists every key.
//
// Input is untrusted and reading is strict: every mistake is an Error with file, line and column. Points and the fence
// may be given in metres north and east of the origin, or in degrees where the mission has an origin. A mission may
// stand in one file with a scene: the two have no section in common. Then
//
//   MissionKeys keys;
//   Schema both = ...the scene's sections and lists, and those of schema(keys)...;
//   read_toml(text, file, both);
//   MissionPlan plan = make_plan(keys, both, scene.origin());
//   if (!plan.points.empty()) check_mission(plan);
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// A [[mission_point]] as the file gives it; latitude and longitude 0 mean that none is given.
struct PointKeys {
  MissionPoint point;
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;  ///< 0: the depth is used
};

/// An [[injected_map]]: one outline. Outlines with the same time make one map.
struct OutlineKeys {
  Place place;
  double at_s = 10;
  std::vector<double> outline;  ///< rows of north, east
};

/// A [[passage]].
struct PassageKeys {
  GroupPassage passage;
  std::vector<double> outline;  ///< rows of north, east
};

/// The content of a mission file, key by key.
struct MissionKeys {
  MissionPlan plan;  ///< title, speed, ends, limits
  double latitude_deg = 0;
  double longitude_deg = 0;
  std::vector<double> corners;      ///< of the fence: rows of north, east
  std::vector<double> corners_deg;  ///< or rows of latitude, longitude
  std::vector<PointKeys> points;
  std::vector<OutlineKeys> outlines;
  std::vector<RiskArea> risks;
  std::vector<TaskStep> steps;
  std::vector<PassageKeys> passages;
};

/// Bound to `keys`, which must outlive the schema.
Schema schema(MissionKeys& keys);
/// The plan that the keys describe, not checked yet. `read` is the schema that was read, alone or joined with others:
/// it contains the places of the sections. `origin` is used where the mission gives none. Throws Error where degrees
/// and metres are mixed, or where degrees are given without an origin or farther than 100 km from it.
MissionPlan make_plan(const MissionKeys& keys, const Schema& read, std::optional<GeoOrigin> origin = {});

/// Reads and checks a mission in TOML, a QGroundControl plan or a MOOS behaviour file, recognised by content. The
/// plan's `import` lists what the plan could not hold. Throws Error.
MissionPlan parse_mission(std::string_view text, const std::string& file);
/// The same from a file. LatOrigin and LongOrigin of a MOOS file may stand in a .moos file of the same name beside it.
MissionPlan load_mission(const std::string& file);
/// Whether a TOML text contains a mission, alone or among other sections.
bool looks_like_mission(std::string_view text);

/// TOML from which parse_mission reads the same plan again (places and `import` aside).
std::string write_mission(const MissionPlan& plan);

}  // namespace isobath

// Mission files: a MissionPlan as TOML, and the files of other programs that lead to one (Ganesan 2015, 5.1; ledger
// S6-43, S6-58). docs/mission-format.md lists every key.
//
// Input is untrusted and reading is strict: whatever is wrong is an Error with file, line and column. Points and the
// fence may be given in metres north and east of the origin, or in degrees where the mission has an origin. A mission
// may stand in one file with a scene: no section of one is a section of the other. Then
//
//   MissionKeys keys;
//   Schema both = ...the scene's sections and lists, and those of schema(keys)...;
//   read_toml(text, file, both);
//   MissionPlan plan = make_plan(keys, both, scene.origin());
//   if (!plan.points.empty()) check_mission(plan);
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/mission_plan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// A [[mission_point]] as the file says it; a latitude and longitude of 0 are none.
struct PointKeys {
  MissionPoint point;
  double latitude_deg = 0;
  double longitude_deg = 0;
  double altitude_m = 0;  ///< 0: go by depth
};

/// An [[injected_map]]: one outline. Those of one time make one map.
struct OutlineKeys {
  Place place;
  double at_s = 10;
  std::vector<double> outline;  ///< rows of north, east
};

/// All that a mission file says, key by key.
struct MissionKeys {
  MissionPlan plan;  ///< title, speed, ends, limits
  double latitude_deg = 0;
  double longitude_deg = 0;
  std::vector<double> corners;      ///< of the fence: rows of north, east
  std::vector<double> corners_deg;  ///< or rows of latitude, longitude
  std::vector<PointKeys> points;
  std::vector<OutlineKeys> outlines;
};

/// Bound to `keys`, which must outlive it.
Schema schema(MissionKeys& keys);
/// The plan that the keys stand for, not checked yet. `read` is the schema that was read, alone or joined with others:
/// it knows where sections stand. `origin` holds where the mission gives none. Throws Error where degrees and metres
/// are mixed, or degrees stand without an origin or further than 100 km from it.
MissionPlan make_plan(const MissionKeys& keys, const Schema& read, std::optional<GeoOrigin> origin = {});

/// A mission of its own in TOML, a QGroundControl plan or a MOOS behaviour file, recognised by content; checked. What
/// the plan could not take stands in its `import`. Throws Error.
MissionPlan parse_mission(std::string_view text, const std::string& file);
/// The same from a file; for a MOOS file, LatOrigin and LongOrigin may stand in a .moos file of the same name beside
/// it.
MissionPlan load_mission(const std::string& file);
/// Whether a TOML text holds a mission, alone or among other sections.
bool looks_like_mission(std::string_view text);

/// As TOML: parse_mission gives the same plan again (places and `import` aside).
std::string write_mission(const MissionPlan& plan);

}  // namespace isobath

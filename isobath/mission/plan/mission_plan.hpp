// MissionPlan: what the vehicle is to do: mission points in order, and limits that hold during the whole mission
// (Ganesan 2015, 5.1; ledger S6-43, S6-58, S6-65). The Navigator plans the way-points between the points.
//
// Frames: W, north and east in m, depth below the surface. Plain data; mission_file.hpp reads and checks it.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/error.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/mission/plan/priorities.hpp>
#include <isobath/mission/plan/search_area.hpp>
#include <isobath/mission/plan/task_steps.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct MissionPoint {
  Place place = {};  ///< in the file it comes from
  std::string name = {};
  Eigen::Vector2d north_east = Eigen::Vector2d::Zero();
  double depth_m = 1;                     ///< where no altitude is given
  std::optional<double> altitude_m = {};  ///< above the bottom, instead of a depth
  double speed = 0;                       ///< on the way to the point, m/s; 0: that of the mission
  double hold_s = 0;                      ///< how long to stay there
  double radius_m = 0;                    ///< within which the point counts as reached; 0: the Pilot's
  double drop_distance_m = 0;             ///< a nearer obstacle blocks the point; 0: the Navigator's
  double move_m = 0;                      ///< how far the Captain may move it off an obstacle; 0: it is dropped (S6-65)
  double deviation_m = 0;                 ///< most distance of the way to it from the straight line; 0: any (S2-15)
  std::string task = {};                  ///< of the mission (steps), or of a back-seat driver; empty: nothing
};

/// What the vehicle does when there is no further point.
enum class MissionEnd : std::uint8_t { kHold, kSurface, kReturn };
const char* to_text(MissionEnd end);

/// A map that a person made, given to the Navigator as if it had been seen (S6-58).
struct InjectedMap {
  Place place;
  double at_s = 10;               ///< after the start of the mission
  std::vector<Polygon> outlines;  ///< convex, in W
};

/// Narrow water that the vehicles of a group go through one at a time (S2-17).
struct GroupPassage {
  Place place = {};
  std::string name = {};
  Polygon outline = {};  ///< convex, in W
};

struct MissionLimits {
  double min_depth_m = 0;
  double max_depth_m = 100;
  double min_altitude_m = 1;
  double max_position_sigma_m = 30;  ///< of the estimated position; beyond it the mission is aborted
  double max_duration_s = 0;         ///< 0: none
  double low_battery_share = 0.15;
};

/// An item of a file that the plan does not contain, or not as it was given.
struct LeftOut {
  std::string what;  ///< "command 201 (DO_SET_ROI)"
  std::string why;
  std::size_t count = 1;
  bool operator==(const LeftOut&) const = default;
};

/// The result of importing a file of another program: no item is dropped silently.
struct ImportReport {
  std::string format;     ///< "QGroundControl plan"; empty: Isobath's own
  std::size_t taken = 0;  ///< items, points and settings that are in the plan
  std::vector<LeftOut> left_out;

  /// Adds to the entry with the same texts, if there is one.
  void leave_out(const std::string& what, const std::string& why);
  [[nodiscard]] std::size_t left_out_count() const;
  /// One line; empty for a file of Isobath's own.
  [[nodiscard]] std::string text() const;
};

struct MissionPlan {
  Place place;  ///< in the file it comes from
  std::string title;
  double speed = 1.5;  ///< m/s
  /// With a search area these are the stations of its lanes, and waiting places (search_area.hpp).
  std::vector<MissionPoint> points;
  SearchArea search;
  std::vector<GroupMember> group;  ///< the vehicles that share the search area; empty: there is no area
  std::size_t own = 0;             ///< which of them this vehicle is
  Polygon fence;                   ///< simple, any sense; empty: none
  Place fence_place;
  MissionLimits limits;
  MissionEnd at_end = MissionEnd::kHold;
  MissionEnd if_dropped = MissionEnd::kHold;  ///< what the vehicle does when the last point was dropped (S6-E21)
  bool waits_for_operator = false;  ///< starts at the operator's command; else as soon as it has looked around
  std::vector<InjectedMap> injected;
  std::vector<TaskStep> steps;         ///< of all tasks that the mission describes
  std::vector<GroupPassage> passages;  ///< at most kMaxPassages
  Priorities priorities;
  std::vector<RiskArea> risks;
  std::optional<GeoOrigin> origin;
  ImportReport import;
};

/// Checks what no single value shows. Throws Error with the place of the mistake: no points; a number that is not
/// finite or out of range; steps as check_steps; a passage that is not convex; a point outside the fence (S6-43),
/// beyond the depth limits or below the minimum altitude; a fence that is not a simple polygon; an injected outline
/// that is not convex.
void check_mission(const MissionPlan& plan);
/// The same mission on the plane of another origin: points, fence and injected outlines keep their places on the globe.
/// Nothing changes without an origin, or where both are within a metre of each other. Throws Error where they are more
/// than 100 km apart.
MissionPlan on_plane_of(MissionPlan plan, const GeoOrigin& origin);
/// The same check for one outline to inject.
void check_outline(const Polygon& outline, const Place& place);

inline constexpr double kMaxMetres = 1e5;  ///< maximum distance from the origin, along each axis
inline constexpr double kMaxSpeed = 10;    ///< m/s
inline constexpr std::size_t kMaxPassages = 15;
inline constexpr std::size_t kMaxFenceCorners = 1000;  ///< every place is checked against every side

/// Adds the waiting places of the vehicles of its group to a mission with a search area: in a row beyond each side to
/// which lanes lead, in the order of the vehicles' starts along the row. Vehicles that circle there keep a distance
/// from each other, and leave a way between them and the lanes.
void add_waiting_places(MissionPlan& plan);

}  // namespace isobath

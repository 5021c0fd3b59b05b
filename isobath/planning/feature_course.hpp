// FeatureCourse: a route along a linear feature: way-points that follow a ravine, a ridge or a pipeline at a distance
// (Oskard 1990, III-B; ledger S1-24, S1-F05).
//
// The pieces of a feature, in any order and sense, are chained into a line that starts near a point. The route lies
// `offset_m` to starboard of the line in the direction of travel (negative: to port). On the outside of a bend the
// joint is mitred, or round where the mitre would reach beyond `mitre_limit` offsets. On the inside of a bend tighter
// than the offset, the part of the route that would be nearer to the line than the offset is cut off. No point of the
// route is nearer to the line than the offset less `chord_m`, nor farther than `mitre_limit` offsets.
//
// Depth: constant, or an altitude above the shallowest known bottom in the corridor of each leg and of the next, so
// that the vehicle has climbed before it must, no steeper than `slope`. Over unknown bottom the route never lies below
// `unknown_depth_m`.
//
// Lateral tolerance: a REMUS-100 under LineOfSight (lookahead 8 m, acceptance 3 m) at 1.5 m/s stays within 0.5 m of the
// route along 20 segments of 25 m with bends of up to 20 degrees (tests/planning). Points (north, east) in W, m. Pure
// functions.
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/map/depth/depth_field.hpp>
#include <isobath/planning/corridor.hpp>
#include <isobath/vehicle/guidance.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

/// The line that the pieces (lines of two points or more) make, from its end nearer to `start`, built from the piece
/// nearest to `start`. Ends within `tolerance_m` of each other are joined; where several are, the straightest piece
/// continues the line. Pieces that do not connect are left out. Where both ends of the line meet, its last point is its
/// first: a ring. Cost: linear in the number of points.
std::vector<Eigen::Vector2d> chain_lines(std::span<const std::vector<Eigen::Vector2d>> pieces,
                                         const Eigen::Vector2d& start, double tolerance_m);

/// Distance of a point from a line of one point or more, m.
double distance_from_line(std::span<const Eigen::Vector2d> line, const Eigen::Vector2d& point);

/// The part of a line from its point nearest to `from` to its point nearest to `to`, in this sense; without `to`, to
/// the end that is farther along the line. On a ring (the last point is the first) the shorter of both ways; without
/// `to`, once around.
std::vector<Eigen::Vector2d> part_of_line(std::span<const Eigen::Vector2d> line, const Eigen::Vector2d& from,
                                          const std::optional<Eigen::Vector2d>& to);

/// The line with the points left out from which it deviates by at most `tolerance_m` (Douglas and Peucker 1973).
std::vector<Eigen::Vector2d> simplified(std::span<const Eigen::Vector2d> line, double tolerance_m);

/// The line moved to starboard; see above.
std::vector<Eigen::Vector2d> offset_line(std::span<const Eigen::Vector2d> line, double offset_m, double mitre_limit,
                                         double chord_m);

enum class DepthRule : std::uint8_t { kConstant, kAltitude };

struct FeatureCourseConfig {
  double offset_m = 0;
  double mitre_limit = 1.5;
  double chord_m = 0.25;
  double speed = 1.5;
  DepthRule rule = DepthRule::kConstant;
  double depth_m = 5;          ///< constant
  double altitude_m = 3;       ///< above the bottom
  double max_depth_m = 100;    ///< whatever the bottom
  double unknown_depth_m = 0;  ///< over unknown bottom
  double half_width_m = 2;     ///< of the corridor whose bottom counts
  double slope = 0.25;         ///< metres of climb per metre
  double leg_m = 20;           ///< longer legs are divided so that the depth follows the bottom
};

std::vector<Field> fields(FeatureCourseConfig& config);

enum class CourseRefusal : std::uint8_t { kNoFeature, kNotFinite, kTooLarge };
const char* to_text(CourseRefusal refusal);

/// `map` is used only by the altitude rule, and may be null otherwise.
Result<std::vector<Waypoint>, CourseRefusal> feature_course(std::span<const Eigen::Vector2d> line,
                                                            const FeatureCourseConfig& config, const DepthField* map);

}  // namespace isobath

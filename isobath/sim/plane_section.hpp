// PlaneSection: lines and arcs at one depth, met by rays in closed form; and a scanning sonar in them, one reading a
// beam (Auran, Silven 1995, 4.1; ledger S4-31 to S4-35, S4-52).
//
// It is the section of a scene's prisms at a depth: rows of lines and arcs, scaled about the middle of what they span.
// A scan at several depths is a scene in three dimensions as the paper makes it: right where walls are upright, and
// where they are not as long as a beam may be taken to be level (world.hpp traces rays in three dimensions, and water,
// echoes and receivers besides).
//
// Line: p + t u = a + s (b - a), 0 <= s <= 1. Circle: t = -(u.m) -+ sqrt((u.m)^2 - |m|^2 + radius^2), m = p - centre,
// within the arc's angles; the smallest t > 0. Exact to rounding. Plan coordinates are (north, east), m.
#pragma once

#include <Eigen/Core>
#include <isobath/base/random.hpp>
#include <isobath/sim/scene.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct SectionLine {
  Eigen::Vector2d a, b;
  int object = 0;
};
struct SectionArc {
  Eigen::Vector2d centre;
  double radius = 1;
  Angle first, sweep;  ///< clockwise from north; the sweep is above 0, up to a turn
  int object = 0;
};

struct SectionHit {
  double range = 0;
  Angle incidence;  ///< between the ray and the normal, 0 to 90 degrees
  int object = 0;   ///< index of the body in the scene
};

class PlaneSection {
 public:
  PlaneSection() = default;
  /// What the scene's prisms are at this depth; other bodies have no part in it.
  PlaneSection(const Scene& scene, double depth);

  void add(const SectionLine& line) { lines_.push_back(line); }
  void add(const SectionArc& arc) { arcs_.push_back(arc); }
  [[nodiscard]] const std::vector<SectionLine>& lines() const { return lines_; }
  [[nodiscard]] const std::vector<SectionArc>& arcs() const { return arcs_; }
  /// The nearest along the unit vector u.
  [[nodiscard]] std::optional<SectionHit> cast(const Eigen::Vector2d& p, const Eigen::Vector2d& u) const;

 private:
  std::vector<SectionLine> lines_;
  std::vector<SectionArc> arcs_;
};

struct SectionSonarConfig {
  int beams = 144;  ///< in a turn
  Angle beam_width = Angle::degrees(2.5);
  int rays = 11;  ///< a beam, side by side
  enum class Pick : std::uint8_t { kNearest, kStrongest } pick = Pick::kNearest;
  double range_m = 30;
  double sigma_m = 0.15, sigma_share = 0.003;  ///< of a range: the larger one (S4-E03)
  Angle sigma = Angle::degrees(2.5 / 2.355);   ///< of the direction that an echo comes from
  bool noise = true;
  double multiple_share = 0;  ///< of surfaces met within multiple_cone, those that are reported at twice their range
  Angle multiple_cone = Angle::degrees(15);
  double clutter_per_turn = 0;  ///< false echoes, anywhere in range; the nearest echo of a beam is what it reports
};
std::vector<Field> fields(SectionSonarConfig& config);

enum class SectionEcho : std::uint8_t { kDirect, kMultiple, kClutter };

struct SectionReading {
  Angle bearing;                  ///< clockwise from north: of the beam as it is reported
  std::optional<double> range_m;  ///< empty: nothing within the range
  SectionEcho is = SectionEcho::kDirect;
  SectionHit truth;  ///< of the ray that it is of; meaningless without a range
};

/// One turn from p, beams beginning at north. The strongest ray is the one that meets its wall most squarely, cos^2 of
/// the incidence over the fourth power of the range.
std::vector<SectionReading> scan(const PlaneSection& section, const Eigen::Vector2d& p,
                                 const SectionSonarConfig& config, Random& random);

/// Where a scan is made, numbered from 1 (S4-35).
struct ScanPosition {
  int number = 1;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< W
  Angle course;
};
/// `count` places, as far from one another along the way-points of a scene's vehicle, in depth the sine and the noise
/// of its dive; and the path between them.
struct ScanPath {
  std::vector<ScanPosition> scans;
  std::vector<Eigen::Vector3d> path;
};
ScanPath scan_path(const Scene& scene, int count, Random& random);

}  // namespace isobath

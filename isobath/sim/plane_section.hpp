// PlaneSection: lines and arcs at one depth with closed-form ray intersection, and a scanning sonar among them that
// gives one reading per beam (Auran, Silven 1995, 4.1; ledger S4-31 to S4-35, S4-52).
//
// It is the section of a scene's prisms at a depth: rows of lines and arcs, scaled about the centre of their extent.
// The paper builds its three-dimensional scenes from scans at several depths. This is exact for upright walls. For
// others it holds as long as a beam may be taken as level (world.hpp traces rays in three dimensions, with water,
// echoes and receivers).
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
  Angle first, sweep;  ///< clockwise from north; the sweep is above 0, up to a full turn
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
  /// The section of the scene's prisms at this depth; other bodies are ignored.
  PlaneSection(const Scene& scene, double depth);

  void add(const SectionLine& line) { lines_.push_back(line); }
  void add(const SectionArc& arc) { arcs_.push_back(arc); }
  [[nodiscard]] const std::vector<SectionLine>& lines() const { return lines_; }
  [[nodiscard]] const std::vector<SectionArc>& arcs() const { return arcs_; }
  /// The nearest hit along the unit vector u.
  [[nodiscard]] std::optional<SectionHit> cast(const Eigen::Vector2d& p, const Eigen::Vector2d& u) const;

 private:
  std::vector<SectionLine> lines_;
  std::vector<SectionArc> arcs_;
};

struct SectionSonarConfig {
  int beams = 144;                     ///< beams per turn, or of the sector
  Angle sector = Angle::degrees(360);  ///< that the beams share
  Angle middle;                        ///< bearing of the sector's middle; without meaning for a turn
  Angle beam_width = Angle::degrees(2.5);
  int rays = 11;  ///< rays per beam, side by side
  enum class Pick : std::uint8_t { kNearest, kStrongest } pick = Pick::kNearest;
  double range_m = 30;
  double sigma_m = 0.15, sigma_share = 0.003;  ///< standard deviation of a range: the larger one (S4-E03)
  Angle sigma = Angle::degrees(2.5 / 2.355);   ///< standard deviation of the direction of an echo
  bool noise = true;
  double multiple_share = 0;  ///< share of hits within multiple_cone that read twice their range
  Angle multiple_cone = Angle::degrees(15);
  double clutter_per_turn = 0;  ///< false echoes at random ranges; a beam reports its nearest echo
};
std::vector<Field> fields(SectionSonarConfig& config);

enum class SectionEcho : std::uint8_t { kDirect, kMultiple, kClutter };

struct SectionReading {
  Angle bearing;                  ///< reported bearing of the beam, clockwise from north
  std::optional<double> range_m;  ///< empty: no echo within the range
  SectionEcho is = SectionEcho::kDirect;
  SectionHit truth;  ///< hit of the chosen ray; meaningless without a range
};

/// One turn from p, whose first beam points north, or one sector, from port to starboard. The strongest ray has the
/// largest cos^2 of the incidence over the fourth power of the range.
std::vector<SectionReading> scan(const PlaneSection& section, const Eigen::Vector2d& p,
                                 const SectionSonarConfig& config, Random& random);

/// The position of a scan, numbered from 1 (S4-35).
struct ScanPosition {
  int number = 1;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< W
  Angle course;
};
/// `count` equally spaced positions along the way-points of a scene's vehicle, and the path between them. Their depth
/// has the sine and the noise of the vehicle's dive.
struct ScanPath {
  std::vector<ScanPosition> scans;
  std::vector<Eigen::Vector3d> path;
};
ScanPath scan_path(const Scene& scene, int count, Random& random);

}  // namespace isobath

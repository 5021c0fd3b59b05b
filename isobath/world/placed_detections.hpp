// PlacedDetections: what a moving fan has detected, placed in the plan by the poses of the vehicle; and how sharply it
// lies, which tests the poses and the mount of the sonar without any ground truth.
//
// A wall that the sonar sees from many places falls into few cells of the plan if the poses are right, and into many if
// they are not. `sharpness` counts the cells with a detection, and counts them again with all headings turned by an
// offset of -30 to 30 degrees. The offset with the fewest cells is the error of the heading or of the mount, which such
// a recording cannot tell apart: set it as input.mount_heading_deg. A wide or high minimum means poor positions. If the
// count is lower with port and starboard exchanged, the bearings have the wrong sign. Do not compare
// the counts of two recordings, or of two numbers of detections.
//
// Detections are the soundings of flat swaths (Swath::is_flat), and of a flat fan's ping the nearest echo of each beam.
// The offset turns the fan about the vehicle's reference point; a sonar far from it is turned along. The vehicle must
// travel: a fan that only turns at one place fills as many cells at any offset. PlacedDetections keeps at
// most kMax detections: of a longer recording those of each second or fourth scan, and so on.
//
// Plan coordinates are (north, east) of W, m. Deterministic. One thread. Cost of `sharpness` for 42,000 detections:
// 0.1 s.
#pragma once

#include <cstdint>
#include <functional>
#include <isobath/base/angle.hpp>
#include <isobath/world/result_sinks.hpp>
#include <optional>
#include <vector>

namespace isobath {

struct SharpnessPoint {
  Angle offset;  ///< of the heading, clockwise
  std::size_t cells = 0;
};

struct Sharpness {
  double cell_m = 0;
  std::size_t detections = 0, scans = 0;
  std::size_t cells = 0;              ///< with the headings as they are
  std::size_t mirrored = 0;           ///< with port and starboard exchanged
  std::vector<SharpnessPoint> curve;  ///< in order of offset
  Angle best;                         ///< offset with the fewest cells
  std::size_t best_cells = 0;
  Angle low, high;  ///< the offsets around `best` whose cells exceed `best_cells` by up to 1 %

  /// Whether the curve has a minimum worth the name: 10 % below its ends, and within it.
  [[nodiscard]] bool tells() const;
};

class PlacedDetections {
 public:
  static constexpr double kCell_m = 0.5;
  static constexpr std::size_t kMax = 200'000;

  void add(const Swath& swath, const Pose& X_WB);
  void add(const PosedPing& ping);

  /// The same detections at other poses; scans at a time without a pose are left out.
  [[nodiscard]] PlacedDetections placed_by(const std::function<std::optional<Pose>(Time)>& pose_at) const;

  /// Empty: fewer than 200 detections, or the vehicle stayed within 5 m.
  [[nodiscard]] std::optional<Sharpness> sharpness() const;

  /// North and east of the cell with this place, in cells from the origin of W.
  [[nodiscard]] static Eigen::Vector2i cell_of(const Eigen::Vector2d& p) {
    return (p / kCell_m).array().floor().cast<int>();
  }
  /// For tables of cells.
  [[nodiscard]] static std::uint64_t key_of(const Eigen::Vector2i& cell) {
    return std::uint64_t{static_cast<std::uint32_t>(cell.x())} << 32 |
           std::uint64_t{static_cast<std::uint32_t>(cell.y())};
  }
  struct FilledCell {
    Eigen::Vector2i index;  ///< cell_of
    int scans = 0;          ///< that have a detection in it
  };
  /// In order of index.
  [[nodiscard]] std::vector<FilledCell> filled_cells() const;

 private:
  struct Scan {
    Time time;
    Eigen::Vector2d place;
    Angle heading;
    std::vector<Eigen::Vector2f> points;  ///< forward and starboard of the vehicle, level
  };
  [[nodiscard]] bool wanted();
  void begin_scan(Time time, const Pose& X_WB);
  void end_scan();
  void add_point(const Eigen::Vector3d& p_B, const Pose& X_WB);
  [[nodiscard]] bool travelled() const;

  std::vector<Scan> scans_;
  std::size_t detections_ = 0;
  std::uint64_t offered_ = 0, every_ = 1;  ///< scans, and which of them are kept
};

}  // namespace isobath

// FieldOfView: what a sonar looks at, cut into cells (azimuth x elevation), one ray each, and how much of each
// direction its beams hear. Azimuths and elevations in S, rad.
#pragma once

#include <Eigen/Core>
#include <isobath/sim/beam_pattern.hpp>
#include <isobath/sim/sonar_config.hpp>
#include <vector>

namespace isobath {

/// A part of the field of view that one ray stands for.
struct ViewCell {
  Eigen::Vector3d u, across, up;  ///< in S: direction, and unit vectors towards larger azimuth and elevation
  double half_across, half_up;    ///< half its angular size, rad
  double solid_angle;
  double elevation;
  double gain;  ///< of the elevation pattern
};

ViewCell cell_of(double azimuth, double d_azimuth, double low, double high, const BeamPattern& pattern);

class FieldOfView {
 public:
  explicit FieldOfView(const SonarConfig& config);

  /// The cells of a direction, from the lowest.
  [[nodiscard]] const ViewCell* column(int direction) const {
    return cells.data() + static_cast<std::size_t>(direction) * (edges.size() - 1);
  }
  [[nodiscard]] int cells_a_column() const { return static_cast<int>(edges.size()) - 1; }

  BeamPattern across, height;           ///< two-way, in azimuth and in elevation
  std::vector<double> beams;            ///< azimuths of the axes
  std::vector<double> directions;       ///< azimuth of each column of cells
  std::vector<double> edges;            ///< of elevation
  std::vector<ViewCell> cells;          ///< direction by direction
  double hearing = 0;                   ///< angle beyond which a beam hears next to nothing
  double cell_across = 0, cell_up = 0;  ///< size in the middle of the field of view
  struct Weight {
    int direction;
    float gain;
  };
  std::vector<std::vector<Weight>> weights;  ///< of each beam: what it hears of the directions

 private:
  void cut_heights(const SonarConfig& config);
  void add_direction(double azimuth, double width);
  void cut_fan(const SonarConfig& config, double spacing);
  void cut_single(const SonarConfig& config);
  void weigh();
};

}  // namespace isobath

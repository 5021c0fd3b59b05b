// FieldOfView: the field of view of a sonar, divided into cells (azimuth x elevation) of one ray each, and the weight
// of each direction in each beam. Azimuths and elevations in S, rad.
#pragma once

#include <Eigen/Core>
#include <isobath/sim/beam_pattern.hpp>
#include <isobath/sim/sonar_config.hpp>
#include <vector>

namespace isobath {

/// A part of the field of view that one ray represents.
struct ViewCell {
  Eigen::Vector3d u, across, up;  ///< in S: direction, and unit vectors towards larger azimuth and elevation
  double half_across, half_up;    ///< half its angular size, rad
  double solid_angle;
  double elevation;
  double gain;  ///< gain of the elevation pattern
};

ViewCell cell_of(double azimuth, double d_azimuth, double low, double high, const BeamPattern& pattern);

class FieldOfView {
 public:
  explicit FieldOfView(const SonarConfig& config);

  /// The cells of a direction, lowest first.
  [[nodiscard]] const ViewCell* column(int direction) const {
    return cells.data() + static_cast<std::size_t>(direction) * (edges.size() - 1);
  }
  [[nodiscard]] int cells_a_column() const { return static_cast<int>(edges.size()) - 1; }

  BeamPattern across, height;           ///< two-way, in azimuth and in elevation
  std::vector<double> beams;            ///< azimuths of the beam axes
  std::vector<double> directions;       ///< azimuth of each column of cells
  std::vector<double> edges;            ///< elevations of the edges of cells
  std::vector<ViewCell> cells;          ///< direction by direction
  double hearing = 0;                   ///< off-axis angle beyond which the gain of a beam is negligible
  double cell_across = 0, cell_up = 0;  ///< angular size in the middle of the field of view
  struct Weight {
    int direction;
    float gain;
  };
  std::vector<std::vector<Weight>> weights;  ///< by beam: its directions and their gains

 private:
  void cut_heights(const SonarConfig& config);
  void add_direction(double azimuth, double width);
  void cut_fan(const SonarConfig& config, double spacing);
  void cut_single(const SonarConfig& config);
  void weigh();
};

}  // namespace isobath

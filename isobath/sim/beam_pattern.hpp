// BeamPattern: what a beam hears of an echo that does not come along its axis.
//
// The two-way intensity pattern of a tapered line array: (sin z / z)^(2p), where p lowers the first side lobe from the
// -13.3 dB of an untapered array (p = 1) to the level asked for, and z is scaled so that the pattern is -3 dB at half
// the stated width. `ideal` is a top hat (S5-05), `gaussian` has no side lobes. Urick 1983, 3.6; widths as a sonar's
// data sheet states them: full, at -3 dB.
#pragma once

#include <cstdint>
#include <isobath/base/angle.hpp>
#include <vector>

namespace isobath {

enum class PatternKind : std::uint8_t { kLine, kGaussian, kIdeal };

class BeamPattern {
 public:
  /// `side_lobe_db`: level of the first side lobe below the axis, 13.3 to 60 dB, two-way; of a line alone.
  BeamPattern(PatternKind kind, Angle width, double side_lobe_db);

  /// Two-way intensity, 1 on the axis; off_axis in radians, any sign.
  [[nodiscard]] double gain(double off_axis) const;
  /// The largest gain at this angle or beyond.
  [[nodiscard]] double envelope(double off_axis) const;
  /// Beyond it the gain stays below `level` (intensity); pi where it never does.
  [[nodiscard]] double reach(double level) const;

 private:
  [[nodiscard]] double line(double off_axis) const;
  PatternKind kind_;
  double half_width_;
  double power_ = 1;
  double scale_ = 1;             ///< z of one radian, near the axis
  std::vector<float> envelope_;  ///< by off-axis angle
  std::vector<float> table_;     ///< gain by off-axis angle
};

}  // namespace isobath

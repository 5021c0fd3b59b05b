// BeamPattern: the gain of a beam for an echo that arrives off its axis.
//
// The two-way intensity pattern of a tapered line array is (sin z / z)^(2p). The exponent p lowers the first side lobe
// from the -13.3 dB of an untapered array (p = 1) to the requested level; z is scaled so that the pattern is -3 dB at
// half the stated width. `piston` is a circular transducer that transmits and receives, (2 J1(z) / z)^4: its first side
// lobe is 35 dB down. `ideal` is a top hat (S5-05), `gaussian` has no side lobes. Source: Urick 1983, 3.6. Widths are
// full widths at -3 dB, as on a sonar's data sheet.
#pragma once

#include <cstdint>
#include <isobath/base/angle.hpp>
#include <vector>

namespace isobath {

enum class PatternKind : std::uint8_t { kLine, kPiston, kGaussian, kIdeal };

class BeamPattern {
 public:
  /// `side_lobe_db`: level of the first side lobe below the axis, 13.3 to 60 dB, two-way; only kLine uses it.
  BeamPattern(PatternKind kind, Angle width, double side_lobe_db);

  /// Two-way intensity, 1 on the axis. `off_axis` is in radians and has any sign.
  [[nodiscard]] double gain(double off_axis) const;
  /// The largest gain at this angle or beyond.
  [[nodiscard]] double envelope(double off_axis) const;
  /// The angle (rad) beyond which the gain stays below `level` (intensity); pi if there is none.
  [[nodiscard]] double reach(double level) const;

 private:
  [[nodiscard]] double aperture_gain(double z) const;
  /// The z within the main lobe where the aperture's gain is one half.
  [[nodiscard]] double half_power_point() const;
  /// What the table holds.
  [[nodiscard]] double exact_gain(double off_axis) const;
  PatternKind kind_;
  double half_width_;
  double power_ = 1;
  double scale_ = 1;             ///< z of one radian, near the axis
  std::vector<float> envelope_;  ///< by off-axis angle
  std::vector<float> table_;     ///< gain by off-axis angle
};

}  // namespace isobath

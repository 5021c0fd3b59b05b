// ScanCommand: settings of a sonar from its next ping on (Auran, Silven 1995, 3.2 and figure 2; ledger S4-40): the
// plane of the scan, its sector and step, range and beams, for a multibeam or a scanning sonar.
//
// Empty settings stay unchanged. A scanning head starts its new sector at its first end. Angles are those of the sensor
// in B: `heading` turns the middle of the sector to starboard, `pitch` raises the plane, `roll` turns it to the
// vertical.
#pragma once

#include <isobath/base/angle.hpp>
#include <optional>

namespace isobath {

struct ScanCommand {
  bool as_configured = false;  ///< go back to the settings of the start first
  std::optional<Angle> heading = {}, pitch = {}, roll = {};
  std::optional<Angle> middle = {};    ///< azimuth of the middle of a scanning head's sector, in S
  std::optional<Angle> sector = {};    ///< swept sector, or from the first beam of a fan to its last
  std::optional<Angle> step = {};      ///< step of a scanning head
  std::optional<Angle> width = {};     ///< width of a beam
  std::optional<double> range_m = {};  ///< with the same number of samples
  std::optional<int> beams = {};       ///< number of beams of a fan
};

}  // namespace isobath

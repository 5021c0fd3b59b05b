// ScanCommand: how a sonar shall look from its next ping on (Auran, Silven 1995, 3.2 and figure 2; ledger S4-40): the
// plane of the scan, its sector and step, range and beams, of a multibeam sonar or of one that sweeps.
//
// What is empty stays as it is. A head that sweeps begins its new sector at its first end. Angles are of the sensor in
// B: `heading` to starboard turns the middle of the sector, `pitch` raises the plane, `roll` stands it up.
#pragma once

#include <isobath/base/angle.hpp>
#include <optional>

namespace isobath {

struct ScanCommand {
  std::optional<Angle> heading = {}, pitch = {}, roll = {};
  std::optional<Angle> sector = {};    ///< swept, or from the first beam of a fan to its last
  std::optional<Angle> step = {};      ///< of a head that sweeps
  std::optional<Angle> width = {};     ///< of a beam
  std::optional<double> range_m = {};  ///< with as many samples as before
  std::optional<int> beams = {};       ///< of a fan
};

}  // namespace isobath

// The quality of chart data in S-57 (IHO, edition 3.1, object catalogue): names of vertical datums (VERDAT) and zones
// of confidence (CATZOC). A zone states that 95 % of depths are within a m + b of the depth: sigma is half of that.
// Internal to the readers of priors.
#pragma once

#include <array>
#include <cmath>

namespace isobath {

/// Name of a vertical datum; empty for an unknown code.
const char* datum_of_code(int code);

struct ConfidenceZone {
  double fixed, share;  ///< metres and share of the depth, 95 %
  [[nodiscard]] double sigma(double depth) const { return 0.5 * (fixed + share * std::abs(depth)); }
};
/// Zones A1, A2, B, C, D; U is like D.
inline constexpr std::array<ConfidenceZone, 6> kConfidenceZones = {
    {{0.5, 0.01}, {1, 0.02}, {1, 0.02}, {2, 0.05}, {4, 0.1}, {4, 0.1}}};
/// The zone to assume without zones, by scale: harbours are surveyed better than oceans.
const ConfidenceZone& zone_of_scale(double scale);

}  // namespace isobath

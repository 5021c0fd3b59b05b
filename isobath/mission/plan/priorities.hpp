// Priorities: what a way costs, beside time (Herman 1988, 3.1; ledger S2-14, S2-23, S2-E09).
//
//   J = time T + energy E - stealth ln P(not detected) - survival ln P(not destroyed)
//
// in seconds, with T in s and E in kJ. P by the risk areas that the way crosses: the rate of each falls linearly from
// its centre to nothing at its radius, and ln P = - integral of the rate over time. At one speed, time and energy
// weigh every metre alike; a metre in a risk area counts more.
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <span>
#include <string>
#include <vector>

namespace isobath {

struct Priorities {
  double time = 1;      ///< s per s
  double energy = 0;    ///< s per kJ
  double stealth = 0;   ///< s per unit of -ln P(not detected)
  double survival = 0;  ///< s per unit of -ln P(not destroyed)
  double power_w = 0;   ///< that the vehicle draws under way
  bool operator==(const Priorities&) const = default;
};
std::vector<Field> fields(Priorities& priorities);

/// A circle in which the vehicle may be detected or destroyed.
struct RiskArea {
  enum class Kind : std::uint8_t { kDetection, kDestruction };
  Place place = {};
  Kind kind = Kind::kDetection;
  Eigen::Vector2d centre_W = Eigen::Vector2d::Zero();
  double radius_m = 50;
  double per_minute = 1;  ///< rate at the centre
};
std::vector<Field> fields(RiskArea& area);

struct WayCost {
  double time_s = 0, energy_kj = 0;
  double detected = 0, destroyed = 0;  ///< probabilities
  double total_s = 0;                  ///< J
};
/// The cost of legs through these places (north, east) at one speed, m/s; sampled every 0.5 m (cone_integral).
WayCost cost_of_way(std::span<const Eigen::Vector2d> way_W, double speed, const Priorities& priorities,
                    std::span<const RiskArea> areas);
/// "cost 215 s: 100 s, detected with 12 %".
std::string to_text(const WayCost& cost);

/// By how much a metre at the centre of the area costs more than one outside, as a share of that.
double extra_cost(const RiskArea& area, const Priorities& priorities);

}  // namespace isobath

// Faults: the faults of a simulated vehicle and their times (design: a test injects every fault of the Safety Officer's
// table). fault_config.hpp states the kinds of faults, faulty_channel.hpp applies those of a source to its readings.
//
// Several faults may be active at once; they act in the order of the list. Leak, battery, thruster_loss and clock_jump
// change no reading: `vehicle_faults` states them and the simulator applies them. The simulated host (agents, planner,
// link) applies the faults of its parts as `active` states them. Errors: the constructor throws Error (tier 2) with
// file, line and column for an unknown source, a kind that its source cannot have, or an invalid amount; nothing throws
// after construction. One thread. Times are on the caller's clock; random numbers come from the seed and the position
// in the list.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <isobath/base/time.hpp>
#include <isobath/sim/fault_config.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace isobath {

/// The active faults that concern no reading, at one instant.
struct VehicleFaults {
  static constexpr int kMaxThrusters = FaultConfig::kMaxThrusters;

  bool leak = false;
  double battery_lost = 0;  ///< share of a full charge that faults have drained so far; it never decreases
  std::array<double, kMaxThrusters> thrust_share{};  ///< remaining share of each thruster's thrust, 0..1
  Duration clock_offset{};                           ///< the vehicle's clock minus the true one
};

class FaultSchedule {
 public:
  /// Throws Error. `start`: the time at which `at_s` is 0.
  FaultSchedule(std::vector<FaultConfig> faults, std::uint64_t seed, Time start = {});

  /// Reports an event: faults that wait for it begin. Only the first report of an event counts.
  void raise(std::string_view event, Time now);
  /// The first active fault of the source; null: none.
  [[nodiscard]] const FaultConfig* active(std::string_view source, Time now) const;
  [[nodiscard]] VehicleFaults vehicle_faults(Time now) const;

  [[nodiscard]] const std::vector<FaultConfig>& faults() const { return faults_; }
  /// The start time of fault i; empty: not active.
  [[nodiscard]] std::optional<Time> active_since(std::size_t i, Time now) const;
  [[nodiscard]] std::uint64_t seed() const { return seed_; }

 private:
  std::vector<FaultConfig> faults_;
  std::vector<std::optional<Time>> begin_;
  std::uint64_t seed_;
};

}  // namespace isobath

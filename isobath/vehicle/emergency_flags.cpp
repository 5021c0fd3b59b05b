#include <bit>
#include <isobath/base/error.hpp>
#include <isobath/vehicle/emergency_flags.hpp>

namespace isobath {

const char* name_of_emergency(int bit_index) {
  switch (static_cast<Emergency>(bit_index)) {
    case Emergency::kLowFuel: return "low fuel";
    case Emergency::kLeak: return "leak";
    case Emergency::kSensorFailure: return "sensor failure";
    case Emergency::kImminentCollision: return "imminent collision";
    case Emergency::kModuleFailure: return "module failure";
  }
  return nullptr;
}

// Stores the time before the bit, so that a thread that sees the bit sees its time.
void EmergencyFlags::set(std::uint32_t bits, Time time) {
  for (std::uint32_t rest = bits; rest != 0; rest &= rest - 1) {
    std::int64_t never = kNever;
    first_[static_cast<std::size_t>(std::countr_zero(rest))].compare_exchange_strong(
        never, time.time_since_epoch().count(), std::memory_order_relaxed);
  }
  const std::uint64_t before = state_.fetch_or(bits | std::uint64_t{bits & latching_} << 32, std::memory_order_acq_rel);
  const std::uint32_t begun = bits & ~static_cast<std::uint32_t>(before);
  if (begun != 0) unacknowledged_.fetch_or(begun, std::memory_order_acq_rel);
}

void EmergencyFlags::acknowledge(std::uint32_t bits) {
  state_.fetch_and(~(std::uint64_t{bits} << 32), std::memory_order_acq_rel);
  unacknowledged_.fetch_and(~bits, std::memory_order_acq_rel);
}

EmergencyFlags::Snapshot EmergencyFlags::snapshot() const {
  const std::uint64_t state = state_.load(std::memory_order_acquire);
  const auto causes = static_cast<std::uint32_t>(state);
  return {causes | static_cast<std::uint32_t>(state >> 32), causes, unacknowledged_.load(std::memory_order_acquire)};
}

std::optional<Time> EmergencyFlags::first_raise(int bit_index) const {
  ISOBATH_ASSERT(bit_index >= 0 && bit_index < 32);
  const std::int64_t time = first_[static_cast<std::size_t>(bit_index)].load(std::memory_order_acquire);
  if (time == kNever) return std::nullopt;
  return Time(Duration(time));
}

}  // namespace isobath

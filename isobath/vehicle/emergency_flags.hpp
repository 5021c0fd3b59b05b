// EmergencyFlags: 32 bits for emergencies that must not wait (Oskard 1990, III-D; ledger S1-43). The thread that senses
// an emergency first raises its bit; executing threads watch the bits.
//
// A bit is raised while its cause lasts. A latching bit then stays raised until it is acknowledged, and after that
// while its cause lasts. Any bit is unacknowledged from each beginning of its cause until somebody acknowledges it, so
// that an emergency that was over before a person looked is still shown. Bits without a name are kept like the others.
// The time of a bit's first raise is that of its first cause since construction; later changes do not affect it.
//
// Any number of threads; every function is lock-free, never waits and allocates nothing. A watcher that sees a bit also
// sees its time. If two threads raise one bit for the first time, one of both times is kept.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <isobath/base/time.hpp>
#include <limits>
#include <optional>

namespace isobath {

enum class Emergency : std::uint8_t {
  kLowFuel = 0,
  kLeak = 1,
  kSensorFailure = 2,
  kImminentCollision = 3,
  kModuleFailure = 4,
};

constexpr std::uint32_t bit(Emergency e) { return 1U << static_cast<unsigned>(e); }
/// "leak"; null for a bit without a name.
const char* name_of_emergency(int bit_index);

class EmergencyFlags {
 public:
  /// Bits that must not depend on a person seeing them at the moment: a leak stays known after its cause has cleared.
  static constexpr std::uint32_t kLatching = bit(Emergency::kLeak);

  explicit EmergencyFlags(std::uint32_t latching = kLatching) : latching_(latching) {
    for (auto& time : first_) time.store(kNever, std::memory_order_relaxed);
  }

  void set(std::uint32_t bits, Time time);
  /// The cause is gone.
  void clear(std::uint32_t bits) { state_.fetch_and(~std::uint64_t{bits}, std::memory_order_acq_rel); }
  void set(Emergency e, Time time) { set(bit(e), time); }
  void clear(Emergency e) { clear(bit(e)); }
  /// A person has seen them.
  void acknowledge(std::uint32_t bits);

  struct Snapshot {
    std::uint32_t raised = 0;  ///< cause lasts, or latched
    std::uint32_t causes = 0;  ///< cause lasts
    std::uint32_t unacknowledged = 0;
    [[nodiscard]] bool has(Emergency e) const { return (raised & bit(e)) != 0; }
    bool operator==(const Snapshot&) const = default;
  };
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] std::optional<Time> first_raise(int bit_index) const;
  [[nodiscard]] std::optional<Time> first_raise(Emergency e) const { return first_raise(static_cast<int>(e)); }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free);

  std::atomic<std::uint64_t> state_ = 0;  ///< low half: causes; high half: latched
  std::atomic<std::uint32_t> unacknowledged_ = 0;
  const std::uint32_t latching_;
  std::array<std::atomic<std::int64_t>, 32> first_;
};

}  // namespace isobath

// EmergencyFlags: 32 bits for what must not wait (Oskard 1990, III-D; ledger S1-43). Raised by whatever senses first,
// watched by whatever executes, from different threads.
//
// A bit is up while its cause lasts; a latching bit stays up from then on until it is acknowledged, and after that
// while its cause lasts. Bits without a name are kept like the others. The time of a bit's first raise is that of its
// first cause since the register was made, whatever became of it since.
//
// Any number of threads; every function is lock-free, waits for nobody and allocates nothing. A watcher that sees a
// bit also sees its time. Where two threads raise one bit for the first time, one of both times is kept.
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
  /// What no person should have to catch in the moment: water inside stays known when the float swims up again.
  static constexpr std::uint32_t kLatching = bit(Emergency::kLeak);

  explicit EmergencyFlags(std::uint32_t latching = kLatching) : latching_(latching) {
    for (auto& time : first_) time.store(kNever, std::memory_order_relaxed);
  }

  void set(std::uint32_t bits, Time time);
  /// The cause is gone.
  void clear(std::uint32_t bits) { state_.fetch_and(~std::uint64_t{bits}, std::memory_order_acq_rel); }
  void set(Emergency e, Time time) { set(bit(e), time); }
  void clear(Emergency e) { clear(bit(e)); }
  /// These bits, too, stay from now on until acknowledged.
  void latch(std::uint32_t bits);
  void acknowledge(std::uint32_t bits) { state_.fetch_and(~(std::uint64_t{bits} << 32), std::memory_order_acq_rel); }

  struct Snapshot {
    std::uint32_t raised = 0;  ///< lasting or latched
    std::uint32_t causes = 0;  ///< lasting
    [[nodiscard]] bool has(Emergency e) const { return (raised & bit(e)) != 0; }
    bool operator==(const Snapshot&) const = default;
  };
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] std::optional<Time> first_raise(int bit_index) const;
  [[nodiscard]] std::optional<Time> first_raise(Emergency e) const { return first_raise(static_cast<int>(e)); }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free);

  std::atomic<std::uint64_t> state_ = 0;  ///< causes below, latched above
  std::atomic<std::uint32_t> latching_;
  std::array<std::atomic<std::int64_t>, 32> first_;
};

}  // namespace isobath

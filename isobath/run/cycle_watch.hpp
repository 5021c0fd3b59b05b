// CycleWatch: by how much the cycle of the executors departs from its interval in a live run (Herman 1988, 5; ledger
// S2-12, S2-39). It measures with a real clock when the orders of the Pilot come; any thread may call it.
#pragma once

#include <chrono>
#include <cmath>
#include <isobath/mission/command/executor.hpp>
#include <isobath/onboard/latency_histogram.hpp>
#include <mutex>
#include <optional>

namespace isobath {

inline constexpr Duration kExecutorCycle = std::chrono::milliseconds(600);

class CycleWatch {
 public:
  /// `speed` of the live run, a multiple of real time.
  explicit CycleWatch(double speed) : interval_ms_(1e3 * to_seconds(kExecutorCycle) / speed) {}

  /// The Pilot has given an order, as it does at each tick.
  void note() {
    const auto now = std::chrono::steady_clock::now();
    const std::lock_guard lock(mutex_);
    constexpr auto kTicks = static_cast<std::uint64_t>(kExecutorCycle / kTick);
    if (++orders_ % kTicks != 0) return;
    if (last_) {
      const double lasted_ms = std::chrono::duration<double, std::milli>(now - *last_).count();
      departures_.add(std::abs(lasted_ms - interval_ms_));
    }
    last_ = now;
  }
  [[nodiscard]] StageTime departures() const {
    const std::lock_guard lock(mutex_);
    return departures_.time();
  }

 private:
  const double interval_ms_;
  mutable std::mutex mutex_;
  std::uint64_t orders_ = 0;
  std::optional<std::chrono::steady_clock::time_point> last_;
  LatencyHistogram departures_;
};

}  // namespace isobath

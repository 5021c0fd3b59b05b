// MissionInForce: the mission that the vehicle has: the one with which the run began, until the operator replaces it.
// Any thread.
#pragma once

#include <isobath/mission/command/bus.hpp>
#include <memory>
#include <mutex>

namespace isobath {

class MissionInForce {
 public:
  struct Given {
    std::shared_ptr<const MissionPlan> plan = nullptr;
    std::uint32_t number = 0;  ///< grows with each mission that replaces another
  };

  void begin(const MissionPlan& plan) {
    const std::lock_guard lock(mutex_);
    given_ = {std::make_shared<const MissionPlan>(plan), 0};
  }
  void on_message(const Envelope& envelope) {
    const auto* order = std::get_if<MissionOrder>(&envelope.message);
    if (!order || !order->replaces || !order->plan) return;
    const std::lock_guard lock(mutex_);
    given_ = {order->plan, given_.number + 1};
  }
  [[nodiscard]] Given given() const {
    const std::lock_guard lock(mutex_);
    return given_;
  }

 private:
  mutable std::mutex mutex_;
  Given given_;
};

}  // namespace isobath

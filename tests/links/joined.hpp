// A vehicle of stand-ins and the links that hear it, in one process, over real sockets.
#pragma once

#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <functional>
#include <initializer_list>
#include <isobath/links/vehicle_links.hpp>
#include <isobath/standin/stand_ins.hpp>
#include <optional>
#include <string>
#include <tests/support/data.hpp>
#include <thread>

namespace isobath::test {

/// The stand-ins of the scene, stepped by a thread of their own, and the vehicle that hears them.
class Joined {
 public:
  static constexpr double kSpeed = 5;  ///< times real time

  /// `devices`: [[device]] of the vehicle file, where @KIND is the port of the stand-in of this kind.
  Joined(StandInRequest request, const std::string& devices, const std::string& scene = "scenarios/aboard.toml") {
    request.speed = kSpeed;
    request.stays = true;
    const bool moos = request.front_seat == FrontSeatKind::kMoos;
    request.autopilot = moos ? "tcp-server:0" : "udp-server:0";
    stand_ins_.emplace(open_scenario(source_folder() / scene), request);
    std::string text =
        fmt::format("[autopilot]\nlink = \"{}:127.0.0.1:{}\"\n", moos ? "tcp" : "udp", stand_ins_->autopilot_port()) +
        devices;
    for (const auto& device : stand_ins_->devices()) {
      const std::string key = std::string("@") + to_text(device->kind());
      if (const auto at = text.find(key); at != std::string::npos)
        text.replace(at, key.size(), std::to_string(device->port()));
    }
    vehicle_.emplace(parse_vehicle_file(text, "vehicle.toml"), kSpeed);
    vehicle_->start();
    sails_ = std::thread([this] {
      while (!ended_ && stand_ins_->step()) continue;
    });
  }
  ~Joined() {
    ended_ = true;
    sails_.join();
  }
  static StandInRequest with(std::initializer_list<StandInRequest::Device> devices) {
    StandInRequest request;
    request.devices = devices;
    return request;
  }
  /// Takes events until this holds, at most 20 s of the clock.
  bool until(const std::function<bool(const Event&)>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      const auto event = vehicle_->source().next();
      if (event && holds(*event)) return true;
    }
    return false;
  }
  VehicleLinks& vehicle() { return *vehicle_; }
  StandIns& stand_ins() { return *stand_ins_; }

 private:
  std::optional<StandIns> stand_ins_;
  std::optional<VehicleLinks> vehicle_;
  std::atomic<bool> ended_{false};
  std::thread sails_;
};

}  // namespace isobath::test

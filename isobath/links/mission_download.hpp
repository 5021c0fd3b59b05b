// MissionDownload: fetches mission, fence and rally points from an autopilot by MAVLink's mission protocol, one list
// after the other (mavlink.io, mission protocol), and writes them as a QGroundControl plan, which `--mission` reads.
//
// A request without an answer is repeated after 0.7 s, at most kMostTries times; then `problem` says so. At most
// kMostItems items a list: more are refused. Feed it every frame of the autopilot and every tick.
#pragma once

#include <functional>
#include <isobath/base/time.hpp>
#include <isobath/io/formats/mavlink/mavlink_messages.hpp>
#include <string>
#include <vector>

namespace isobath {

struct AutopilotPlan {
  std::vector<mavlink::MissionItem> mission;  ///< the first item is the home of an ArduPilot vehicle
  std::vector<mavlink::MissionItem> fence, rally;
};
/// A plan file of QGroundControl with these items.
std::string qground_text(const AutopilotPlan& plan);

class MissionDownload {
 public:
  static constexpr int kMostTries = 8;
  static constexpr std::uint16_t kMostItems = 2000;
  using Send = std::function<void(std::uint32_t id, const mavlink::PayloadBytes& body)>;

  /// `system`, `component`: of the autopilot. `send` must outlive it.
  MissionDownload(std::uint8_t system, std::uint8_t component, Send send);

  void on_frame(const MavlinkFrame& frame, Time now);
  void on_tick(Time now);
  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] const std::string& problem() const { return problem_; }  ///< empty: none
  [[nodiscard]] const AutopilotPlan& plan() const { return plan_; }

 private:
  void ask(Time now);
  void next_list(Time now);
  [[nodiscard]] std::vector<mavlink::MissionItem>& items();

  std::uint8_t system_, component_;
  Send send_;
  AutopilotPlan plan_;
  mavlink::MissionKind kind_ = mavlink::MissionKind::kMission;
  std::optional<std::uint16_t> count_;
  Time asked_{};
  int tries_ = 0;
  bool done_ = false;
  std::string problem_;
};

}  // namespace isobath

// EventGate: the first stage of the pipeline. It admits events that are finite, in order and fresh, and counts every
// rejection by its reason (design, section 3). Each stream (pings, navigation, ranges, swaths, passive
// bearings) is ordered on its own.
//
// The gate distinguishes a clock that was set back from a single stray stamp: after `restart_after` rejections in a row
// that are in order among themselves, it starts anew from there and reports it once (kRestarted), so that maps can
// start afresh.
//
// A fix that lies farther from the last one than any vehicle moves in the time between is a jump of the position. The
// gate rejects it, and accepts the jump only after `accept_jump_after` fixes in a row that agree among themselves.
// Readings taken meanwhile have no fresh pose, and so put nothing in a wrong place of the map.
#pragma once

#include <array>
#include <isobath/base/config.hpp>
#include <isobath/event/event.hpp>
#include <map>
#include <string>

namespace isobath {

struct EventGateConfig {
  double max_age_s = 2;     ///< behind the newest event of any stream
  int restart_after = 20;   ///< events in a row that are late but in order among themselves
  double max_speed = 30;    ///< m/s, fastest that the vehicle moves between two fixes
  double max_jump_m = 100;  ///< largest correction by navigation that is no jump
  int accept_jump_after = 5;
};
std::vector<Field> fields(EventGateConfig& config);

class EventGate {
 public:
  explicit EventGate(const EventGateConfig& config) : config_(config) {}

  enum class Verdict : std::uint8_t { kAdmitted, kRejected, kRestarted };
  Verdict judge(const Event& event);

  /// Reason -> count. Reasons are fixed texts.
  [[nodiscard]] const std::map<std::string, std::uint64_t>& rejected() const { return rejected_; }
  void count(const char* reason) { ++rejected_[reason]; }

  static constexpr const char* kBackwards = "time runs backwards";
  static constexpr const char* kTooOld = "older than the limit";
  static constexpr const char* kLeap = "position leaps farther than any vehicle moves";
  static constexpr const char* kBadNavigation = "navigation not finite";
  static constexpr const char* kBadRange = "range not finite";
  static constexpr const char* kBadBearing = "passive bearing not possible";
  static constexpr const char* kBadHealth = "health report whose charge is no share";

 private:
  struct Stream {
    Time newest = Time::min();
    Time late_newest = Time::min();  ///< of the current row of rejections
    int late_in_order = 0;
  };
  const char* order_fault(Stream& stream, Time time);
  struct Place {
    Time time;
    Eigen::Vector3d p_WB;
  };
  const char* leap_fault(const Navigation& fix);
  [[nodiscard]] bool in_reach(const Place& from, const Place& to) const;

  EventGateConfig config_;
  std::array<Stream, std::variant_size_v<Event>> streams_;
  Time newest_ = Time::min();
  std::optional<Place> last_, leapt_;  ///< the last fix, and the last of the current row of jumps
  int leaps_ = 0;
  std::map<std::string, std::uint64_t> rejected_;
};

}  // namespace isobath

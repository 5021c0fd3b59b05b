// FrontSeatStandIn: what controls a simulated vehicle and speaks with the companion computer: an ArduSub autopilot
// (autopilot_stand_in.hpp) or a MOOSDB with a front seat (moos_stand_in.hpp). StandInPilot: the person who gives the
// vehicle to the companion, and takes it over for a while.
//
// All calls of ByteReceiver come from the thread of the links; `on_fix`, `on_battery` and `setpoint` from the
// simulator's.
#pragma once

#include <algorithm>
#include <isobath/standin/stand_in_link.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/navigation.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace isobath {

/// The pilot has the vehicle in this time, s after it was first given to the companion.
struct PilotTurn {
  double from_s = 0, to_s = 0;
};

class StandInPilot {
 public:
  static constexpr Duration kDeserted = std::chrono::seconds(5);
  enum class Holder : std::uint8_t { kNotYet, kCompanion, kPilot };

  /// `after_s`: after the companion is first heard.
  StandInPilot(double after_s, std::vector<PilotTurn> turns) : after_s_(after_s), turns_(std::move(turns)) {}

  void on_companion(Time now) {
    if (!first_) first_ = now;
    last_ = now;
  }
  /// Who has the vehicle.
  Holder holder(Time now) {
    if (!first_ || to_seconds(now - *first_) < after_s_) return Holder::kNotYet;
    if (!given_) given_ = now;
    const double t = to_seconds(now - *given_);
    const bool taken =
        std::ranges::any_of(turns_, [t](const PilotTurn& turn) { return t >= turn.from_s && t < turn.to_s; });
    return taken ? Holder::kPilot : Holder::kCompanion;
  }
  /// Whether a companion was heard and has been silent for 5 s.
  [[nodiscard]] bool deserted(Time now) const { return last_ && now - *last_ > kDeserted; }

 private:
  const double after_s_;
  const std::vector<PilotTurn> turns_;
  std::optional<Time> first_, last_, given_;
};

struct AutopilotCounts {
  std::uint64_t setpoints = 0;  ///< that it followed
  std::uint64_t refused = 0;    ///< that came without authority, or of another form
  double oldest_s = 0;          ///< of those it followed: age of the event that it answers, on arrival
  double longest_gap_s = 0;     ///< between two of them, while the companion had the vehicle, after the first
  std::uint64_t rings = 0, points = 0, texts = 0;  ///< OBSTACLE_DISTANCE, OBSTACLE_DISTANCE_3D, texts
  double moved_m = 0;                              ///< length of the motions that a DVL was said to have measured
  std::string last_text;
  int pulled = 0;               ///< how often its cable was pulled
  std::uint64_t untrusted = 0;  ///< frames without the right signature
  std::uint64_t obstacles = 0;  ///< texts of GIVEN_OBSTACLE that are convex outlines
  std::uint64_t malformed = 0;  ///< packets, messages and obstacles of MOOS that cannot be read
};

class FrontSeatStandIn : public ByteReceiver {
 public:
  explicit FrontSeatStandIn(const UnplugConfig& unplug) : link_(unplug, 0) {}
  void use(LinkHub& hub, ByteLink& link) {
    hub_ = &hub;
    link_.use(link);
  }

  /// The vehicle's own estimate; the links send it.
  virtual void on_fix(const Navigation& fix, Time now) = 0;
  virtual void on_battery(double /*share*/) {}
  /// What the vehicle is to do now, dt after the last call.
  [[nodiscard]] virtual Setpoint setpoint(double dt_s) = 0;
  /// Whether a companion was heard and has been silent for 5 s.
  [[nodiscard]] virtual bool deserted() const = 0;
  [[nodiscard]] virtual AutopilotCounts counts() const = 0;
  [[nodiscard]] int port() const { return link_.port(); }

 protected:
  LinkHub* hub_ = nullptr;
  StandInLink link_;
};

}  // namespace isobath

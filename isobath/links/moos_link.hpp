// MoosLink: Isobath as the back seat of a MOOS community: a client of its database (MOOSDB) in the place of the helm.
//
// In: NAV_X (east), NAV_Y (north), NAV_HEADING, NAV_DEPTH, NAV_SPEED and NAV_ALTITUDE, MOOS_MANUAL_OVERRIDE (or
// MOOS_MANUAL_OVERIDE), LAT_ORIGIN and LONG_ORIGIN (or LON_ORIGIN). New values of X, Y and heading of one instant
// (within kTogether) give a fix, with the newest depth; its velocity is NAV_SPEED along the heading. Values are at most
// kMaxAge old by the clock of the database; older ones, and what is no finite number, are refused and counted. Each
// second a health report of "vehicle" comes while the database has been heard within 3 s.
//
// Out: DESIRED_HEADING (degrees), DESIRED_SPEED and DESIRED_DEPTH with each set-point; GIVEN_OBSTACLE, one for each
// convex outline of the last scan, once a second; ISOBATH_DECISION. Sway and speed astern cannot be stated: they are
// left out. A set-point has the time of the event that it answers.
//
// Authority: set-points go out only while MOOS_MANUAL_OVERRIDE is false and a fix is at most 3 s old. This class never
// writes that variable. When authority ends, and at the end of the run, DESIRED_SPEED 0 goes out once.
//
// The link is synchronous: a packet goes out when there is something to say, at least every kPollInterval, and the next
// one only after the answer. A database that has not answered for 3 s is connected anew; every connection begins with
// the handshake. No MOOSDB was run against this.
#pragma once

#include <array>
#include <condition_variable>
#include <isobath/io/formats/moos/moos_messages.hpp>
#include <isobath/links/front_seat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class MoosLink final : public FrontSeat {
 public:
  static constexpr Duration kPollInterval = std::chrono::milliseconds(100);
  static constexpr double kMaxAge_s = 1, kTogether_s = 0.1;

  MoosLink(const FrontSeatConfig& config, LinkSource& events);

  void on_open(Time time) override;
  void on_closed(Time time, const std::string& why) override;
  void on_bytes(Bytes bytes, Time time) override;
  void on_tick(Time now) override;

  [[nodiscard]] std::string mode() const override;
  [[nodiscard]] std::optional<GeoOrigin> origin() const override;
  bool command(const Setpoint& setpoint, const VehicleParameters& limits, Time answers) override;
  void say(int severity, const std::string& text) override;
  void show(const Surroundings& around, const Navigation& fix, Time now) override;
  void end() override;

 private:
  enum Value : std::uint8_t { kEast, kNorth, kHeading, kDepth, kSpeed, kAltitude, kLatitude, kLongitude, kValues };
  struct Reading {
    double value = 0, time_s = 0;  ///< s since 1970, by the clock of the database
    bool is_new = false;           ///< since the last fix
  };
  enum class Stage : std::uint8_t { kClosed, kGreeted, kTalking };
  enum class Stop : std::uint8_t { kNone, kWaits, kSent };

  void on_answer(const std::vector<MoosMessage>& messages, Time time);
  void on_welcome(const MoosMessage& message, Time time);
  void on_variable(const MoosMessage& message, Time time);
  void on_number(Value value, const MoosMessage& message, Time time);
  void on_override(const MoosMessage& message);
  void on_state();
  void on_null(const MoosMessage& message, Time time);
  void give_fix(Time time);
  void give_altitude(const Reading& altitude, Time time);
  void report_health(Time now);
  void find_origin();
  /// Puts a message in the place of those of its variable that wait, or behind them.
  void put(MoosMessage message, bool replaces = true);
  void send_next(Time now);
  /// Puts the set-point that waits into the outbox, unless it has become too old or the pilot has taken over.
  void put_setpoint(Time now);
  [[nodiscard]] double database_s(Time time) const;  ///< what the clock of the database shows
  [[nodiscard]] Authority authority_at(Time now) const override;

  // Of the thread of the links.
  Stage stage_ = Stage::kClosed;
  SourceReport report_;
  FrameStream frames_{moos_frame_at};
  std::uint64_t offset_ = 0;
  bool waits_ = false;  ///< for the answer to the last packet
  Time sent_{}, health_{};
  std::vector<MoosMessage> outbox_;
  struct Command {
    Setpoint setpoint;
    Time answers;
  };
  std::optional<Command> command_;  ///< the newest that is not yet in a packet
  std::int32_t number_ = 0;
  std::array<Reading, kValues> readings_{};
  Stop stop_ = Stop::kNone;
  Authority told_ = Authority::kNoAutopilot;
  std::optional<Time> shown_;  ///< of the thread that calls `show`

  // mutex_ guards all below.
  std::string community_;
  std::optional<Time> heard_;                       ///< the last answer
  bool connected_ = false, override_told_ = false;  ///< the database has told its state; of this connection
  std::optional<bool> override_;                    ///< whether the pilot steers
  std::optional<Time> fix_;                         ///< time of the last one
  std::optional<double> ahead_s_;                   ///< clock of the database less ours
  std::optional<GeoOrigin> origin_;
  bool steered_ = false, ended_ = false;  ///< set-points are in force; the run is over
  std::condition_variable stopped_;
};

}  // namespace isobath

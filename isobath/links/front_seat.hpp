// FrontSeat: the connection to the program that controls the vehicle, its front seat: an ArduSub autopilot over MAVLink
// (autopilot_link.hpp) or the helm's place in a MOOS community (moos_link.hpp). Its state comes in as events,
// set-points and what people and other programs are to know go out.
//
// Set-points go out only while the pilot leaves the vehicle to Isobath (Authority); no front seat takes that by itself.
// A set-point that answers an event of more than kMaxAnswerAge ago is withheld. At most one goes out every
// kSetpointInterval, and beside these one after each call of `hasten`. The thread of the links calls the functions of
// ByteReceiver; any thread may call the others.
#pragma once

#include <array>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/links/device_link.hpp>
#include <isobath/links/link_hub.hpp>
#include <isobath/links/link_source.hpp>
#include <isobath/vehicle/autopilot.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

enum class FrontSeatKind : std::uint8_t { kArduSub, kMoos };

struct FrontSeatConfig {
  FrontSeatKind kind = FrontSeatKind::kArduSub;
  std::string link = "udp-server:14550";
  // ArduSub:
  int system = 0;                ///< of the vehicle; 0: the first that is heard
  double rate_hz = 10;           ///< of the attitude and position that are asked for
  double depth_gain = 0.5;       ///< 1/s
  double max_dive_rate = 0.4;    ///< m/s, up and down
  bool dvl_motion = false;       ///< whether the motion that a DVL measures is sent
  bool obstacle_points = false;  ///< as points in the body, not as a ring of distances
  std::string key_file;          ///< passphrase of signed frames, relative to the vehicle file; empty: no signatures
  // MOOS:
  std::string client = "isobath";              ///< name in the community
  double latitude_deg = 0, longitude_deg = 0;  ///< of the origin of its local grid; both 0: not stated

  [[nodiscard]] std::optional<GeoOrigin> origin() const;
};
std::vector<Field> fields(FrontSeatConfig& config);

/// Who steers. kNoAutopilot: the front seat is silent. kDisarmed: it is not ready. kOtherMode: the pilot steers.
enum class Authority : std::uint8_t { kNoAutopilot, kDisarmed, kOtherMode, kOurs };

/// What the last scan saw around the vehicle, in W.
struct Surroundings {
  static constexpr std::size_t kDirections = 72;
  struct Outline {
    int number = 0;  ///< of the obstacle; the convex pieces of one obstacle share it
    Polygon outline_W;
  };
  std::vector<Eigen::Vector2d> hits;      ///< the first obstacle in each direction that has one
  std::array<bool, kDirections> clear{};  ///< by direction from north: free up to the border of the grid
  double reach_m = 0;
  std::vector<Outline> obstacles;  ///< nearest first
};

class FrontSeat : public ByteReceiver {
 public:
  static constexpr Duration kSilence = std::chrono::seconds(3);
  static constexpr Duration kSetpointInterval = std::chrono::milliseconds(50);
  static constexpr Duration kMaxAnswerAge = std::chrono::milliseconds(300);

  FrontSeat(FrontSeatConfig config, LinkSource& events) : config_(std::move(config)), events_(events) {}
  FrontSeat(const FrontSeat&) = delete;
  FrontSeat& operator=(const FrontSeat&) = delete;
  void use(LinkHub& hub, ByteLink& link) {
    hub_ = &hub;
    link_ = &link;
  }
  /// Before the hub starts: a device gives the vehicle's navigation.
  void leave_navigation_to_device() { gives_navigation_ = false; }

  [[nodiscard]] Authority authority() const;
  /// "POSHOLD, armed"; for people.
  [[nodiscard]] virtual std::string mode() const = 0;
  [[nodiscard]] virtual std::optional<GeoOrigin> origin() const = 0;
  /// Starts to fetch the mission as soon as the front seat is heard, where it holds missions.
  virtual void want_mission() {}
  /// As a plan of QGroundControl. Empty while it is being fetched. Throws Error if the front seat does not give it.
  [[nodiscard]] virtual std::optional<std::string> mission() const { return std::nullopt; }

  /// Gives a set-point that answers an event of this time to the thread of the links, or withholds it. Returns whether
  /// that thread got it; it withholds what has become too old by then.
  virtual bool command(const Setpoint& setpoint, const VehicleParameters& limits, Time answers) = 0;
  /// The next set-point goes out whatever the time since the last one: it answers a ping or an order of the agents.
  void hasten();
  /// A line for people. `severity`: as in MAVLink; 4 warning, 6 information.
  virtual void say(int severity, const std::string& text) = 0;
  /// The obstacles of the last scan, seen from this fix. From one thread.
  virtual void show(const Surroundings& around, const Navigation& fix, Time now) = 0;
  /// How a DVL has moved since the last call. In the thread of the links.
  virtual void show_motion(const BodyMotion& /*motion*/) {}
  /// The run ends: leaves no set-point in force behind. Waits for that, at most 1 s. Before the hub stops.
  virtual void end() {}
  struct Counts {
    std::uint64_t setpoints = 0, withheld = 0;  ///< sent; not sent
    std::uint64_t damaged = 0;                  ///< stretches of bytes that were no frame
  };
  [[nodiscard]] Counts counts() const;

 protected:
  [[nodiscard]] virtual Authority authority_at(Time now) const = 0;  ///< under mutex_
  /// Whether a set-point may go out; under mutex_. `ready`: all that it needs is known.
  bool admits_setpoint(Time now, Time answers, bool ready);
  /// Whether a set-point still may, as it goes out, and counts it. In the thread of the links.
  bool releases_setpoint(Time now, Time answers);
  /// Tells the run what was not understood since the last call. In the thread of the links.
  void tell_refused(SourceReport& report);

  const FrontSeatConfig config_;
  LinkSource& events_;
  LinkHub* hub_ = nullptr;
  ByteLink* link_ = nullptr;
  bool gives_navigation_ = true;
  mutable std::mutex mutex_;  ///< guards what the threads share

 private:
  Time setpoint_{};
  bool hastened_ = false;
  Counts counts_;
};

std::unique_ptr<FrontSeat> make_front_seat(const FrontSeatConfig& config, LinkSource& events);

}  // namespace isobath

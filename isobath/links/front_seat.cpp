#include <isobath/links/front_seat.hpp>
#include <utility>

namespace isobath {

std::optional<GeoOrigin> FrontSeatConfig::origin() const {
  if (latitude_deg == 0 && longitude_deg == 0) return std::nullopt;
  return GeoOrigin{latitude_deg, longitude_deg};
}

std::vector<Field> fields(FrontSeatConfig& c) {
  return {
      Field::choice("kind", &c.kind, {{"ardusub", FrontSeatKind::kArduSub}, {"moos", FrontSeatKind::kMoos}},
                    "What controls the vehicle: ardusub, an ArduSub autopilot over MAVLink; moos, a MOOS community."),
      Field::text("link", &c.link,
                  "Where the autopilot is, such as udp-server:14550 or tcp:127.0.0.1:5777; a MOOSDB: tcp:HOST:9000."),
      Field::integer("system", &c.system, {0, 255}, "", "MAVLink system of the vehicle; 0: the first that is heard."),
      Field::real("rate_hz", &c.rate_hz, {1, 50}, "Hz", "Rate of attitude and position that are asked for."),
      Field::real("depth_gain", &c.depth_gain, {0.05, 5}, "1/s", "Velocity down for a metre of depth error."),
      Field::real("max_dive_rate", &c.max_dive_rate, {0.05, 2}, "m/s", "Largest velocity up or down."),
      Field::flag("dvl_motion", &c.dvl_motion,
                  "Whether the motion that a DVL measures is sent as VISION_POSITION_DELTA, for the navigation of the "
                  "autopilot (VISO_TYPE 1)."),
      Field::flag("obstacle_points", &c.obstacle_points,
                  "Whether obstacles are sent as points (OBSTACLE_DISTANCE_3D) and not as distances around the vehicle "
                  "(OBSTACLE_DISTANCE)."),
      Field::text("key_file", &c.key_file,
                  "File with the passphrase of MAVLink signing, as the ground station has it: frames are signed, and "
                  "those without the right signature are refused. Empty: no signatures."),
      Field::text("client", &c.client, "Name of Isobath in the MOOS community."),
      Field::real("latitude_deg", &c.latitude_deg, {-80, 80}, "deg",
                  "Latitude of the origin of the local grid: LatOrigin of the MOOS mission file. 0 with longitude 0: "
                  "as the variables LAT_ORIGIN and LONG_ORIGIN state it."),
      Field::real("longitude_deg", &c.longitude_deg, {-180, 180}, "deg", "Longitude of that origin: LongOrigin.")};
}

Authority FrontSeat::authority() const {
  const std::lock_guard lock(mutex_);
  return authority_at(hub_->now());
}

FrontSeat::Counts FrontSeat::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void FrontSeat::hasten() {
  const std::lock_guard lock(mutex_);
  hastened_ = true;
}

bool FrontSeat::admits_setpoint(Time now, Time answers, bool ready) {
  const bool stale = now - answers > kMaxAnswerAge;  // a run that is behind its devices: the vehicle stops by itself
  if (authority_at(now) != Authority::kOurs || !ready || stale) {
    ++counts_.withheld;
    return false;
  }
  if (!std::exchange(hastened_, false) && now - setpoint_ < kSetpointInterval) return false;
  setpoint_ = now;
  return true;
}

bool FrontSeat::releases_setpoint(Time now, Time answers) {
  const std::lock_guard lock(mutex_);
  const bool goes = authority_at(now) == Authority::kOurs && now - answers <= kMaxAnswerAge;
  ++(goes ? counts_.setpoints : counts_.withheld);
  return goes;
}

void FrontSeat::tell_refused(SourceReport& report) {
  if (report.bytes_skipped > 0) {
    const std::lock_guard lock(mutex_);
    ++counts_.damaged;
    events_.refuse("autopilot: bytes that are no frame");
  }
  for (const auto& [reason, count] : report.rejected) events_.refuse("autopilot: " + reason, count);
  report.rejected.clear();
  report.damages.clear();
  report.bytes_skipped = 0;
}

}  // namespace isobath

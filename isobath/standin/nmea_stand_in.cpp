#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/formats/nmea_decoder.hpp>
#include <isobath/standin/device_stand_ins.hpp>

namespace isobath {
namespace {

constexpr Duration kFixInterval = std::chrono::milliseconds(200);
constexpr double kKnots = 3600.0 / 1852;  // in 1 m/s
constexpr double kStraightDown = 0.7;     // least z of an axis that looks down

/// "4807.0380000,N"
std::string degrees_and_minutes(double degrees, int digits, const char* sides) {
  const double size = std::abs(degrees), whole = std::floor(size);
  return fmt::format("{:0{}.0f}{:010.7f},{}", whole, digits, (size - whole) * 60, degrees < 0 ? sides[1] : sides[0]);
}

class NmeaStandIn final : public DeviceStandIn {
 public:
  NmeaStandIn(const UnplugConfig& unplug, std::uint64_t stream, const GeoOrigin& origin)
      : DeviceStandIn(DeviceKind::kNmea, unplug, stream), plane_(origin) {}

  void on_bytes(Bytes /*bytes*/, Time /*time*/) override {}
  void on_event(const Event& event, Time now) override {
    if (const auto* fix = std::get_if<Navigation>(&event)) return on_fix(*fix, now);
    const auto* reading = std::get_if<RangeReading>(&event);
    if (!reading || (reading->X_BS.rotation * Eigen::Vector3d::UnitX()).z() < kStraightDown) return;
    if (!reading->range_m) return say("SDDPT,,,", now);
    say(fmt::format("SDDPT,{:.3f},{:.3f},{:.1f}", *reading->range_m, depth_m_ + reading->X_BS.translation.z(),
                    reading->max_range_m),
        now);
  }

 private:
  void on_fix(const Navigation& fix, Time now) {
    depth_m_ = std::max(0.0, fix.X_WB.translation.z());
    if (now - told_ < kFixInterval) return;
    told_ = now;
    const GeoPoint place = plane_.to_geo(fix.X_WB.translation.head<2>());
    const std::string where =
        degrees_and_minutes(place.latitude_deg, 2, "NS") + "," + degrees_and_minutes(place.longitude_deg, 3, "EW");
    const auto day = std::chrono::floor<std::chrono::days>(now);
    const std::chrono::year_month_day date(day);
    const std::chrono::hh_mm_ss time(std::chrono::floor<std::chrono::milliseconds>(now - day));
    const std::string at = fmt::format("{:02}{:02}{:02}.{:03}", time.hours().count(), time.minutes().count(),
                                       time.seconds().count(), time.subseconds().count());
    const Eigen::Vector3d v = fix.v_WB.value_or(Eigen::Vector3d::Zero());
    const Angle course = Angle::radians(std::atan2(v.y(), v.x())).wrapped_positive();
    say(fmt::format("HEHDT,{:.2f},T", fix.X_WB.rotation.heading().wrapped_positive().degrees()), now);
    say(fmt::format("GPRMC,{},A,{},{:.3f},{:.1f},{:02}{:02}{:02},,,A", at, where, v.head<2>().norm() * kKnots,
                    course.degrees(), unsigned{date.day()}, unsigned{date.month()}, int{date.year()} % 100),
        now);
    say(fmt::format("GPGGA,{},{},4,12,0.8,0.0,M,0.0,M,,", at, where), now);
  }
  void say(const std::string& body, Time now) {
    const std::string line = nmea_line(body);
    const Bytes bytes = bytes_of(line);
    send({bytes.begin(), bytes.end()}, now);
  }

  LocalPlane plane_;
  double depth_m_ = 0;
  Time told_{};
};

}  // namespace

std::unique_ptr<DeviceStandIn> make_nmea_stand_in(const UnplugConfig& unplug, std::uint64_t stream,
                                                  const GeoOrigin& origin) {
  return std::make_unique<NmeaStandIn>(unplug, stream, origin);
}

}  // namespace isobath

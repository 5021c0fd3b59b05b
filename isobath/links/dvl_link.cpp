#include <cmath>
#include <functional>
#include <isobath/io/bytes/line_stream.hpp>
#include <isobath/io/input/scanning_head.hpp>
#include <isobath/io/input/survey_input.hpp>
#include <isobath/links/device_link.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestLine = 16384;
constexpr Angle kBeam = Angle::degrees(50);  // the four beams stand 22.5 degrees off the axis
constexpr double kRange_m = 50;              // maker's data sheet of the A50
constexpr Duration kReportInterval = std::chrono::seconds(1);

double number(const Json& report, const char* key) {
  const auto found = report.find(key);
  return found != report.end() && found->is_number() ? found->get<double>() : std::nan("");
}

bool flag(const Json& report, const char* key) {
  const auto found = report.find(key);
  return found != report.end() && found->is_boolean() && found->get<bool>();
}

/// A WaterLinked A50 (protocol json_v3): one JSON object a line. `velocity`: altitude along the axis; `position_local`:
/// its dead reckoning, in north-east-down where its compass is set up, with roll, pitch and yaw in degrees.
class DvlLink final : public DeviceLink {
 public:
  using DeviceLink::DeviceLink;
  void report_motion_to(const std::function<void(const BodyMotion&)>& take) override { take_motion_ = take; }

  void on_bytes(Bytes bytes, Time time) override {
    const std::uint64_t dropped = lines_.push(bytes, [&](std::string_view line) { on_line(line, time); });
    if (dropped > 0) report_.rejected["line too long"] += dropped;
    tell(report_);
  }

 private:
  void begin() override { lines_.clear(); }
  void on_line(std::string_view line, Time time) {
    const Json report = Json::parse(line, nullptr, false);
    const auto type = report.is_object() ? report.find("type") : report.end();
    if (!report.is_object() || type == report.end() || !type->is_string()) {
      ++report_.rejected["line that is no report"];
      return;
    }
    if (*type == "velocity") on_velocity(report, time);
    if (*type == "position_local" && config_.navigation) on_position(report, time);
  }
  void tell_motion(const Json& report, Time time) {
    const Eigen::Vector3d v_S(number(report, "vx"), number(report, "vy"), number(report, "vz"));
    if (!take_motion_ || !flag(report, "velocity_valid") || !v_S.allFinite()) return;
    const Rotation R_BS = Rotation::from_heading_pitch_roll(config_.heading, config_.pitch, config_.roll);
    const double sigma = number(report, "fom");
    take_motion_({time, R_BS * v_S, std::isfinite(sigma) && sigma >= 0 ? sigma : kSigma});
  }
  void on_velocity(const Json& report, Time time) {
    tell_motion(report, time);
    const double altitude = number(report, "altitude");
    RangeReading reading;
    reading.time = time;
    reading.max_range_m = kRange_m;
    reading.width = kBeam;
    reading.X_BS = looking_down(0);
    reading.X_BS.translation = config_.position();
    if (std::isfinite(altitude) && altitude > 0 && altitude < kRange_m) reading.range_m = altitude;
    if (!flag(report, "velocity_valid") && !reading.range_m) return;  // in air, or beyond its range: no statement
    give(reading, time);
    if (time - told_ < kReportInterval) return;
    told_ = time;
    const bool hot = number(report, "status") == 1;
    give(Health{.time = time,
                .source = config_.called(),
                .state = hot ? HealthState::kDegraded : HealthState::kOk,
                .note = hot ? "too hot" : ""},
         time);
  }
  void on_position(const Json& report, Time time) {
    const Eigen::Vector3d p(number(report, "x"), number(report, "y"), number(report, "z"));
    const double roll = number(report, "roll"), pitch = number(report, "pitch"), yaw = number(report, "yaw");
    if (!p.allFinite() || !std::isfinite(roll + pitch + yaw)) {
      ++report_.rejected["position that is not a number"];
      return;
    }
    Navigation fix;
    fix.time = time;
    fix.X_WB = {Rotation::from_heading_pitch_roll(Angle::degrees(yaw), Angle::degrees(pitch), Angle::degrees(roll)), p};
    const double sigma = number(report, "std");
    if (std::isfinite(sigma) && sigma > 0) {
      Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
      covariance.diagonal().head<3>().setConstant(sigma * sigma);
      covariance.diagonal().tail<3>().setConstant(kTilt * kTilt);
      fix.covariance = covariance;
    }
    give(fix, time);
  }

  static constexpr double kSigma = 0.1;  // m/s: of a report that states none
  static constexpr double kTilt = 0.02;  // rad: of its attitude, estimated
  SourceReport report_;
  std::function<void(const BodyMotion&)> take_motion_;
  LineStream lines_{kLongestLine};
  Time told_{};
};

}  // namespace

std::unique_ptr<DeviceLink> make_dvl_link(const DeviceConfig& config, LinkSource& events) {
  return std::make_unique<DvlLink>(config, events);
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/formats/oculus/oculus_commands.hpp>
#include <isobath/io/formats/oculus/oculus_protocol.hpp>
#include <isobath/io/formats/ping/ping_commands.hpp>
#include <isobath/standin/device_stand_ins.hpp>
#include <isobath/standin/framed_stand_in.hpp>

namespace isobath {
namespace {

constexpr Duration kFireLasts = std::chrono::seconds(3);
constexpr double kDown = 0.7;  // least z of an axis that looks down

bool points_down(const RangeReading& reading) { return (reading.X_BS.rotation * Eigen::Vector3d::UnitX()).z() > kDown; }

bool asks_who(const PingFrame& frame) {
  return frame.id == ping_message::kGeneralRequest &&
         ByteCursor(frame.payload).little<std::uint16_t>() == ping_message::kDeviceInformation;
}

class Ping360StandIn final : public FramedStandIn {
 public:
  Ping360StandIn(const UnplugConfig& unplug, std::uint64_t stream)
      : FramedStandIn(DeviceKind::kPing360, unplug, stream, ping_frame_at) {}

  void on_event(const Event& event, Time now) override {
    const Ping* const ping = scanned_line(event);
    if (!ping) return;
    const std::lock_guard lock(mutex_);
    if (!settings_ || (!sweeps_ && !std::exchange(asked_, false))) return;
    Ping360Settings line = *settings_;
    line.sample_period = static_cast<std::uint16_t>(
        std::clamp(std::lround(2 * ping->window.bin_m / (ping->sound_speed * kPing360Tick_s)), 1L, 65535L));
    line.samples = static_cast<std::uint16_t>(ping->window.bins);
    const long grad = std::lround(ping->fan->azimuth.front().degrees() / 0.9);
    send(ping360_line_bytes(line, static_cast<int>((grad % 400 + 400) % 400), sweeps_, samples_of(*ping)), now);
  }

 private:
  void on_frame(Bytes frame, Time time) override {
    if (asks_who(ping_frame(frame))) return send(ping_device_information(PingDeviceType::kPing360), time);
    const auto request = ping360_request(ping_frame(frame));
    if (!request) return;
    if (request->sweeps) command_ = command_of(request->settings);
    if (!request->sweeps) asked_ = true;
    sweeps_ = request->sweeps;
    settings_ = request->settings;
  }
  /// Only what differs from the last command.
  std::optional<ScanCommand> command_of(const Ping360Settings& s) const {
    if (settings_ && s.start_grad == settings_->start_grad && s.stop_grad == settings_->stop_grad &&
        s.step_grad == settings_->step_grad && s.sample_period == settings_->sample_period &&
        s.samples == settings_->samples) {
      return command_;
    }
    const int span = (s.stop_grad - s.start_grad + 400) % 400;
    ScanCommand command;
    command.step = Angle::degrees(0.9 * s.step_grad);
    command.sector = Angle::degrees(span >= 399 ? 360 : 0.9 * span);
    command.middle = span >= 399 ? Angle{} : Angle::degrees(0.9 * (s.start_grad + span / 2.0)).wrapped();
    constexpr double kSound = 1500;
    command.range_m = kSound * s.sample_period * kPing360Tick_s * s.samples / 2;
    return command;
  }

  std::optional<Ping360Settings> settings_;
  bool sweeps_ = false, asked_ = false;
};

class Ping1DStandIn final : public FramedStandIn {
 public:
  Ping1DStandIn(const UnplugConfig& unplug, std::uint64_t stream)
      : FramedStandIn(DeviceKind::kPing1D, unplug, stream, ping_frame_at) {}

  void on_event(const Event& event, Time /*now*/) override {
    const auto* reading = std::get_if<RangeReading>(&event);
    if (!reading || !points_down(*reading)) return;
    const std::lock_guard lock(mutex_);
    newest_ = *reading;
  }

 private:
  void on_frame(Bytes bytes, Time time) override {
    const PingFrame frame = ping_frame(bytes);
    if (asks_who(frame)) return send(ping_device_information(PingDeviceType::kPing1D), time);
    const bool asks = frame.id == ping_message::kGeneralRequest &&
                      ByteCursor(frame.payload).little<std::uint16_t>() == ping_message::kDistance;
    if (!asks || !newest_) return;
    const bool echo = newest_->range_m.has_value();
    send(ping1d_distance_bytes(newest_->range_m.value_or(0), echo ? 99 : 0, newest_->max_range_m), time);
  }

  std::optional<RangeReading> newest_;
};

/// A frame that is a fire message at its start; anything else is passed over byte by byte.
Framing fire_at(Bytes bytes) {
  constexpr std::size_t kFire = 53;
  if (bytes.size() < kFire) return {Framing::Kind::kIncomplete, kFire};
  return oculus_fire_of(bytes) ? Framing{Framing::Kind::kFrame, kFire} : Framing{Framing::Kind::kNoise, 1};
}

class OculusStandIn final : public FramedStandIn {
 public:
  OculusStandIn(const UnplugConfig& unplug, std::uint64_t stream)
      : FramedStandIn(DeviceKind::kOculus, unplug, stream, fire_at) {}

  void on_event(const Event& event, Time now) override {
    const auto* ping = std::get_if<Ping>(&event);
    if (!ping || ping->fan->beams() < 2 || ping->intensity.type() != SampleType::kU8) return;
    const std::lock_guard lock(mutex_);
    if (!fire_ || now - fired_ > kFireLasts) return;
    OculusImage image;
    image.fire = *fire_;
    image.fire.sound_speed = ping->sound_speed;
    image.number = ++number_;
    image.range_step_m = ping->window.bin_m;
    const int beams = ping->fan->beams(), rows = ping->window.bins;
    for (const Angle azimuth : ping->fan->azimuth)
      image.bearings.push_back(static_cast<std::int16_t>(std::lround(azimuth.degrees() * 100)));
    image.samples.resize(static_cast<std::size_t>(beams) * rows);
    for (int row = 0; row < rows; ++row) {
      for (int beam = 0; beam < beams; ++beam)
        image.samples[static_cast<std::size_t>(row) * beams + beam] =
            static_cast<std::byte>(std::lround(ping->intensity(beam, row)));
    }
    send(oculus_ping_result(image), now);
  }

 private:
  void on_frame(Bytes frame, Time time) override {
    fire_ = oculus_fire_of(frame);
    fired_ = time;
    if (fire_->range_m == range_m_) return;
    range_m_ = fire_->range_m;
    command_ = ScanCommand{.range_m = range_m_};
  }

  std::optional<OculusFire> fire_;
  Time fired_{};
  double range_m_ = 0;
  std::uint32_t number_ = 0;
};

class DvlStandIn final : public DeviceStandIn {
 public:
  DvlStandIn(const UnplugConfig& unplug, std::uint64_t stream) : DeviceStandIn(DeviceKind::kDvlA50, unplug, stream) {}
  void on_bytes(Bytes /*bytes*/, Time /*time*/) override {}
  void on_event(const Event& event, Time now) override {
    if (const auto* reading = std::get_if<RangeReading>(&event); reading && points_down(*reading)) {
      altitude_m_ = reading->range_m.value_or(-1);
    }
    const auto* fix = std::get_if<Navigation>(&event);
    if (!fix) return;
    const Rotation& R = fix->X_WB.rotation;
    const Eigen::Vector3d v = R.inverse() * fix->v_WB.value_or(Eigen::Vector3d::Zero());
    const Eigen::Vector3d& p = fix->X_WB.translation;
    const std::string text = fmt::format(
        R"({{"time":120,"vx":{:.4f},"vy":{:.4f},"vz":{:.4f},"fom":0.002,"altitude":{:.3f},"velocity_valid":true,)"
        R"("status":0,"format":"json_v3.1","type":"velocity"}})"
        "\n"
        R"({{"ts":{:.3f},"x":{:.4f},"y":{:.4f},"z":{:.4f},"std":{:.4f},"roll":{:.3f},"pitch":{:.3f},"yaw":{:.3f},)"
        R"("type":"position_local","status":0,"format":"json_v3.1"}})"
        "\n",
        v.x(), v.y(), v.z(), altitude_m_, to_seconds(now), p.x(), p.y(), p.z(), sigma_m_of(*fix).value_or(0.1),
        R.roll().degrees(), R.pitch().degrees(), R.heading().degrees());
    const Bytes bytes = bytes_of(text);
    send({bytes.begin(), bytes.end()}, now);
  }

 private:
  double altitude_m_ = -1;
};

}  // namespace

std::unique_ptr<DeviceStandIn> make_device_stand_in(DeviceKind kind, const UnplugConfig& unplug, std::uint64_t stream,
                                                    const GeoOrigin& origin) {
  switch (kind) {
    case DeviceKind::kPing360: return std::make_unique<Ping360StandIn>(unplug, stream);
    case DeviceKind::kPing1D: return std::make_unique<Ping1DStandIn>(unplug, stream);
    case DeviceKind::kMicron: return make_micron_stand_in(unplug, stream);
    case DeviceKind::kOculus: return std::make_unique<OculusStandIn>(unplug, stream);
    case DeviceKind::kDvlA50: return std::make_unique<DvlStandIn>(unplug, stream);
    case DeviceKind::kNmea: return make_nmea_stand_in(unplug, stream, origin);
  }
  return nullptr;
}

}  // namespace isobath

#include <cmath>
#include <isobath/io/formats/tritech/tritech_commands.hpp>
#include <isobath/standin/device_stand_ins.hpp>
#include <isobath/standin/framed_stand_in.hpp>

namespace isobath {
namespace {

constexpr Duration kAliveInterval = std::chrono::seconds(1);
constexpr std::uint16_t kSerialNumber = 1234;

Angle from_ahead(int sixteenths) { return tritech::bearing(sixteenths); }

/// The simulated head sweeps by itself: a request for a line is answered with the next one.
class MicronStandIn final : public FramedStandIn {
 public:
  MicronStandIn(const UnplugConfig& unplug, std::uint64_t stream)
      : FramedStandIn(DeviceKind::kMicron, unplug, stream, tritech_frame_at) {}

  void on_event(const Event& event, Time now) override {
    const Ping* const ping = scanned_line(event);
    if (!ping) return;
    const std::lock_guard lock(mutex_);
    if (!settings_ || !asked_) return;
    asked_ = false;
    TritechSettings line = *settings_;
    line.bin_time =
        static_cast<std::uint16_t>(std::lround(2 * ping->window.bin_m / (ping->sound_speed * tritech::kBinTimeUnit_s)));
    line.bins = static_cast<std::uint16_t>(ping->window.bins);
    send(tritech_line_bytes(line, tritech::sixteenths(ping->fan->azimuth.front()), samples_of(*ping)), now);
  }
  void on_tick(Time now) override {
    const std::lock_guard lock(mutex_);
    if (polled_ || now - told_ < kAliveInterval) return;
    told_ = now;
    send(tritech_alive_bytes({.has_no_settings = !settings_}), now);
  }

 private:
  void on_frame(Bytes bytes, Time time) override {
    using Kind = TritechRequest::Kind;
    const auto request = tritech_request(tritech_frame(bytes));
    if (!request) return;
    if (request->kind == Kind::kSendVersion) return send(tritech_version_bytes(kSerialNumber), time);
    if (request->kind == Kind::kReboot) settings_.reset();
    if (request->kind == Kind::kHeadCommand) {
      settings_ = request->settings;
      command_ = command_of(*settings_);
    }
    asked_ = polled_ = request->kind == Kind::kSendData && settings_;
    told_ = {};  // what it is now, at once
  }
  static ScanCommand command_of(const TritechSettings& s) {
    constexpr double kSound = 1500;
    const int span = (s.right_limit - s.left_limit + tritech::kTurn) % tritech::kTurn;
    ScanCommand command;
    command.step = from_ahead(tritech::kAhead + s.step);
    command.sector = s.full_circle ? Angle::degrees(360) : from_ahead(tritech::kAhead + span);
    command.middle = s.full_circle ? Angle{} : from_ahead(s.left_limit + span / 2).wrapped();
    command.range_m = kSound * s.bin_time * tritech::kBinTimeUnit_s * s.bins / 2;
    return command;
  }

  std::optional<TritechSettings> settings_;
  bool asked_ = false, polled_ = false;
  Time told_{};
};

}  // namespace

std::unique_ptr<DeviceStandIn> make_micron_stand_in(const UnplugConfig& unplug, std::uint64_t stream) {
  return std::make_unique<MicronStandIn>(unplug, stream);
}

}  // namespace isobath

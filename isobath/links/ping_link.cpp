#include <algorithm>
#include <cmath>
#include <isobath/io/formats/ping/ping_commands.hpp>
#include <isobath/io/formats/ping/ping_device.hpp>
#include <isobath/io/input/survey_input.hpp>
#include <isobath/links/device_link.hpp>
#include <optional>

namespace isobath {
namespace {

constexpr Duration kSilence = std::chrono::seconds(2);             // until the device is commanded again
constexpr Duration kLineTimeout = std::chrono::milliseconds(500);  // of a head that is asked line by line
constexpr std::uint8_t kHighGain = 2;

/// The frames of a Blue Robotics device.
class PingLink : public DeviceLink {
 public:
  PingLink(const DeviceConfig& config, LinkSource& events)
      : DeviceLink(config, events), device_(config_.input(), report_) {}

  void on_bytes(Bytes bytes, Time time) override {
    frames_.push(bytes, time, offset_);
    offset_ += bytes.size();
    while (const auto found = frames_.next(report_)) {
      const auto frame = std::make_shared<const std::vector<std::byte>>(found->frame.begin(), found->frame.end());
      on_frame(ping_frame(*frame));
      auto event = device_.event(*frame, found->time, frame);
      if (!event) continue;
      last_heard_ = time;
      if (auto* ping = std::get_if<Ping>(&*event)) {
        ping->time -= seconds(2 * ping->window.end_m() / ping->sound_speed);
        ping->X_BS = at_its_place(ping->X_BS);
        on_line();
      } else if (auto* reading = std::get_if<RangeReading>(&*event)) {
        reading->X_BS = at_its_place(config_.looks == DeviceLooks::kAhead ? reading->X_BS : looking_down(0));
      }
      give(std::move(*event), time);
    }
    tell(report_);
  }

 protected:
  virtual void on_frame(const PingFrame& /*frame*/) {}
  virtual void on_line() {}
  [[nodiscard]] bool silent(Time now) const { return now - last_heard_.value_or(asked_) > kSilence; }
  [[nodiscard]] Pose at_its_place(Pose X_BS) const {
    X_BS.translation = config_.position();
    return X_BS;
  }

  SourceReport report_;
  PingDevice device_;
  FrameStream frames_{ping_frame_at};
  std::uint64_t offset_ = 0;
  std::optional<Time> last_heard_;
  Time asked_{};
};

class Ping360Link final : public PingLink {
 public:
  using PingLink::PingLink;

  void command(const ScanCommand& command) override {
    hub_->post([this, command] {
      wanted_.take(command, config_);
      begin();
    });
  }
  void on_tick(Time now) override {
    if (!open_) return;
    if (by_line_ && now - asked_ > kLineTimeout) ask_line();
    if (!silent(now) || now - asked_ < kSilence) return;
    begin();
  }

 private:
  void begin() override {
    asked_ = hub_->now();
    if (by_line_) return ask_line();
    link_->send(ping360_auto_transmit(settings()));
  }
  [[nodiscard]] Ping360Settings settings() const {
    const double sense = config_.upside_down ? -1 : 1;
    return ping360_settings({.middle = wanted_.middle * sense,
                             .sector = wanted_.sector,
                             .step = wanted_.step,
                             .range_m = wanted_.range_m,
                             .samples = wanted_.samples,
                             .frequency_khz = wanted_.frequency_khz,
                             .gain = std::min(wanted_.gain_in_use(), int{kHighGain}),
                             .sound_speed = config_.sound_speed});
  }
  void on_frame(const PingFrame& frame) override {
    if (frame.id != ping_message::kNack ||
        ByteCursor(frame.payload).little<std::uint16_t>() != ping_message::kAutoTransmit)
      return;
    by_line_ = true;  // a head that does not sweep by itself
    events_.note(config_.called() + ", sweep", "asked line by line: the head does not know auto_transmit");
    ask_line();
  }
  void on_line() override {
    if (by_line_) ask_line();
  }
  void ask_line() {
    const Ping360Settings now = settings();
    const int span = (now.stop_grad - now.start_grad + 400) % 400;
    const bool turns = wanted_.sector.degrees() >= 359;
    at_ += turns ? now.step_grad : way_ * now.step_grad;
    if (!turns && (at_ > span || at_ < 0)) {
      way_ = at_ > span ? -1 : 1;
      at_ = std::clamp(at_, 0, span);
    }
    asked_ = hub_->now();
    link_->send(ping360_transducer(now, (now.start_grad + at_) % 400));
  }

  DeviceConfig wanted_ = config_;
  bool by_line_ = false;
  int at_ = 0, way_ = 1;
};

class Ping1DLink final : public PingLink {
 public:
  using PingLink::PingLink;
  void on_tick(Time now) override {
    if (!open_ || now - asked_ < seconds(config_.interval_s)) return;
    asked_ = now;
    link_->send(ping_request(ping_message::kDistance));
  }

 private:
  void begin() override {
    link_->send(ping_set_sound_speed(config_.sound_speed));
    link_->send(ping_request(ping_message::kSpeedOfSound));
  }
};

}  // namespace

std::unique_ptr<DeviceLink> make_ping360_link(const DeviceConfig& config, LinkSource& events) {
  return std::make_unique<Ping360Link>(config, events);
}

std::unique_ptr<DeviceLink> make_ping1d_link(const DeviceConfig& config, LinkSource& events) {
  return std::make_unique<Ping1DLink>(config, events);
}

}  // namespace isobath

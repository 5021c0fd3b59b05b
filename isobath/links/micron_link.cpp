#include <isobath/io/formats/tritech/tritech_commands.hpp>
#include <isobath/io/formats/tritech/tritech_device.hpp>
#include <isobath/links/device_link.hpp>
#include <optional>
#include <utility>

namespace isobath {
namespace {

constexpr Duration kAnswer = std::chrono::seconds(1);  // until a request is repeated
constexpr int kMaxMisses = 5;                          // then the settings are sent again
constexpr std::uint8_t kLostSettings = 0b11;           // head status: power loss, or the motor lost its place

/// A Tritech Micron or another Seanet imaging head. On opening it is asked for its version and given its settings; when
/// it says that it has them (mtAlive), or is silent for a second, it is asked for a line, and for the next after each
/// line. A head that was reset gets its settings again.
class MicronLink final : public DeviceLink {
 public:
  MicronLink(const DeviceConfig& config, LinkSource& events)
      : DeviceLink(config, events), device_(config_.input(), report_) {}

  void command(const ScanCommand& command) override {
    hub_->post([this, command] {
      wanted_.take(command, config_);
      begin();
    });
  }
  void on_bytes(Bytes bytes, Time time) override {
    frames_.push(bytes, time, offset_);
    offset_ += bytes.size();
    while (const auto found = frames_.next(report_)) {
      const auto bytes_kept = std::make_shared<const std::vector<std::byte>>(found->frame.begin(), found->frame.end());
      on_frame(tritech_frame(*bytes_kept));
      auto event = device_.event(*bytes_kept, found->time, bytes_kept);
      if (!event) continue;
      auto& ping = std::get<Ping>(*event);
      ping.time -= seconds(2 * ping.window.end_m() / ping.sound_speed);
      ping.X_BS.translation = config_.position();
      give(std::move(*event), time);
    }
    tell(report_);
  }
  void on_tick(Time now) override {
    if (!open_ || now - asked_ < kAnswer) return;
    if (++misses_ > kMaxMisses) return begin();
    ask();
  }

 private:
  void begin() override {
    misses_ = 0;
    link_->send(tritech_send_version());
    send_settings();
  }
  void send_settings() {
    const double sense = config_.upside_down ? -1 : 1;
    asked_ = hub_->now();
    waits_for_line_ = false;
    link_->send(tritech_head_command(tritech_settings({.middle = wanted_.middle * sense,
                                                       .sector = wanted_.sector,
                                                       .step = wanted_.step,
                                                       .range_m = wanted_.range_m,
                                                       .samples = wanted_.samples,
                                                       .gain_percent = wanted_.gain_in_use(),
                                                       .sound_speed = config_.sound_speed})));
  }
  void ask() {
    asked_ = hub_->now();
    waits_for_line_ = true;
    link_->send(tritech_send_data());
  }
  void on_frame(const TritechFrame& frame) {
    if (const auto alive = tritech_alive(frame)) {
      if (alive->has_no_settings) return send_settings();
      if (!waits_for_line_) ask();
      return;
    }
    if (frame.id != tritech::kHeadData || !frame.last) return;
    const bool asked = std::exchange(waits_for_line_, false);  // else the answer to a request that was repeated
    misses_ = 0;
    const auto line = tritech_line(frame.payload);
    if (line && (line->head_status & kLostSettings) != 0) {
      events_.refuse(config_.called() + ": head that was reset");
      return send_settings();
    }
    if (asked) ask();
  }

  SourceReport report_;
  TritechDevice device_;
  FrameStream frames_{tritech_frame_at};
  std::uint64_t offset_ = 0;
  DeviceConfig wanted_ = config_;
  Time asked_{};
  int misses_ = 0;
  bool waits_for_line_ = false;  ///< one request at a time: the line may be half duplex
};

}  // namespace

std::unique_ptr<DeviceLink> make_micron_link(const DeviceConfig& config, LinkSource& events) {
  return std::make_unique<MicronLink>(config, events);
}

}  // namespace isobath

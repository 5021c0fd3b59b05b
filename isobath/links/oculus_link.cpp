#include <isobath/io/formats/oculus/oculus_commands.hpp>
#include <isobath/io/formats/oculus/oculus_device.hpp>
#include <isobath/links/device_link.hpp>

namespace isobath {
namespace {

constexpr Duration kFireInterval = std::chrono::seconds(1);  // without a fire message the sonar falls idle

class OculusLink final : public DeviceLink {
 public:
  OculusLink(const DeviceConfig& config, LinkSource& events)
      : DeviceLink(config, events), device_(config.input(), report_) {}

  void command(const ScanCommand& command) override {
    hub_->post([this, command] {
      if (command.as_configured) range_m_ = config_.range_m;
      if (command.range_m) range_m_ = *command.range_m;
      begin();
    });
  }
  void on_tick(Time now) override {
    if (open_ && now - fired_ >= kFireInterval) begin();
  }
  void on_bytes(Bytes bytes, Time time) override {
    frames_.push(bytes, time, offset_);
    offset_ += bytes.size();
    while (const auto found = frames_.next(report_)) {
      const auto message = std::make_shared<const std::vector<std::byte>>(found->frame.begin(), found->frame.end());
      auto event = device_.event(*message, found->time, message);
      if (!event) continue;
      if (auto* ping = std::get_if<Ping>(&*event)) {
        ping->time -= seconds(2 * ping->window.end_m() / ping->sound_speed);
        ping->X_BS = {Rotation::from_heading_pitch_roll(config_.heading, config_.pitch, config_.roll),
                      config_.position()};
      }
      give(std::move(*event), time);
    }
    tell(report_);
  }

 private:
  void begin() override {
    fired_ = hub_->now();
    link_->send(oculus_fire({.range_m = range_m_,
                             .gain_percent = static_cast<double>(config_.gain_in_use()),
                             .sound_speed = config_.sound_speed}));
  }

  SourceReport report_;
  OculusDevice device_;
  FrameStream frames_{oculus_message_at};
  std::uint64_t offset_ = 0;
  double range_m_ = config_.range_m;
  Time fired_{};
};

}  // namespace

std::unique_ptr<DeviceLink> make_oculus_link(const DeviceConfig& config, LinkSource& events) {
  return std::make_unique<OculusLink>(config, events);
}

}  // namespace isobath

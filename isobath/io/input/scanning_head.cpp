#include <isobath/io/input/scanning_head.hpp>

namespace isobath {
namespace {

constexpr std::size_t kMaxFans = 1 << 16;  // more directions than any head has; only abnormal logs reach it

}  // namespace

BeamSize beam_size(const InputConfig& config, BeamSize device) {
  return {config.beam_width.radians() > 0 ? config.beam_width : device.width,
          config.beam_height.radians() > 0 ? config.beam_height : device.height};
}

Pose mounted(const InputConfig& config) {
  Pose X_BS;
  X_BS.rotation = Rotation::from_heading(config.mount_heading);
  return X_BS;
}

ScanningHead::ScanningHead(const InputConfig& config, BeamSize device)
    : beam_(beam_size(config, device)),
      X_BS_(mounted(config)),
      sense_(config.clockwise ? 1 : -1),
      sound_speed_(config.sound_speed) {}

Ping ScanningHead::ping(Angle bearing, const RangeWindow& window, const std::byte* samples,
                        const std::shared_ptr<const void>& owner) {
  Ping ping;
  ping.fan = fan((bearing * sense_).wrapped());
  ping.window = window;
  ping.intensity = Intensities(samples, SampleType::kU8, 1, window.bins, window.bins, 1);
  ping.storage = owner;
  ping.X_BS = X_BS_;
  ping.sound_speed = sound_speed_;
  return ping;
}

std::shared_ptr<const BeamFan> ScanningHead::fan(Angle azimuth) {
  if (fans_.size() >= kMaxFans && !fans_.contains(azimuth.radians())) fans_.clear();
  auto& fan = fans_[azimuth.radians()];
  if (!fan) fan = std::make_shared<const BeamFan>(BeamFan{{azimuth}, {beam_.width}, beam_.height});
  return fan;
}

}  // namespace isobath

#include <isobath/io/bytes/record_writer.hpp>
#include <isobath/io/formats/oculus/oculus_commands.hpp>
#include <isobath/io/formats/oculus/oculus_protocol.hpp>

namespace isobath {
namespace {

constexpr std::uint16_t kOculusId = 0x4F53, kSimpleFire = 0x15;
constexpr std::size_t kHeader = 16, kFireBytes = 53, kResultBytes = 122;
constexpr std::uint8_t kMetres = 1, kSimpleReturn = 8, kAssistance = 16;

/// Header and fire message, as both messages begin.
RecordWriter begun(std::size_t bytes, std::uint16_t id, const OculusFire& fire) {
  RecordWriter out(bytes);
  out.put(0, kOculusId).put(6, id).put(10, static_cast<std::uint32_t>(bytes - kHeader));
  out.put(16, fire.mode).put(17, fire.rate).put(18, std::uint8_t{0xFF}).put(19, std::uint8_t{0xFF});
  out.put(20, static_cast<std::uint8_t>(kMetres | kSimpleReturn | kAssistance));
  out.put(21, fire.range_m).put(29, fire.gain_percent).put(37, fire.sound_speed);
  return out;
}

}  // namespace

std::vector<std::byte> oculus_fire(const OculusFire& fire) { return begun(kFireBytes, kSimpleFire, fire).take(); }

std::optional<OculusFire> oculus_fire_of(Bytes message) {
  const RecordView view(message);
  if (message.size() < kFireBytes || view.at<std::uint16_t>(0) != kOculusId || view.at<std::uint16_t>(6) != kSimpleFire)
    return std::nullopt;
  return OculusFire{view.at<double>(21), view.at<double>(29), view.at<double>(37), view.at<std::uint8_t>(16),
                    view.at<std::uint8_t>(17)};
}

std::vector<std::byte> oculus_ping_result(const OculusImage& image) {
  const std::size_t beams = image.bearings.size(), table = 2 * beams, at = kResultBytes + table;
  const std::size_t rows = beams > 0 ? image.samples.size() / beams : 0;
  RecordWriter out = begun(at + rows * beams, oculus::kSimplePingResult, image.fire);
  out.put(53, image.number).put(61, image.frequency_hz);
  out.put(85, image.fire.sound_speed).put(97, std::uint8_t{0}).put(98, image.range_step_m);
  out.put(106, static_cast<std::uint16_t>(rows)).put(108, static_cast<std::uint16_t>(beams));
  out.put(110, static_cast<std::uint32_t>(at)).put(114, static_cast<std::uint32_t>(rows * beams));
  out.put(118, static_cast<std::uint32_t>(at + rows * beams));
  out.put_bytes(kResultBytes, image.bearings.data(), table);
  return out.put_bytes(at, image.samples.data(), rows * beams).take();
}

}  // namespace isobath

// Sonar images as pings. The samples of a ping are views of the message, where they are 8 bits, or 16 bits
// little-endian; others are copied as real numbers, and those that are negative or not finite become 0.
#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/camera_pictures.hpp>
#include <isobath/io/ros/ros_decoding.hpp>
#include <span>

namespace isobath {
namespace {

constexpr Angle kImageHeight = Angle::degrees(20);  // of a multibeam imaging sonar that states none

/// dtype of marine_acoustic_msgs/SonarImageData.
enum SampleKind : std::uint8_t { kU8, kI8, kU16, kI16, kU32, kI32, kU64, kI64, kF32, kF64, kSampleKinds };
constexpr std::size_t kSampleBytes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

double sample_at(const RecordView& view, std::size_t at, SampleKind kind) {
  switch (kind) {
    case kU8: return view.at<std::uint8_t>(at);
    case kI8: return view.at<std::int8_t>(at);
    case kU16: return view.at<std::uint16_t>(at);
    case kI16: return view.at<std::int16_t>(at);
    case kU32: return view.at<std::uint32_t>(at);
    case kI32: return view.at<std::int32_t>(at);
    case kU64: return static_cast<double>(view.at<std::uint64_t>(at));
    case kI64: return static_cast<double>(view.at<std::int64_t>(at));
    case kF32: return static_cast<double>(view.at<float>(at));
    case kF64: return view.at<double>(at);
    case kSampleKinds: break;
  }
  return 0;
}

struct SonarImage {
  std::vector<double> azimuths;  ///< rad, positive to starboard
  double width = 0, height = 0;  ///< of a beam, rad; 0: not stated
  RangeWindow window;
  double sound_speed = 0;
  Bytes data;
  SampleKind kind = kU8;
  std::endian order = std::endian::little;
  Pose X_BS;
};

/// Even bins whose centres are these ranges; empty: they are not even.
std::optional<RangeWindow> window_of(const std::vector<double>& centres) {
  if (centres.size() < 2 || centres.size() > static_cast<std::size_t>(FrameGeometry::kMaxBins)) return {};
  const double bin = (centres.back() - centres.front()) / static_cast<double>(centres.size() - 1);
  if (!(bin > 0)) return {};
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (!(std::abs(centres[i] - centres.front() - bin * static_cast<double>(i)) < 0.25 * bin)) return {};
  }
  return RangeWindow{std::max(0.0, centres.front() - bin / 2), bin, static_cast<int>(centres.size())};
}

/// The fan of the azimuths, rising; empty: they neither rise nor fall.
std::optional<BeamFan> fan_of(const SonarImage& image, const InputConfig& config) {
  const std::vector<double>& a = image.azimuths;
  if (a.empty() || a.size() > static_cast<std::size_t>(FrameGeometry::kMaxBeams)) return {};
  const bool falls = a.size() > 1 && a[1] < a[0];
  BeamFan fan;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double azimuth = falls ? a[a.size() - 1 - i] : a[i];
    if (!std::isfinite(azimuth) || std::abs(azimuth) > 7 || (i > 0 && azimuth <= fan.azimuth.back().radians())) {
      return {};
    }
    fan.azimuth.push_back(Angle::radians(azimuth));
  }
  const double spacing = a.size() > 1 ? std::abs(a.back() - a.front()) / static_cast<double>(a.size() - 1) : 0;
  const auto stated = [](double value) { return std::isfinite(value) && value > 0 && value < 7; };
  const double width = stated(image.width) ? image.width : spacing;
  const BeamSize size = beam_size(config, {Angle::radians(width > 0 ? width : kImageHeight.radians()),
                                           stated(image.height) ? Angle::radians(image.height) : kImageHeight});
  fan.width.assign(a.size(), size.width);
  fan.height = size.height;
  return fan;
}

float full_scale_of(SampleKind kind) {
  switch (kind) {
    case kU8: return 255;
    case kI8: return 127;
    case kU16: return 65535;
    case kI16: return 32767;
    case kU32: return 4294967295.0F;
    case kI32: return 2147483647.0F;
    case kU64: return 18446744073709551615.0F;
    case kI64: return 9223372036854775807.0F;
    case kF32:
    case kF64:
    case kSampleKinds: break;
  }
  return 0;
}

/// Copies samples as real numbers. Those of floating point have the full scale 1, 255 or 65535 that holds the first
/// image.
const std::byte* as_real(const SonarImage& image, std::size_t count, RosContext& context, Ping& ping) {
  std::byte* const to = context.arena.take(count * sizeof(float));
  const RecordView view(image.data, image.order);
  double most = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = sample_at(view, i * kSampleBytes[image.kind], image.kind);
    const float sample = std::isfinite(value) && value > 0 ? static_cast<float>(std::min(value, 3e38)) : 0;
    most = std::max(most, static_cast<double>(sample));
    std::memcpy(to + i * sizeof(float), &sample, sizeof sample);
  }
  if (ping.full_scale <= 0) {
    if (context.float_scale <= 0)
      context.float_scale = most <= 1 ? 1 : most <= 255 ? 255 : most <= 65535 ? 65535 : most;
    ping.full_scale = static_cast<float>(context.float_scale);
  }
  ping.storage = context.arena.owner();
  return to;
}

const char* add_image(SonarImage image, const RosInput& input, RosContext& context, std::vector<Event>& events) {
  if (!input.message.ok()) return nullptr;  // the caller says what is missing
  if (!context.config.clockwise) {
    for (double& azimuth : image.azimuths) azimuth = -azimuth;
  }
  auto fan = fan_of(image, context.config);
  if (!fan) return "sonar image whose beams are not in the order of their bearings";
  const std::size_t beams = image.azimuths.size(), bins = static_cast<std::size_t>(image.window.bins);
  const std::size_t size = kSampleBytes[image.kind];
  if (bins == 0 || image.data.size() != beams * bins * size) return "sonar image whose size disagrees with its samples";
  const bool falls = beams > 1 && image.azimuths[1] < image.azimuths[0];
  Ping ping;
  ping.time = input.time;
  ping.fan = context.shared(*std::move(fan));
  ping.window = image.window;
  ping.X_BS = image.X_BS;
  ping.sound_speed =
      image.sound_speed > 0 && std::isfinite(image.sound_speed) ? image.sound_speed : context.config.sound_speed;
  ping.full_scale = full_scale_of(image.kind);
  ping.storage = input.owner;
  const bool little = image.order == std::endian::little;
  const bool direct = image.kind == kU8 || (image.kind == kU16 && little);
  const std::byte* samples = direct ? image.data.data() : as_real(image, beams * bins, context, ping);
  const auto type = !direct ? SampleType::kF32 : image.kind == kU8 ? SampleType::kU8 : SampleType::kU16;
  const auto step = static_cast<std::ptrdiff_t>(direct ? size : sizeof(float));
  const bool major = context.config.beam_major;
  std::ptrdiff_t beam_stride = step * (major ? static_cast<std::ptrdiff_t>(bins) : 1);
  const std::ptrdiff_t bin_stride = step * (major ? 1 : static_cast<std::ptrdiff_t>(beams));
  if (falls) {
    samples += beam_stride * static_cast<std::ptrdiff_t>(beams - 1);
    beam_stride = -beam_stride;
  }
  ping.intensity = Intensities(samples, type, static_cast<int>(beams), static_cast<int>(bins), beam_stride, bin_stride);
  if (const PingFault fault = check(ping); fault != PingFault::kNone) return to_text(fault);
  events.emplace_back(std::move(ping));
  return nullptr;
}

/// Whether the samples can stay where they are in the message.
std::optional<SampleType> sample_type_of(const SonarImage& image) {
  const bool little = image.order == std::endian::little;
  if (image.kind == kU8) return SampleType::kU8;
  if (image.kind == kU16 && little) return SampleType::kU16;
  if (image.kind == kF32 && little) return SampleType::kF32;
  return {};
}

/// The image with the geometry that a record states for it, exactly; false: there is none, or it does not fit.
bool add_recorded_image(const SonarImage& image, const RosInput& input, RosContext& context,
                        std::vector<Event>& events) {
  // A header cannot state the time 0, which counts as not set.
  auto ping = context.take_ping_record(input.message["header"]["stamp"].time().value_or(Time{}));
  const auto type = sample_type_of(image);
  if (!ping || !type || !input.message.ok()) return false;
  const auto beams = ping->fan->azimuth.size(), bins = static_cast<std::size_t>(ping->window.bins);
  const std::size_t size = kSampleBytes[image.kind];
  if (image.data.size() / size != beams * bins || image.data.size() % size != 0) return false;
  ping->storage = input.owner;
  ping->intensity = Intensities(image.data.data(), *type, static_cast<int>(beams), ping->window.bins,
                                static_cast<std::ptrdiff_t>(size), static_cast<std::ptrdiff_t>(size * beams));
  events.emplace_back(*std::move(ping));
  return true;
}

/// The first value of an array of beam widths; 0: not stated.
double first_of(const RosValue& widths) {
  const std::vector<double> all = widths.numbers();
  return all.empty() ? 0 : all.front();
}

/// What the messages of marine_acoustic_msgs share.
void read_common(const RosMessage& message, SonarImage& image) {
  const RosValue info = message["ping_info"], data = message["image"];
  image.sound_speed = info["sound_speed"].number();
  image.width = first_of(info["rx_beamwidths"]);
  image.height = first_of(info["tx_beamwidths"]);
  const std::uint64_t kind = data["dtype"].whole();
  image.kind = static_cast<SampleKind>(std::min<std::uint64_t>(kind, kSampleKinds));
  image.order = data["is_bigendian"].number() != 0 ? std::endian::big : std::endian::little;
  image.data = data["data"].bytes();
}

constexpr const char* kNoGeometry = "image whose geometry input.frame_geometry does not declare";

/// A picture whose rows and columns InputConfig::frame_geometry declares.
const char* add_picture(GrayImage image, const RosInput& input, RosContext& context, std::vector<Event>& events) {
  auto ping = ping_from_frame(*context.images, std::move(image), context.config);
  if (!ping) return "image of another size than input.frame_geometry declares";
  ping->time = input.time;
  ping->X_BS = context.mount(input.frame, RosAxes::kForwardPortUp);
  events.emplace_back(*std::move(ping));
  return nullptr;
}

constexpr const char* kUneven = "sonar image whose ranges are not evenly spaced";
constexpr const char* kUnknownSamples = "sonar image with samples of an unknown type";

}  // namespace

const char* decode_projected_image(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  SonarImage image;
  read_common(input.message, image);
  if (image.kind == kSampleKinds) return kUnknownSamples;
  if (add_recorded_image(image, input, context, events)) return nullptr;
  constexpr double kMaxOffPlane = 0.1;
  for (const RosValue& direction : input.message["beam_directions"].elements()) {
    if (std::abs(direction["x"].number()) > kMaxOffPlane) return "sonar image whose beams do not lie in one plane";
    image.azimuths.push_back(std::atan2(direction["y"].number(), direction["z"].number()));
  }
  const auto window = window_of(input.message["ranges"].numbers());
  if (!window) return input.message.ok() ? kUneven : nullptr;
  image.window = *window;
  image.X_BS = context.mount(input.frame, RosAxes::kUpStarboardForward);
  return add_image(std::move(image), input, context, events);
}

const char* decode_raw_image(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  SonarImage image;
  read_common(input.message, image);
  if (image.kind == kSampleKinds) return kUnknownSamples;
  image.azimuths = input.message["rx_angles"].numbers();
  const double rate = input.message["sample_rate"].number(), first = input.message["sample0"].number();
  const std::uint64_t bins = input.message["samples_per_beam"].whole();
  const double sound = image.sound_speed > 0 ? image.sound_speed : context.config.sound_speed;
  if (!(rate > 0) || bins > static_cast<std::uint64_t>(FrameGeometry::kMaxBins)) {
    return input.message.ok() ? "sonar image without a usable rate of samples" : nullptr;
  }
  const double bin = sound / (2 * rate);
  image.window = {first * bin, bin, static_cast<int>(bins)};
  image.X_BS = context.mount(input.frame, RosAxes::kUpStarboardForward);
  return add_image(std::move(image), input, context, events);
}

const char* decode_sonar_image(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  SonarImage image;
  image.azimuths = message["azimuth_angles"].numbers();
  image.width = message["azimuth_beamwidth"].number();
  image.height = message["elevation_beamwidth"].number();
  if (message.root().has("sound_speed")) image.sound_speed = message["sound_speed"].number();
  if (message["elevation_angles"].numbers().size() > 1) return "sonar image whose beams do not lie in one plane";
  const std::uint64_t size = message["data_size"].whole();
  if (size != 1 && size != 2 && size != 4) return message.ok() ? kUnknownSamples : nullptr;
  image.kind = size == 1 ? kU8 : size == 2 ? kU16 : kU32;
  image.order = message["is_bigendian"].number() != 0 ? std::endian::big : std::endian::little;
  image.data = message["intensities"].bytes();
  const auto window = window_of(message["ranges"].numbers());
  if (!window) return message.ok() ? kUneven : nullptr;
  image.window = *window;
  image.X_BS = context.mount(input.frame, RosAxes::kForwardStarboardDown);
  return add_image(std::move(image), input, context, events);
}

const char* decode_sonar_echo(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  const double angle = message["angle"].number(), range = message["range"].number();
  const Bytes samples = message["intensities"].bytes();
  if (!message.ok()) return nullptr;
  if (samples.empty() || samples.size() > static_cast<std::size_t>(FrameGeometry::kMaxBins) || !(range > 0) ||
      !std::isfinite(angle) || std::abs(angle) > 7) {
    return "echo with an impossible bearing or range";
  }
  const auto bins = static_cast<int>(samples.size());
  Ping ping = context.head.ping(Angle::radians(angle), {0, range / bins, bins}, samples.data(), input.owner);
  ping.time = input.time;
  ping.X_BS = context.mount(input.frame, RosAxes::kForwardPortUp);
  if (message.root().has("speed_of_sound") && message["speed_of_sound"].number() > 0) {
    ping.sound_speed = message["speed_of_sound"].number();
  }
  if (const PingFault fault = check(ping); fault != PingFault::kNone) return to_text(fault);
  events.emplace_back(std::move(ping));
  return nullptr;
}

const char* decode_image(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  if (!context.images) return kNoGeometry;
  const RosMessage& message = input.message;
  const std::string_view encoding = message["encoding"].text();
  const int bytes = encoding == "mono8" || encoding == "8UC1" ? 1 : encoding == "mono16" || encoding == "16UC1" ? 2 : 0;
  const std::uint64_t width = message["width"].whole(), height = message["height"].whole();
  const std::uint64_t step = message["step"].whole();
  const Bytes data = message["data"].bytes();
  if (!message.ok()) return nullptr;
  if (bytes == 0) return "image that is not of one grey channel (mono8, mono16)";
  const auto most = static_cast<std::uint64_t>(GrayImage::kMaxSide);
  const std::uint64_t row = width * static_cast<std::uint64_t>(bytes);
  if (width == 0 || height == 0 || width > most || height > most || step < row || data.size() < step * height) {
    return "image whose size disagrees with its samples";
  }
  GrayImage image{static_cast<int>(width), static_cast<int>(height), bytes, {}};
  image.samples.reserve(row * height);
  for (std::uint64_t y = 0; y < height; ++y) {
    const auto* const from = reinterpret_cast<const std::uint8_t*>(data.data()) + y * step;
    image.samples.insert(image.samples.end(), from, from + row);
  }
  if (bytes == 2 && message["is_bigendian"].number() != 0) {
    for (std::size_t i = 0; i + 1 < image.samples.size(); i += 2) std::swap(image.samples[i], image.samples[i + 1]);
  }
  return add_picture(std::move(image), input, context, events);
}

const char* decode_compressed_image(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  if (!context.images) return kNoGeometry;
  const Bytes data = input.message["data"].bytes();
  if (!input.message.ok()) return nullptr;
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(data.data()), data.size());
  constexpr std::uint8_t kPngStart = 0x89;
  try {
    if (!bytes.empty() && bytes[0] == kPngStart) {
      return add_picture(parse_gray_png(bytes, "image"), input, context, events);
    }
    const CameraImage picture = parse_camera_image(bytes, "image");
    GrayImage image{picture.width, picture.height, 1, {}};
    const auto step = static_cast<std::size_t>(picture.channels);  // the first channel, as of other pictures in colour
    for (std::size_t i = 0; i < picture.samples.size(); i += step) image.samples.push_back(picture.samples[i]);
    return add_picture(std::move(image), input, context, events);
  } catch (const Error&) {
    return "compressed image that cannot be read";
  }
}

}  // namespace isobath

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/bytes/log_source.hpp>
#include <isobath/io/formats/sonar3d.hpp>
#include <snappy.h>
#include <zlib.h>

namespace isobath {
namespace {

constexpr std::string_view kPacketMagic = "RIP2";
constexpr std::size_t kMinPacket = 4 + 4 + 1 + 4, kMaxPacketBytes = 1 << 20;
constexpr std::size_t kMaxPlain = 4 << 20;  // maximum unpacked size

Framing rip2_packet_at(Bytes bytes) {
  const std::string_view text = text_of(bytes);
  const std::size_t begun = std::min(text.size(), kPacketMagic.size());
  if (text.substr(0, begun) != kPacketMagic.substr(0, begun)) return noise_until(bytes, 'R');
  if (bytes.size() < 8) return {Framing::Kind::kIncomplete, 8};
  const std::size_t length = ByteCursor(bytes, 4).little<std::uint32_t>();
  if (length < kMinPacket || length > kMaxPacketBytes) return noise_until(bytes, 'R');
  if (bytes.size() < length) return {Framing::Kind::kIncomplete, length};
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(length - 4));
  if (ByteCursor(bytes, length - 4).little<std::uint32_t>() != sum) return noise_until(bytes, 'R');
  return {Framing::Kind::kFrame, length};
}

/// The fields of a protocol-buffer message (protobuf.dev, encoding), one after the other. A truncated or invalid
/// message ends early, and ok() is false.
class WireFields {
 public:
  explicit WireFields(Bytes message) : cursor_(message) {}

  bool next() {
    if (cursor_.left() == 0 || !ok_) return false;
    const std::uint64_t tag = varint(cursor_);
    number_ = tag >> 3;
    bytes_ = {};
    value_ = 0;
    switch (tag & 7) {
      case 0: value_ = varint(cursor_); break;
      case 1: value_ = cursor_.little<std::uint64_t>(); break;
      case 2:
        bytes_ = cursor_.take(static_cast<std::size_t>(std::min<std::uint64_t>(varint(cursor_), kMaxPlain)));
        break;
      case 5: value_ = cursor_.little<std::uint32_t>(); break;
      default: ok_ = false;
    }
    ok_ = ok_ && cursor_.ok() && number_ > 0;
    return ok_;
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::uint64_t number() const { return number_; }
  [[nodiscard]] std::uint64_t whole() const { return value_; }
  [[nodiscard]] float real() const { return std::bit_cast<float>(static_cast<std::uint32_t>(value_)); }
  [[nodiscard]] Bytes bytes() const { return bytes_; }

  /// A number with seven bits per byte, lowest bits first.
  static std::uint64_t varint(ByteCursor& cursor) {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 70; shift += 7) {
      const auto byte = cursor.little<std::uint8_t>();
      if (shift < 64) value |= static_cast<std::uint64_t>(byte & 0x7F) << shift;
      if ((byte & 0x80) == 0) return value;
    }
    cursor.skip(cursor.left() + 1);  // too long to be a number
    return 0;
  }

 private:
  ByteCursor cursor_;
  bool ok_ = true;
  std::uint64_t number_ = 0, value_ = 0;
  Bytes bytes_;
};

struct RangeImage {
  std::int64_t seconds = 0, nanoseconds = 0;
  float sound_speed = 0, range_m = 0, width_deg = 0, height_deg = 0, metres_a_count = 0;
  std::uint64_t width = 0, height = 0;
  std::vector<std::uint64_t> counts;
};

bool read_time(Bytes header, RangeImage& image) {
  WireFields fields(header);
  while (fields.next()) {
    if (fields.number() != 1) continue;
    WireFields time(fields.bytes());
    while (time.next()) {
      if (time.number() == 1) image.seconds = static_cast<std::int64_t>(time.whole());
      if (time.number() == 2) image.nanoseconds = static_cast<std::int64_t>(time.whole());
    }
    if (!time.ok()) return false;
  }
  return fields.ok();
}

bool read_image(Bytes message, RangeImage& image) {
  WireFields fields(message);
  bool good = true;
  while (fields.next()) {
    switch (fields.number()) {
      case 1: good = good && read_time(fields.bytes(), image); break;
      case 2: image.sound_speed = fields.real(); break;
      case 3: image.range_m = fields.real(); break;
      case 5: image.width = fields.whole(); break;
      case 6: image.height = fields.whole(); break;
      case 7: image.width_deg = fields.real(); break;
      case 8: image.height_deg = fields.real(); break;
      case 9: image.metres_a_count = fields.real(); break;
      case 10: {
        ByteCursor packed(fields.bytes());
        while (packed.left() > 0 && packed.ok()) image.counts.push_back(WireFields::varint(packed));
        good = good && packed.ok();
        break;
      }
      default: break;
    }
  }
  return good && fields.ok();
}

/// Why the image is invalid; null if it is valid.
const char* fault_of(const RangeImage& image) {
  const auto within = [](float value, float most) { return value > 0 && value <= most; };
  if (image.width < 2 || image.height < 2 || image.width > Swath::kMaxSoundings ||
      image.height > Swath::kMaxSoundings || image.width * image.height > Swath::kMaxSoundings ||
      image.counts.size() != image.width * image.height) {
    return "image whose size disagrees with its echoes";
  }
  if (!within(image.width_deg, 360) || !within(image.height_deg, 180)) return "image with an impossible view";
  if (!within(image.metres_a_count, 10)) return "image with an impossible scale";
  if (!representable_seconds(static_cast<double>(image.seconds)) || image.nanoseconds < 0 ||
      image.nanoseconds >= 1'000'000'000) {
    return "time out of range";
  }
  return nullptr;
}

class Sonar3d final : public LogSource {
 public:
  Sonar3d(ByteWindow input, const InputConfig& config) : LogSource(std::move(input), "Sonar 3D-15") {
    X_BS_.rotation = Rotation::from_heading_pitch_roll(config.mount_heading, config.mount_pitch, config.mount_roll);
    X_BS_.translation = Eigen::Vector3d(config.mount_m[0], config.mount_m[1], config.mount_m[2]);
  }

 private:
  std::optional<Event> read() override {
    while (const auto packet = next_frame(input_, rip2_packet_at, report_)) {
      if (auto event = take(packet->subspan(8, packet->size() - 12))) return event;
    }
    return {};
  }
  std::optional<Event> take(Bytes payload);
  [[nodiscard]] Swath swath_of(const RangeImage& image) const;

  Pose X_BS_;
  std::string plain_;
  std::uint64_t others_ = 0;
};

std::optional<Event> Sonar3d::take(Bytes payload) {
  const std::string_view packed = text_of(payload);
  std::size_t size = 0;
  const bool fits = snappy::GetUncompressedLength(packed.data(), packed.size(), &size) && size <= kMaxPlain;
  if (!fits || !snappy::Uncompress(packed.data(), packed.size(), &plain_)) {
    reject("packet that cannot be unpacked");
    return {};
  }
  std::string_view type;
  Bytes message;
  WireFields packet(bytes_of(plain_));
  while (packet.next()) {
    if (packet.number() != 1) continue;
    WireFields any(packet.bytes());
    while (any.next()) {
      if (any.number() == 1) type = text_of(any.bytes());
      if (any.number() == 2) message = any.bytes();
    }
  }
  if (!type.ends_with("RangeImage")) {
    report_.details["other packets"] = fmt::format("{}, not read", ++others_);
    return {};
  }
  RangeImage image;
  const char* fault = read_image(message, image) ? fault_of(image) : "truncated image";
  if (fault) {
    reject(fault);
    return {};
  }
  report_.note_setting("sonar", fmt::format("Sonar 3D-15, {} x {} beams, {:g} x {:g} deg, {:g} m", image.width,
                                            image.height, image.width_deg, image.height_deg, image.range_m));
  return swath_of(image);
}

Swath Sonar3d::swath_of(const RangeImage& image) const {
  Swath swath;
  swath.time = Time{std::chrono::seconds(image.seconds) + std::chrono::nanoseconds(image.nanoseconds)};
  swath.frame = Swath::Frame::kBody;
  swath.beam_width = Angle::degrees(image.width_deg / static_cast<double>(image.width));
  swath.sound_speed = std::isfinite(image.sound_speed) ? image.sound_speed : 0;
  const auto direction = [](float view_deg, std::uint64_t i, std::uint64_t n) {
    return Angle::degrees(view_deg * (static_cast<double>(i) / static_cast<double>(n - 1) - 0.5)).radians();
  };
  for (std::uint64_t row = 0; row < image.height; ++row) {
    const double pitch = direction(image.height_deg, row, image.height);
    for (std::uint64_t column = 0; column < image.width; ++column) {
      const std::uint64_t beam = row * image.width + column;
      const double range = image.metres_a_count * static_cast<double>(image.counts[beam]);
      if (image.counts[beam] == 0 || range > 1e4) continue;
      const double yaw = direction(image.width_deg, column, image.width);
      const Eigen::Vector3d p_S(range * std::cos(pitch) * std::cos(yaw), range * std::cos(pitch) * std::sin(yaw),
                                range * std::sin(pitch));
      swath.soundings.push_back({(X_BS_ * p_S).cast<float>(), static_cast<float>(range), 0,
                                 static_cast<std::uint16_t>(beam), Sounding::Kind::kWater});
    }
  }
  return swath;
}

}  // namespace

bool looks_like_sonar3d(Bytes head) {
  return text_of(head).starts_with(kPacketMagic) && head.size() >= 8 &&
         ByteCursor(head, 4).little<std::uint32_t>() <= kMaxPacketBytes;
}

std::unique_ptr<Source> open_sonar3d(ByteWindow input, const InputConfig& config) {
  return std::make_unique<Sonar3d>(std::move(input), config);
}

}  // namespace isobath

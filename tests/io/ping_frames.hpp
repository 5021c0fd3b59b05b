// Writers of Blue Robotics frames and of Ping Viewer logs, made from the published layouts alone.
#pragma once

#include <cstdio>
#include <isobath/base/random.hpp>
#include <tests/io/bytes_by_hand.hpp>

namespace isobath::test {

inline std::string ping_protocol_frame(std::uint16_t id, const std::string& payload, int source = 2) {
  std::string frame = "BR" + little(static_cast<std::uint16_t>(payload.size())) + little(id);
  frame += static_cast<char>(source);
  frame += '\0';
  frame += payload;
  std::uint32_t sum = 0;
  for (const char c : frame) sum += static_cast<unsigned char>(c);
  return frame + little(static_cast<std::uint16_t>(sum));
}

struct Ping360Message {
  int angle = 200;
  int sample_period = 88;
  std::string samples = std::string("\xff\x80\x40\x20\x10\x08", 6);

  [[nodiscard]] std::string frame() const {
    const auto count = little(static_cast<std::uint16_t>(samples.size()));
    return ping_protocol_frame(2300, std::string("\x01\x00", 2) + little(static_cast<std::uint16_t>(angle)) +
                                         little(std::uint16_t{32}) + little(static_cast<std::uint16_t>(sample_period)) +
                                         little(std::uint16_t{750}) + count + count + samples);
  }
};

/// Frames of a turning head with samples drawn at random, the same for the same seed.
inline std::vector<std::string> ping360_frames(int count, int bins, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::string> frames;
  for (int i = 0; i < count; ++i) {
    Ping360Message message;
    message.angle = i % 400;
    message.samples.resize(static_cast<std::size_t>(bins));
    for (char& c : message.samples) c = static_cast<char>(random.index(256));
    frames.push_back(message.frame());
  }
  return frames;
}

/// Writes what Ping Viewer writes: texts in UTF-16BE (or UTF-8, as a re-encoder does), big-endian counts.
class PingViewerWriter {
 public:
  explicit PingViewerWriter(int device_type = 2, bool wide = true) : wide_(wide) {
    log_ = text("PingViewer sensor log file") + big(std::uint32_t{1}) + text("0123abc") + text("2024-01-01") +
           text("v2.4.0") + text("Linux") + text("12") + big(std::uint32_t{1}) +
           big(static_cast<std::uint32_t>(device_type));
  }
  /// Returns where the record begins.
  std::size_t add(int milliseconds, const std::string& bytes) {
    const std::size_t at = log_.size();
    char stamp[32];
    std::snprintf(stamp, sizeof stamp, "%02d:%02d:%02d.%03d", milliseconds / 3'600'000 % 24, milliseconds / 60'000 % 60,
                  milliseconds / 1000 % 60, milliseconds % 1000);
    log_ += text(stamp) + big(static_cast<std::uint32_t>(bytes.size())) + bytes;
    return at;
  }
  [[nodiscard]] const std::string& log() const { return log_; }

 private:
  [[nodiscard]] std::string text(const std::string& ascii) const {
    std::string bytes;
    for (const char c : ascii) {
      if (wide_) bytes += '\0';
      bytes += c;
    }
    return big(static_cast<std::uint32_t>(bytes.size())) + bytes;
  }
  bool wide_;
  std::string log_;
};

}  // namespace isobath::test

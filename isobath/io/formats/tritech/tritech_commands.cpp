#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/bytes/record_writer.hpp>
#include <isobath/io/formats/tritech/tritech_commands.hpp>

namespace isobath {
namespace {

constexpr std::uint8_t kHost = 255, kSingleMessage = 0x80, kImagingHead = 0x11;
constexpr std::size_t kAround = 14, kAt = 13;  // bytes around a payload, and its offset
constexpr std::size_t kHeadCommandBytes = 52;
constexpr std::uint8_t kNoSettings = 1 << 6, kScanning = 1 << 5;
constexpr std::uint16_t kHeadControl = 0x2304;  // raw, has a motor, replies in ASL, scans to the right
constexpr std::uint8_t kFullSpan = 255;         // of 80 dB

/// A frame with an empty payload. `byte_count`: as the header states it; 0 for a line of echo.
RecordWriter tritech_message(std::uint8_t id, std::uint8_t from, std::uint8_t to, std::size_t payload, bool counts) {
  const auto length = static_cast<std::uint16_t>(payload + 8);
  RecordWriter out(payload + kAround);
  out.put(0, '@').put_text(1, 4, fmt::format("{:04X}", length)).put(5, length).put(7, from).put(8, to);
  out.put(9, static_cast<std::uint8_t>(counts ? length - 5 : 0)).put(10, id).put(11, kSingleMessage);
  out.put(12, from == kHost ? to : from).put(kAt + payload, '\n');
  return out;
}

RecordWriter tritech_to_head(std::uint8_t id, std::size_t payload) {
  return tritech_message(id, kHost, tritech::kImagingNode, payload, true);
}

std::uint16_t control_of(const TritechSettings& s) {
  return static_cast<std::uint16_t>(kHeadControl | tritech::kEightBit | (s.full_circle ? tritech::kContinuous : 0));
}

std::uint8_t sweep_code(const TritechSettings& s, int bearing) {
  constexpr std::uint8_t kInside = 0, kAtLeft = 1, kAtRight = 2;
  if (s.full_circle) return kInside;
  if (bearing == s.left_limit) return kAtLeft;
  return bearing == s.right_limit ? kAtRight : kInside;
}

std::optional<TritechSettings> settings_in(Bytes payload) {
  if (payload.size() < kHeadCommandBytes) return std::nullopt;
  const RecordView view(payload);
  TritechSettings s;
  s.full_circle = (view.at<std::uint16_t>(1) & tritech::kContinuous) != 0;
  s.range_scale = view.at<std::uint16_t>(22);
  s.left_limit = view.at<std::uint16_t>(24);
  s.right_limit = view.at<std::uint16_t>(26);
  s.gain = view.at<std::uint8_t>(30);
  s.step = view.at<std::uint8_t>(37);
  s.bin_time = view.at<std::uint16_t>(38);
  s.bins = view.at<std::uint16_t>(40);
  const bool right = s.left_limit < tritech::kTurn && s.right_limit < tritech::kTurn && s.step > 0 && s.bin_time > 0 &&
                     s.bins > 0 && s.bins <= tritech::kMaxBins;
  return right ? std::optional(s) : std::nullopt;
}

}  // namespace

TritechSettings tritech_settings(const TritechScan& scan) {
  TritechSettings s;
  const double travel_s = 2 * scan.range_m / scan.sound_speed;
  const long most = std::clamp(scan.samples, 1, tritech::kMaxBins);
  const long unit =
      std::clamp(std::lround(travel_s / (static_cast<double>(most) * tritech::kBinTimeUnit_s)), 1L, 65535L);
  s.bin_time = static_cast<std::uint16_t>(unit);
  s.bins = static_cast<std::uint16_t>(
      std::clamp(std::lround(travel_s / (static_cast<double>(unit) * tritech::kBinTimeUnit_s)), 1L, most));
  s.range_scale = static_cast<std::uint16_t>(std::clamp(std::lround(scan.range_m * 10), 1L, 0x3fffL));
  s.gain = static_cast<std::uint8_t>(std::lround(std::clamp(scan.gain_percent, 0, 100) * 2.1));
  s.step = static_cast<std::uint8_t>(
      std::clamp(std::lround(scan.step.radians() * tritech::kAhead / std::numbers::pi), 1L, 255L));
  s.full_circle = scan.sector.degrees() >= 359;
  if (!s.full_circle) {
    s.left_limit = tritech::sixteenths(scan.middle - scan.sector / 2);
    s.right_limit = tritech::sixteenths(scan.middle + scan.sector / 2);
  }
  return s;
}

TritechBytes tritech_send_version() { return tritech_to_head(tritech::kSendVersion, 0).take(); }

TritechBytes tritech_send_data() { return tritech_to_head(tritech::kSendData, 4).take(); }

TritechBytes tritech_head_command(const TritechSettings& s) {
  RecordWriter out = tritech_to_head(tritech::kHeadCommand, kHeadCommandBytes);
  out.put(kAt, std::uint8_t{1}).put(kAt + 1, control_of(s)).put(kAt + 3, kImagingHead);
  out.put(kAt + 22, s.range_scale).put(kAt + 24, s.left_limit).put(kAt + 26, s.right_limit);
  out.put(kAt + 28, kFullSpan).put(kAt + 29, std::uint8_t{0}).put(kAt + 30, s.gain).put(kAt + 31, s.gain);
  out.put(kAt + 36, std::uint8_t{25}).put(kAt + 37, s.step).put(kAt + 38, s.bin_time).put(kAt + 40, s.bins);
  out.put(kAt + 42, std::uint16_t{500}).put(kAt + 44, std::uint16_t{100}).put(kAt + 46, std::uint16_t{1600});
  return out.put(kAt + 48, std::uint8_t{1}).take();
}

std::optional<TritechRequest> tritech_request(const TritechFrame& frame) {
  using Kind = TritechRequest::Kind;
  switch (frame.id) {
    case tritech::kSendVersion: return TritechRequest{Kind::kSendVersion, {}};
    case tritech::kReboot: return TritechRequest{Kind::kReboot, {}};
    case tritech::kSendData: return TritechRequest{Kind::kSendData, {}};
    case tritech::kHeadCommand: {
      const auto settings = settings_in(frame.payload);
      return settings ? std::optional(TritechRequest{Kind::kHeadCommand, *settings}) : std::nullopt;
    }
    default: return std::nullopt;
  }
}

std::optional<TritechAlive> tritech_alive(const TritechFrame& frame) {
  if (frame.id != tritech::kAlive || frame.payload.size() < 8) return std::nullopt;
  return TritechAlive{(RecordView(frame.payload).at<std::uint8_t>(7) & kNoSettings) != 0};
}

TritechBytes tritech_alive_bytes(const TritechAlive& alive) {
  RecordWriter out = tritech_message(tritech::kAlive, tritech::kImagingNode, kHost, 8, true);
  return out.put(kAt + 7, alive.has_no_settings ? kNoSettings : kScanning).take();
}

TritechBytes tritech_version_bytes(std::uint16_t serial_number) {
  RecordWriter out = tritech_message(tritech::kVersionData, tritech::kImagingNode, kHost, 11, true);
  out.put(kAt, std::uint8_t{1}).put(kAt + 2, serial_number);
  return out.put(kAt + 10, tritech::kImagingNode).take();
}

TritechBytes tritech_line_bytes(const TritechSettings& s, int bearing, Bytes samples) {
  constexpr std::size_t kBeforeBins = 31;  // in the payload
  const std::size_t payload = kBeforeBins + samples.size();
  RecordWriter out = tritech_message(tritech::kHeadData, tritech::kImagingNode, kHost, payload, false);
  out.put(kAt, static_cast<std::uint16_t>(payload)).put(kAt + 2, kImagingHead).put(kAt + 3, std::uint8_t{1 << 4});
  out.put(kAt + 4, sweep_code(s, bearing)).put(kAt + 5, control_of(s));
  out.put(kAt + 7, s.range_scale).put(kAt + 13, s.gain).put(kAt + 16, kFullSpan).put(kAt + 20, s.bin_time);
  out.put(kAt + 22, s.left_limit).put(kAt + 24, s.right_limit).put(kAt + 26, s.step);
  out.put(kAt + 27, static_cast<std::uint16_t>(bearing)).put(kAt + 29, static_cast<std::uint16_t>(samples.size()));
  return out.put_bytes(kAt + kBeforeBins, samples.data(), samples.size()).take();
}

}  // namespace isobath

#include <algorithm>
#include <fmt/format.h>
#include <isobath/io/formats/tritech/tritech_device.hpp>

namespace isobath {
namespace {

constexpr BeamSize kBeam{Angle::degrees(3), Angle::degrees(35)};
constexpr double kByteTime = 10.0 / 115200;  // s: default serial line of the head, slower than its motor
constexpr std::size_t kMaxJoined = 65536;

SweepMark sweep_mark(const TritechLine& line) {
  if (line.head_control & tritech::kContinuous) return SweepMark::kUnknown;  // a full circle has no limits
  return line.sweep_code == 1 || line.sweep_code == 2 ? SweepMark::kEnd : SweepMark::kInside;
}

}  // namespace

TritechDevice::TritechDevice(const InputConfig& config, SourceReport& report)
    : report_(report), head_(config, kBeam), high_nibble_first_(config.high_nibble_first) {}

std::optional<Event> TritechDevice::event(Bytes bytes, Time time, const std::shared_ptr<const void>& owner) {
  const TritechFrame frame = tritech_frame(bytes);
  if (frame.id != tritech::kHeadData) return {};
  if (frame.source != tritech::kImagingNode) {
    ++report_.rejected[to_text(MessageFault::kOtherDevice)];
    return {};
  }
  if (frame.last && frame.sequence == 0) {
    packets_joined_ = 0;
    return line(frame.payload, time, owner);
  }
  const auto payload = join(frame);
  if (!payload) return {};
  std::byte* copy = arena_.take(payload->size());
  std::copy(payload->begin(), payload->end(), copy);
  return line({copy, payload->size()}, time, arena_.owner());
}

std::optional<Bytes> TritechDevice::join(const TritechFrame& frame) {
  if (frame.sequence == 0) {
    packets_.clear();
    packets_joined_ = 0;
  }
  if (frame.sequence != packets_joined_ || packets_.size() + frame.payload.size() > kMaxJoined) {
    ++report_.rejected["message with a packet missing"];
    packets_joined_ = 0;
    return {};
  }
  packets_.insert(packets_.end(), frame.payload.begin(), frame.payload.end());
  ++packets_joined_;
  if (!frame.last) return {};
  packets_joined_ = 0;
  return packets_;
}

std::optional<Event> TritechDevice::line(Bytes payload, Time time, const std::shared_ptr<const void>& owner) {
  const auto line = tritech_line(payload);
  if (!line) {
    ++report_.rejected[to_text(line.error())];
    return {};
  }
  const std::array<int, 7> setting{line->head_control, line->range_scale, line->gain,  line->db_span,
                                   line->db_low,       line->bin_time,    line->bins()};
  if (described_ != setting) describe(*line);
  described_ = setting;
  if (!line->widths_agree()) {
    report_.details["sample width"] =
        fmt::format("command and head status disagree in {} lines; the command is used", ++widths_disagree_);
  }
  const std::byte* samples = line->samples.data();
  if (!line->eight_bit()) {
    std::byte* unpacked = arena_.take(2 * line->samples.size());
    unpack_nibbles(line->samples, high_nibble_first_, unpacked);
    samples = unpacked;
  }
  Ping ping = head_.ping(tritech::bearing(line->bearing), {0, line->bin_m(head_.sound_speed()), line->bins()}, samples,
                         line->eight_bit() ? owner : arena_.owner());
  ping.time = time;
  ping.full_scale = line->eight_bit() ? 255 : 15;
  ping.sweep = sweep_mark(*line);
  interval_ = seconds(2 * ping.window.end_m() / head_.sound_speed() + double(payload.size() + 14) * kByteTime);
  return ping;
}

void TritechDevice::describe(const TritechLine& line) {
  const double c = head_.sound_speed();
  const double full = line.eight_bit() ? 255 : 15;
  report_.details["sonar"] =
      fmt::format("Tritech imaging head, beam {:g} x {:g} degrees{}", head_.beam().width.degrees(),
                  head_.beam().height.degrees(), line.head_control & tritech::kInverted ? ", mounted upside down" : "");
  report_.note_setting("gain", fmt::format("{:.0f} %, {:.0f} dB from {:.0f} dB", line.gain / 2.1,
                                           line.db_span * 80 / full, line.db_low * 80 / full));
  report_.note_setting("range", fmt::format("{:.4g} m in {} bins of {:.4g} mm, {} bits{}", line.bin_m(c) * line.bins(),
                                            line.bins(), line.bin_m(c) * 1e3, line.eight_bit() ? 8 : 4,
                                            line.bin_time > 0 ? "" : ", by its label: the bin time is missing"));
  report_.details["sound speed"] = fmt::format("{:g} m/s, as configured: the log does not state it", c);
}

}  // namespace isobath

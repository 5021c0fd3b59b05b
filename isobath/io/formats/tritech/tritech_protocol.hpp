// The serial protocol of Tritech heads (Micron DST, Seanet): frames and the head data that they carry.
//
// Source: the open drivers ros-tritech-micron and drivers-sonar_tritech, which agree on the fields that are read here.
// '@', four hexadecimal digits L, u16 L, source, destination, byte count, message id, sequence, node, payload of L - 8
// bytes, line feed; numbers little-endian. There is no checksum: the two lengths, the line feed and the lengths of
// known types must agree. The drivers disagree on the order of 4-bit samples: InputConfig::high_nibble_first.
#pragma once

#include <isobath/io/bytes/framing.hpp>

namespace isobath {

Framing tritech_frame_at(Bytes bytes);

struct TritechFrame {
  std::uint8_t source = 0;
  std::uint8_t id = 0;
  std::uint8_t sequence = 0;  ///< index of the packet
  bool last = true;           ///< last packet of its message
  Bytes payload;
};
/// The parts of a frame from tritech_frame_at.
TritechFrame tritech_frame(Bytes frame);

namespace tritech {
constexpr std::uint8_t kVersionData = 1;
constexpr std::uint8_t kHeadData = 2;
constexpr std::uint8_t kAlive = 4;
constexpr std::uint8_t kReboot = 16;
constexpr std::uint8_t kHeadCommand = 19;
constexpr std::uint8_t kSendVersion = 23;
constexpr std::uint8_t kSendData = 25;
constexpr std::uint8_t kImagingNode = 2;
constexpr int kMaxBins = 1500;
constexpr double kBinTimeUnit_s = 640e-9;        ///< of ADInterval, two-way travel
constexpr int kTurn = 6400, kAhead = kTurn / 2;  ///< in 1/16 gradian

/// The range in the label RangeScale: 14 bits of tenths, 2 bits of unit (metre, foot, fathom, yard).
double range_scale_m(std::uint16_t range_scale);
/// Converts 1/16 gradian to an angle clockwise from ahead: 3200 is ahead, 4800 starboard.
inline Angle bearing(int sixteenth) { return Angle::radians((sixteenth - kAhead) * (std::numbers::pi / kAhead)); }
/// The converse, 0..6399.
std::uint16_t sixteenths(Angle bearing);

/// Bits of HdCtrl.
constexpr std::uint16_t kEightBit = 1 << 0;
constexpr std::uint16_t kContinuous = 1 << 1;
constexpr std::uint16_t kInverted = 1 << 3;
}  // namespace tritech

/// mtHeadData of an imaging head: one line of echo.
struct TritechLine {
  std::uint8_t head_status = 0;
  std::uint8_t sweep_code = 0;     ///< 0 inside, 1 at the left limit, 2 at the right limit, 5 centre
  std::uint16_t head_control = 0;  ///< HdCtrl
  std::uint16_t range_scale = 0;
  std::uint8_t gain = 0;  ///< 0..210
  std::uint8_t db_span = 0;
  std::uint8_t db_low = 0;
  std::uint16_t bin_time = 0;  ///< ADInterval, units of 640 ns of two-way travel
  std::uint16_t bearing = 0;   ///< 1/16 gradian, 0..6399, 3200 ahead
  Bytes samples;               ///< nearest first; two per byte in 4-bit mode

  [[nodiscard]] bool eight_bit() const { return head_control & tritech::kEightBit; }
  /// Whether the head status agrees with the command that it echoes. If not, the command is used.
  [[nodiscard]] bool widths_agree() const { return eight_bit() == ((head_status & 1 << 4) != 0); }
  [[nodiscard]] int bins() const { return static_cast<int>(samples.size()) * (eight_bit() ? 1 : 2); }
  /// Bin length from the bin time, or from the label if the bin time is missing.
  [[nodiscard]] double bin_m(double sound_speed) const;
};
/// `payload`: of an mtHeadData message, all packets joined.
Result<TritechLine, MessageFault> tritech_line(Bytes payload);

/// Unpacks two samples per byte: `out` receives 2 x packed.size() values 0..15.
void unpack_nibbles(Bytes packed, bool high_first, std::byte* out);

}  // namespace isobath

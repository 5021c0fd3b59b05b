// MAVLink frames, versions 1 and 2 (mavlink.io, serialization): framing, checksum, and the fields of a payload.
//
// Version 2: FD, length, incompatible flags (bit 0: a signature of 13 bytes follows), compatible flags, sequence,
// system, component, 24-bit message number, payload, CRC-16/MCRF4XX. Version 1: FE, length, sequence, system,
// component, 8-bit message number, payload, CRC. The checksum covers all bytes after the first and one byte of the
// message's definition (CRC_EXTRA), so that only the messages of the table below can be checked. A sender drops
// trailing zeros of the payload: fields beyond its end read as zero. Signatures: mavlink_signature.hpp.
//
// The table has the messages that ArduSub and ground stations write; its bytes were computed from the definitions, and
// each that occurs in 43 thousand frames of a BlueROV2 agrees with those frames.
#pragma once

#include <isobath/io/bytes/bytes.hpp>
#include <isobath/io/bytes/framing.hpp>
#include <isobath/io/formats/mavlink/mavlink_signature.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace isobath {

/// Numbers of the messages that have a decoder.
enum class MavlinkId : std::uint32_t {
  kScaledPressure = 29,
  kAttitude = 30,
  kLocalPositionNed = 32,
  kGlobalPositionInt = 33,
  kGpsGlobalOrigin = 49,
  kDistanceSensor = 132,
  kScaledPressure2 = 137,
  kRangefinder = 173,
  kOdometry = 331
};

struct MavlinkKind {
  std::uint32_t id = 0;
  std::string_view name;
  std::uint8_t crc_extra = 0;
};
/// Null: a message that the table lacks.
const MavlinkKind* mavlink_kind(std::uint32_t id);

/// The fields of a payload by their offsets, filled with zeros up to the longest length.
class MavlinkPayload {
 public:
  explicit MavlinkPayload(Bytes payload) { std::memcpy(bytes_.data(), payload.data(), payload.size()); }
  template <class T>
  [[nodiscard]] T at(std::size_t offset) const {
    return RecordView(bytes_).at<T>(offset);
  }

 private:
  std::array<std::byte, 256> bytes_{};
};

struct MavlinkFrame {
  enum class Checksum : std::uint8_t { kRight, kWrong, kUnknown };
  std::uint32_t id = 0;
  std::uint8_t system = 0, component = 0, sequence = 0;
  Bytes payload;
  Checksum checksum = Checksum::kUnknown;  ///< kUnknown: of a message that the table lacks
};

/// Makes frames of version 2, signed if there is a key; numbers them in sequence.
class MavlinkWriter {
 public:
  MavlinkWriter(std::uint8_t system, std::uint8_t component) : system_(system), component_(component) {}
  void sign_with(const MavlinkKey& key) { signer_.emplace(key); }
  /// The vehicle's system, once it is known.
  void set_system(std::uint8_t system) { system_ = system; }
  /// `payload`: up to the last field; trailing zeros are not sent. `id`: of the table. `now`: of the signature.
  std::vector<std::byte> frame(std::uint32_t id, Bytes payload, Time now = {});

 private:
  std::uint8_t system_, component_, sequence_ = 0;
  std::optional<MavlinkSigner> signer_;
};

/// The verdict on the structure of a frame at the first byte, as far as its head goes; its checksum is not looked at.
Framing mavlink_structure_at(Bytes bytes);
/// The same, where a wrong checksum is noise of one byte; for links, on which frames follow one another.
Framing mavlink_frame_at(Bytes bytes);
/// The parts of a complete frame.
MavlinkFrame mavlink_frame(Bytes frame);

}  // namespace isobath

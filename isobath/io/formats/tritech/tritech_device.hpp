// TritechDevice: converts the frames of a Tritech imaging head to pings.
//
// Bearing 3200 is ahead (the transducer's boss forward), growing clockwise for an upright head; a head that is mounted
// upside down with its invert bit set corrects the bearing itself. Range follows from the bin time and the host's speed
// of sound, not from the range label. Beam 3 x 35 degrees. Sweep codes become sweep marks if the head scans a sector.
#pragma once

#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/formats/tritech/tritech_protocol.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {

class TritechDevice {
 public:
  /// `report` must outlive this object.
  TritechDevice(const InputConfig& config, SourceReport& report);

  /// The event of one frame from tritech_frame_at; `owner` keeps its bytes alive.
  std::optional<Event> event(Bytes bytes, Time time, const std::shared_ptr<const void>& owner);
  /// For logs without times: estimated time from the last event to the next, for listening and the serial line.
  [[nodiscard]] Duration interval() const { return interval_; }

 private:
  /// The joined payload of a message of several packets, after its last packet.
  std::optional<Bytes> join(const TritechFrame& frame);
  std::optional<Event> line(Bytes payload, Time time, const std::shared_ptr<const void>& owner);
  void describe(const TritechLine& line);

  SourceReport& report_;
  ScanningHead head_;
  bool high_nibble_first_;
  SampleArena arena_;
  std::vector<std::byte> packets_;
  int packets_joined_ = 0;
  std::uint64_t widths_disagree_ = 0;
  Duration interval_{};
  std::array<int, 7> described_{};
};

}  // namespace isobath

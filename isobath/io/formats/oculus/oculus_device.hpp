// OculusDevice: converts the messages of an Oculus multibeam sonar to pings.
//
// Bearings come from the table in each message (starboard positive); ranges are (row + 0.5) x step from the head. 8-bit
// and 16-bit samples are viewed in place; wider samples are converted to floats. Samples are not corrected: the report
// states the gains per row and gamma, but no public document describes how to remove them. The message does not state
// the beam size: it is that of the model if the frequency identifies the model, else the width is the beam spacing and
// the height 20 degrees.
#pragma once

#include <array>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/formats/oculus/oculus_protocol.hpp>
#include <isobath/io/input/scanning_head.hpp>

namespace isobath {

class OculusDevice {
 public:
  /// `report` must outlive this object.
  OculusDevice(const InputConfig& config, SourceReport& report);

  /// The event of one message from oculus_message_at; `owner` keeps its bytes alive. `time`: the recorder's time, if
  /// there is one. Otherwise the event gets the device's time since power-up, or a time estimated from the ping rate.
  std::optional<Event> event(Bytes message, std::optional<Time> time, const std::shared_ptr<const void>& owner);

 private:
  struct CachedFan {
    std::vector<std::byte> bearings;
    std::uint64_t frequency_bits;  ///< bits of the number, so that NaN equals itself
    std::shared_ptr<const BeamFan> fan;
    bool mirrored;  ///< the table runs from starboard to port
  };
  Result<const CachedFan*, MessageFault> fan(const OculusPing& ping);
  Time made_time(const OculusPing& ping);
  Intensities samples(const OculusPing& ping, bool mirrored, const std::shared_ptr<const void>& owner, Ping& out);
  void describe(const OculusPing& ping);

  InputConfig config_;
  SourceReport& report_;
  Pose X_BS_;
  std::vector<CachedFan> fans_;
  SampleArena arena_;
  std::optional<std::uint32_t> last_id_;
  Time last_time_{};
  std::array<double, 6> described_{};
};

}  // namespace isobath

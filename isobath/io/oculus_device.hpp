// OculusDevice: what an Oculus says, message by message, as pings of a fan of beams.
//
// Bearings come from the table in each message (starboard positive), ranges are (row + 0.5) x step from the head. 8-bit
// and 16-bit samples are viewed in place, wider ones become floats. Samples are left as they are: gains per row and
// gamma are named in the report, not undone, since no public document says how. The message has no beam size: it is
// that of the model where the frequency tells it, else the spacing of the beams, 20 degrees high.
#pragma once

#include <array>
#include <isobath/io/oculus_protocol.hpp>
#include <isobath/io/sample_arena.hpp>
#include <isobath/io/scanning_head.hpp>

namespace isobath {

class OculusDevice {
 public:
  /// `report` must live as long as this.
  OculusDevice(const InputConfig& config, SourceReport& report);

  /// The event of one message of oculus_message_at, whose bytes `owner` keeps. `time`: of the recorder, where there is
  /// one; else the device's own time since power-up, or one made from the ping rate.
  std::optional<Event> event(Bytes message, std::optional<Time> time, const std::shared_ptr<const void>& owner);

 private:
  struct CachedFan {
    std::vector<std::byte> bearings;
    std::uint64_t frequency_bits;  ///< of the number, so that one that is none equals itself
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

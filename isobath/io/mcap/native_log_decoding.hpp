// Events and ground truth from records of the native log. Records are untrusted: empty results for sizes that disagree,
// states that do not exist, and poses whose quaternion is no rotation. For the native log,
// and for the bags of ROS that carry the same records.
#pragma once

#include <cstdint>
#include <isobath/event/event.hpp>
#include <isobath/io/mcap/mcap.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <isobath/vehicle/vehicle_state.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace isobath::native {

/// Stores fans by their bytes, so that pings of the same geometry share one.
class FanStore {
 public:
  std::shared_ptr<const BeamFan> fan(double height, std::span<const std::uint8_t> azimuths,
                                     std::span<const std::uint8_t> widths);

 private:
  std::map<std::string, std::shared_ptr<const BeamFan>> fans_;
  std::size_t bytes_ = 0;
};

/// The event of a record of this kind (RecordKind::name). A ping points into the message and shares its storage.
std::optional<Event> decode_event(std::string_view kind, const McapMessage& message, FanStore& fans);
/// The ping of encode_geometry: without samples.
std::optional<Ping> decode_geometry(std::span<const std::uint8_t> record, FanStore& fans);
std::optional<TrueMotion> decode_motion(std::span<const std::uint8_t> record);
std::optional<EchoTruth> decode_echoes(std::span<const std::uint8_t> record);

}  // namespace isobath::native

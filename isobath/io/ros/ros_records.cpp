// Records of Isobath's native log in a log of ROS (RosLogWriter), and the origin on the globe.
#include <isobath/io/mcap/native_log_kinds.hpp>
#include <isobath/io/ros/ros_decoding.hpp>
#include <isobath/io/ros/ros_writer.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {
namespace {

constexpr std::size_t kMaxPingRecords = 256;  // that wait for their image

constexpr const char* kBadRecord = "record of Isobath that cannot be decoded";

}  // namespace

const char* decode_record(const RosInput& input, RosContext& context, std::vector<Event>& events) {
  const RosMessage& message = input.message;
  if (!message.ok()) return nullptr;
  Bytes bytes = message.bytes();
  std::optional<std::vector<std::uint8_t>> cdr;
  if (message.encoding() == RosEncoding::kRos1) {
    cdr = recoded(message.definition(), bytes, RosEncoding::kRos1);
    if (!cdr) return kBadRecord;
    bytes = std::as_bytes(std::span(*cdr));
  }
  McapMessage record;
  record.data = {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
  const std::string kind = "isobath/msg/" + message.definition().types()[0].name.substr(kRecordPackage.size());
  if (kind == native::kPing.name) {
    auto ping = native::decode_geometry(record.data, context.record_fans);
    if (!ping) return kBadRecord;
    if (context.ping_records.size() == kMaxPingRecords) context.ping_records.pop_front();
    const Time time = ping->time;
    context.ping_records.emplace_back(time, *std::move(ping));
    return nullptr;
  }
  auto event = native::decode_event(kind, record, context.record_fans);
  if (!event) return kBadRecord;
  events.push_back(*std::move(event));
  return nullptr;
}

std::optional<Ping> RosContext::take_ping_record(Time time) {
  for (auto record = ping_records.begin(); record != ping_records.end(); ++record) {
    if (record->first != time) continue;
    Ping ping = std::move(record->second);
    ping_records.erase(record);
    return ping;
  }
  return {};
}

const char* decode_origin(const RosInput& input, RosContext& context, std::vector<Event>&) {
  const RosValue position = input.message["position"];
  const GeoPoint origin{position["latitude"].number(), position["longitude"].number()};
  if (!input.message.ok()) return nullptr;
  if (!valid(origin)) return "origin that is not on the globe";
  if (!context.report.origin) context.report.origin = origin;
  return nullptr;
}

}  // namespace isobath

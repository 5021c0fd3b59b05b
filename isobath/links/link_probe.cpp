#include <fmt/format.h>
#include <isobath/io/formats/mavlink/mavlink_messages.hpp>
#include <isobath/io/formats/nmea_decoder.hpp>
#include <isobath/io/formats/oculus/oculus_protocol.hpp>
#include <isobath/io/formats/oculus/oculus_status.hpp>
#include <isobath/io/formats/ping/ping_commands.hpp>
#include <isobath/io/formats/ping/ping_discovery.hpp>
#include <isobath/io/formats/tritech/tritech_commands.hpp>
#include <isobath/links/link_probe.hpp>
#include <nlohmann/json.hpp>
#include <utility>

namespace isobath {
namespace {

constexpr Duration kAskAgain = std::chrono::milliseconds(500);
constexpr std::size_t kLongestProbedLine = 16384;

bool is_server(LinkAddress::Kind kind) {
  return kind == LinkAddress::Kind::kUdpServer || kind == LinkAddress::Kind::kTcpServer;
}

}  // namespace

LinkProbe::LinkProbe(const LinkAddress& address)
    : address_(address),
      asks_(!is_server(address.kind)),
      ping_(ping_frame_at),
      tritech_(tritech_frame_at),
      oculus_(oculus_message_at),
      mavlink_(mavlink_frame_at),
      lines_(kLongestProbedLine) {}

void LinkProbe::on_open(Time time) {
  open_ = true;
  asked_ = time;
  ask();
}

void LinkProbe::on_tick(Time now) {
  if (!open_ || now - asked_ < kAskAgain || speaker()) return;
  asked_ = now;
  ask();
}

void LinkProbe::ask() {
  if (!asks_) return;
  if (address_.port == kPing360DiscoveryPort) {
    const Bytes text = bytes_of(kPing360Discovery);
    return link_->send({text.begin(), text.end()});
  }
  link_->send(ping_request(ping_message::kDeviceInformation));
  if (address_.kind == LinkAddress::Kind::kSerial) link_->send(tritech_send_version());
}

std::optional<Speaker> LinkProbe::speaker() const {
  const std::lock_guard lock(mutex_);
  return speaker_;
}

void LinkProbe::found(std::optional<DeviceKind> device, std::string what, std::string link) {
  const std::lock_guard lock(mutex_);
  speaker_ = Speaker{device, link.empty() ? address_.text() : std::move(link), std::move(what)};
}

void LinkProbe::on_bytes(Bytes bytes, Time time) {
  if (const auto status = oculus_status_of(bytes)) {
    const std::string model = oculus_model(status->part);
    const std::string port = address_.port == kOculusStatusPort ? "" : fmt::format(":{}", address_.port);
    return found(DeviceKind::kOculus,
                 fmt::format("Oculus{}{}, number {}", model.empty() ? "" : " ", model, status->device),
                 fmt::format("oculus:{}{}", status->device, port));
  }
  if (const auto address = ping360_address_in(bytes); address && address_.port == kPing360DiscoveryPort)
    return found(DeviceKind::kPing360, "Ping360", fmt::format("udp:{}:{}", *address, kPing360DataPort));
  const auto each = [&](FrameStream& frames, auto&& on_frame) {
    frames.push(bytes, time, 0);
    while (const auto frame = frames.next(ignored_)) on_frame(frame->frame);
  };
  each(ping_, [this](Bytes frame) { on_ping(frame); });
  each(tritech_, [this](Bytes frame) { on_tritech(frame); });
  each(oculus_, [this](Bytes) { found(DeviceKind::kOculus, "Oculus"); });
  each(mavlink_, [this](Bytes frame) { on_mavlink(frame); });
  lines_.push(bytes, [this](std::string_view line) { on_line(line); });
  ignored_ = SourceReport{};
}

void LinkProbe::on_ping(Bytes bytes) {
  const PingFrame frame = ping_frame(bytes);
  const auto type = frame.id == ping_message::kDeviceInformation && !frame.payload.empty()
                        ? static_cast<PingDeviceType>(frame.payload.front())
                        : PingDeviceType::kUnknown;
  const bool line = frame.id == ping_message::kDeviceData || frame.id == ping_message::kAutoDeviceData;
  const bool range = frame.id == ping_message::kDistance || frame.id == ping_message::kProfile;
  if (type == PingDeviceType::kPing360 || line) found(DeviceKind::kPing360, "Ping360");
  if (type == PingDeviceType::kPing1D || range) found(DeviceKind::kPing1D, "Ping1D");
}

void LinkProbe::on_tritech(Bytes bytes) {
  const TritechFrame frame = tritech_frame(bytes);
  const bool ours = frame.id == tritech::kAlive || frame.id == tritech::kVersionData || frame.id == tritech::kHeadData;
  if (frame.source == tritech::kImagingNode && ours) found(DeviceKind::kMicron, "Tritech imaging head");
}

void LinkProbe::on_mavlink(Bytes bytes) {
  const MavlinkFrame frame = mavlink_frame(bytes);
  if (frame.id != mavlink::Heartbeat::kId || frame.checksum != MavlinkFrame::Checksum::kRight) return;
  const auto beat = mavlink::Heartbeat::of(MavlinkPayload(frame.payload));
  if (beat.autopilot != mavlink::kArduPilot) return;
  found(std::nullopt, fmt::format("ArduPilot autopilot, system {}, {}, {}", frame.system,
                                  mavlink::mode_text(beat.custom_mode), beat.armed() ? "armed" : "disarmed"));
}

void LinkProbe::on_line(std::string_view line) {
  if (sentence_of(line).state == NmeaSentence::State::kGood) return found(DeviceKind::kNmea, "NMEA 0183");
  if (!line.starts_with('{')) return;
  const auto report = nlohmann::json::parse(line, nullptr, false);
  const auto type = report.is_object() ? report.find("type") : report.end();
  if (report.is_object() && type != report.end() && (*type == "velocity" || *type == "position_local"))
    found(DeviceKind::kDvlA50, "WaterLinked A50");
}

}  // namespace isobath

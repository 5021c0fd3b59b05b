#include <algorithm>
#include <fmt/format.h>
#include <isobath/io/mcap/native_log.hpp>
#include <isobath/io/mcap/native_log_encoding.hpp>
#include <isobath/io/mcap/native_log_kinds.hpp>
#include <iterator>
#include <utility>

namespace isobath {

NativeLogWriter::NativeLogWriter(const std::filesystem::path& file, const McapWriterConfig& config)
    : mcap_(file, config) {
  ping_ = add_kind(native::kPing);
  navigation_ = add_kind(native::kNavigation);
  range_ = add_kind(native::kRange);
  health_ = add_kind(native::kHealth);
  swath_ = add_kind(native::kSwath);
}

void NativeLogWriter::set_details(const std::map<std::string, std::string>& details) {
  mcap_.add_metadata({native::kDetails, details});
}
void NativeLogWriter::set_configuration(const std::string& toml) {
  mcap_.add_metadata({native::kConfiguration, {{"toml", toml}}});
}
void NativeLogWriter::set_origin(const GeoOrigin& origin) {
  mcap_.add_metadata({native::kOrigin,
                      {{"latitude_deg", fmt::format("{}", origin.latitude_deg)},
                       {"longitude_deg", fmt::format("{}", origin.longitude_deg)}}});
}

bool NativeLogWriter::write(const Event& event) {
  if (const Ping* ping = std::get_if<Ping>(&event); ping && !native::writable(*ping)) return false;
  native::encode(event, message_);
  if (std::holds_alternative<OperatorFrame>(event)) late_channel(operator_, native::kOperatorFrame);
  if (std::holds_alternative<PassiveBearing>(event)) late_channel(bearing_, native::kBearing);
  const std::uint16_t channels[] = {ping_,  range_,    navigation_, health_,
                                    swath_, operator_, bearing_};  // in variant order
  static_assert(std::variant_size_v<Event> == std::size(channels));
  send(channels[event.index()], time_of(event), message_);
  return true;
}

void NativeLogWriter::send(std::uint16_t channel, Time at, std::span<const std::uint8_t> message) {
  // MCAP has no times before 1970; the message holds the exact time
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(at.time_since_epoch().count(), 0));
  mcap_.write({channel, sequence_[channel]++, time, time, message, nullptr});
}

std::uint16_t NativeLogWriter::add_kind(const native::RecordKind& kind) {
  const std::uint16_t schema = mcap_.add_schema({0, kind.name, kind.schema_encoding, native::definition_of(kind)});
  return mcap_.add_channel({0, schema, kind.topic, kind.message_encoding, {}});
}

std::uint16_t NativeLogWriter::late_channel(std::uint16_t& id, const native::RecordKind& kind) {
  if (id == 0) id = add_kind(kind);
  return id;
}

void NativeLogWriter::write(const TrueMotion& motion) {
  native::encode(motion, message_);
  send(late_channel(motion_, native::kTrueMotion), motion.time, message_);
}

void NativeLogWriter::write(const EchoTruth& echoes) {
  native::encode(echoes, message_);
  send(late_channel(echoes_, native::kEchoTruth), echoes.time, message_);
}

void NativeLogWriter::write(Time time, const Setpoint& setpoint) {
  native::encode(time, setpoint, message_);
  send(late_channel(setpoint_, native::kSetpoint), time, message_);
}

void NativeLogWriter::write_decision(Time time, const std::string& json) {
  write(late_channel(decisions_, native::kDecision), time, json);
}

std::uint16_t NativeLogWriter::add_channel(const std::string& topic, const std::string& message_encoding,
                                           McapSchema schema, int group) {
  const auto [known, is_new] = schemas_.try_emplace(schema.name);
  if (is_new) known->second = mcap_.add_schema(std::move(schema));
  return mcap_.add_channel({0, known->second, topic, message_encoding, {}}, group);
}

void NativeLogWriter::write(std::uint16_t channel, Time time, std::string_view message) {
  send(channel, time, {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
}

void NativeLogWriter::attach(const std::string& name, const std::string& media_type, const std::string& data) {
  mcap_.add_attachment({0, 0, name, media_type, data});
}

}  // namespace isobath

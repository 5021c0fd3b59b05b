#include <algorithm>
#include <cassert>
#include <isobath/io/bytes/record_writer.hpp>
#include <isobath/io/formats/moos/moos_messages.hpp>
#include <optional>
#include <utility>

namespace isobath {
namespace {

constexpr std::string_view kGreeting = "ELKS CAN'T DANCE 2/8/10";
constexpr std::size_t kGreetingBytes = 32, kPacketHead = 9;
constexpr std::size_t kMessageHead = 10, kTexts = 5, kTimes = 24;
constexpr std::size_t kShortestMessage = kMessageHead + 4 * kTexts + kTimes;

std::size_t bytes_in(const MoosMessage& m) {
  return kShortestMessage + m.source.size() + m.second_source.size() + m.community.size() + m.key.size() +
         m.text.size();
}

/// Whether the bytes that there are agree with the greeting.
bool greets(Bytes bytes) {
  for (std::size_t i = 0; i < std::min(bytes.size(), kGreetingBytes); ++i) {
    if (bytes[i] != static_cast<std::byte>(i < kGreeting.size() ? kGreeting[i] : '\0')) return false;
  }
  return true;
}

/// Whether the messages may fill a packet of `total` bytes, as far as its bytes are there.
bool may_be_filled(Bytes bytes, std::size_t total, std::size_t count) {
  const RecordView view(bytes);
  std::size_t at = kPacketHead;
  for (std::size_t left = count; left > 0 && view.holds(at, kMessageHead); --left) {
    const std::size_t length = view.at<std::uint32_t>(at), others = (left - 1) * kShortestMessage;
    const auto type = view.at<std::uint8_t>(at + 8);
    const char kind = view.at<char>(at + 9);
    if (type <= ' ' || type > '~' || std::string_view("DSB").find(kind) == std::string_view::npos) return false;
    if (length < kShortestMessage || length > total - at || total - at - length < others) return false;
    at += length;
  }
  return bytes.size() < total || at == total;
}

bool is_known(char type) { return std::string_view(".NRU*iKWT").find(type) != std::string_view::npos; }

/// Empty: the texts do not fill the message.
std::optional<MoosMessage> message_in(Bytes bytes) {
  ByteCursor from(bytes);
  const auto text = [&from] {
    const auto length = from.little<std::uint32_t>();
    return std::string(text_of(from.take(length)));
  };
  from.skip(sizeof(std::uint32_t));
  MoosMessage m;
  m.number = from.little<std::int32_t>();
  m.type = static_cast<MoosMessage::Type>(from.little<char>());
  m.kind = static_cast<MoosMessage::Kind>(from.little<char>());
  for (std::string* t : {&m.source, &m.second_source, &m.community, &m.key}) *t = text();
  for (double* value : {&m.time_s, &m.value, &m.second_value}) *value = from.little<double>();
  m.text = text();
  if (!from.ok() || from.left() > 0) return std::nullopt;
  return m;
}

}  // namespace

MoosMessage moos_number(std::string key, double value, double time_s) {
  MoosMessage m;
  m.type = MoosMessage::Type::kNotify;
  m.key = std::move(key);
  m.time_s = time_s;
  m.value = value;
  return m;
}

MoosMessage moos_text(std::string key, std::string text, double time_s) {
  MoosMessage m = moos_number(std::move(key), 0, time_s);
  m.kind = MoosMessage::Kind::kText;
  m.text = std::move(text);
  return m;
}

std::vector<std::byte> moos_greeting() {
  return RecordWriter(kGreetingBytes).put_text(0, kGreetingBytes, kGreeting).take();
}

bool is_moos_greeting(Bytes frame) { return frame.size() == kGreetingBytes && greets(frame); }

std::vector<std::byte> moos_packet(std::span<const MoosMessage> messages) {
  std::size_t bytes = kPacketHead;
  for (const MoosMessage& m : messages) bytes += bytes_in(m);
  assert(bytes <= kMaxMoosPacket);
  RecordWriter out(bytes);
  std::size_t at = 0;
  const auto put = [&](auto value) {
    out.put(at, value);
    at += sizeof value;
  };
  const auto put_text = [&](const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    out.put_text(at, text.size(), text);
    at += text.size();
  };
  put(static_cast<std::uint32_t>(bytes));
  put(static_cast<std::uint32_t>(messages.size()));
  put(std::uint8_t{0});
  for (const MoosMessage& m : messages) {
    put(static_cast<std::uint32_t>(bytes_in(m)));
    put(m.number);
    put(m.type);
    put(m.kind);
    for (const std::string* text : {&m.source, &m.second_source, &m.community, &m.key}) put_text(*text);
    for (const double value : {m.time_s, m.value, m.second_value}) put(value);
    put_text(m.text);
  }
  return out.take();
}

Framing moos_frame_at(Bytes bytes) {
  constexpr Framing kNothing{Framing::Kind::kNoise, 1};
  if (bytes.size() < kPacketHead) return {Framing::Kind::kIncomplete, kPacketHead};
  if (greets(bytes)) {
    const bool whole = bytes.size() >= kGreetingBytes;
    return {whole ? Framing::Kind::kFrame : Framing::Kind::kIncomplete, kGreetingBytes};
  }
  const RecordView view(bytes);
  const std::size_t length = view.at<std::uint32_t>(0), count = view.at<std::uint32_t>(4);
  const auto compressed = view.at<std::uint8_t>(8);
  if (length < kPacketHead || length > kMaxMoosPacket || compressed > 1) return kNothing;
  if (compressed == 0 && count > (length - kPacketHead) / kShortestMessage) return kNothing;
  if (compressed == 0 && !may_be_filled(bytes.first(std::min(length, bytes.size())), length, count)) return kNothing;
  return {bytes.size() < length ? Framing::Kind::kIncomplete : Framing::Kind::kFrame, length};
}

std::vector<MoosMessage> moos_messages_of(Bytes packet, SourceReport& report) {
  std::vector<MoosMessage> messages;
  const RecordView view(packet);
  if (view.at<std::uint8_t>(8) != 0) {
    ++report.rejected["compressed packet"];
    return messages;
  }
  const auto count = view.at<std::uint32_t>(4);
  std::size_t at = kPacketHead;
  for (std::uint32_t i = 0; i < count && view.holds(at, kShortestMessage); ++i) {
    const auto length = view.at<std::uint32_t>(at);
    auto message = message_in(view.part(at, length));
    at += std::max<std::size_t>(length, kShortestMessage);
    if (!message) {
      ++report.rejected["message whose texts do not fill it"];
    } else if (!is_known(static_cast<char>(message->type))) {
      ++report.rejected["message of an unknown type"];
    } else {
      messages.push_back(std::move(*message));
    }
  }
  return messages;
}

}  // namespace isobath

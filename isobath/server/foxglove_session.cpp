#include <algorithm>
#include <cstring>
#include <isobath/server/foxglove_session.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

namespace isobath {
namespace {

using nlohmann::json;

constexpr char kMessageData = 1, kTime = 2;
constexpr std::size_t kLongestWord = 64;  // of a viewer's message that is repeated to it

void append_little(std::string& bytes, std::uint64_t value, int count) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

std::uint64_t ns_of(Time time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, time.time_since_epoch().count()));
}

std::optional<std::uint32_t> number_of(const json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto number = value.get<std::uint64_t>();
  return number <= 0xffffffff ? std::optional(static_cast<std::uint32_t>(number)) : std::nullopt;
}

std::optional<std::uint32_t> number_of(const json& object, const char* key) {
  if (!object.is_object() || !object.contains(key)) return std::nullopt;
  return number_of(object[key]);
}

}  // namespace

const std::vector<std::string>& foxglove_protocols() {
  static const std::vector<std::string> protocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
  return protocols;
}

FoxgloveSession::FoxgloveSession(ViewerFeed& feed, const std::string& name, const std::string& run)
    : feed_(feed), viewer_(feed) {
  texts_.push_back(json{
      {"op", "serverInfo"},
      {"name", name},
      {"capabilities", {"time"}},
      {"supportedEncodings", json::array()},
      {"metadata", json::object()},
      {"sessionId",
       run}}.dump());
}

Hearing FoxgloveSession::refuse(const std::string& why) {
  constexpr int kWarning = 1;
  texts_.push_back(json{{"op", "status"}, {"level", kWarning}, {"message", why}}.dump(-1, ' ', false,
                                                                                      json::error_handler_t::replace));
  return {"foxglove", ++refusals_ > kMaxRefusals};
}

Hearing FoxgloveSession::on_message(std::string_view text) {
  const json message = json::parse(text, nullptr, false);
  if (!message.is_object() || !message.contains("op") || !message["op"].is_string())
    return refuse("a message is a JSON object with an \"op\"");
  const auto op = message["op"].get<std::string>();
  if (op == "subscribe") return subscribe(message);
  if (op == "unsubscribe") return unsubscribe(message);
  return refuse("this server does not know \"" + op.substr(0, kLongestWord) +
                "\": it shows a run, and takes no orders");
}

Hearing FoxgloveSession::subscribe(const json& message) {
  if (!message.contains("subscriptions") || !message["subscriptions"].is_array())
    return refuse("\"subscriptions\" is a list");
  for (const json& wanted : message["subscriptions"]) {
    const auto id = number_of(wanted, "id"), channel = number_of(wanted, "channelId");
    if (!id || !channel || *channel == 0 || *channel > advertised_) return refuse("there is no such channel");
    if (subscriptions_.size() >= kMaxSubscriptions) return refuse("there are too many subscriptions");
    if (!subscriptions_.try_emplace(*id, Subscription{*channel - 1}).second)
      return refuse("the subscription " + std::to_string(*id) + " is in use");
  }
  return {};
}

Hearing FoxgloveSession::unsubscribe(const json& message) {
  if (!message.contains("subscriptionIds") || !message["subscriptionIds"].is_array())
    return refuse("\"subscriptionIds\" is a list");
  for (const json& wanted : message["subscriptionIds"]) {
    const auto id = number_of(wanted);
    if (!id || subscriptions_.erase(*id) == 0) return refuse("there is no such subscription");
  }
  return {};
}

void FoxgloveSession::advertise() {
  const std::vector<ViewerFeed::Channel> added = feed_.channels(advertised_);
  if (added.empty()) return;
  json channels = json::array();
  for (const ViewerFeed::Channel& channel : added) {
    channels.push_back({{"id", ++advertised_},
                        {"topic", channel.topic},
                        {"encoding", "json"},
                        {"schemaName", channel.schema_name},
                        {"schema", channel.schema},
                        {"schemaEncoding", "jsonschema"}});
  }
  texts_.push_back(json{{"op", "advertise"}, {"channels", channels}}.dump());
}

WebFrame FoxgloveSession::next() {
  if (texts_.empty()) advertise();
  if (!texts_.empty()) {
    WebFrame frame{.own = std::move(texts_.front()), .more = true, .text = true};
    texts_.pop_front();
    return frame;
  }
  if (const auto latest = feed_.latest(); latest && latest != time_) {
    time_ = latest;
    WebFrame frame{.own = {kTime}, .more = true};
    append_little(frame.own, ns_of(*latest), 8);
    return frame;
  }
  return data();
}

/// The next message of the next subscription, after the last one, that has one.
WebFrame FoxgloveSession::data() {
  auto next = subscriptions_.upper_bound(last_);
  for (std::size_t i = 0; i < subscriptions_.size(); ++i, ++next) {
    if (next == subscriptions_.end()) next = subscriptions_.begin();
    auto& [id, subscription] = *next;
    const auto message = feed_.after(subscription.channel, subscription.number);
    if (!message) continue;
    subscription.number = message->number;
    last_ = id;
    WebFrame frame{.own = {kMessageData}, .more = true};
    append_little(frame.own, id, 4);
    append_little(frame.own, ns_of(message->time), 8);
    frame.own += *message->body;
    return frame;
  }
  return {};
}

}  // namespace isobath

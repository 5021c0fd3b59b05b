// FoxgloveSession: one viewer that speaks the Foxglove WebSocket protocol: sub-protocols `foxglove.websocket.v1` and
// `foxglove.sdk.v1`, whose messages used here are the same (github.com/foxglove/ws-protocol, docs/spec.md).
//
// It tells the viewer what the server is, advertises the channels of a ViewerFeed as JSON with their schemas, takes
// subscriptions, and sends the newest message of each subscribed channel, and the time of the run. It offers nothing
// else: a viewer cannot publish, set a parameter or call a service, and is told so. Messages of a viewer are untrusted:
// what is not of the protocol is refused and counted, and kMaxRefusals end the connection.
#pragma once

#include <deque>
#include <isobath/display/viewer_feed.hpp>
#include <isobath/server/web_session.hpp>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isobath {

/// The sub-protocols, the newer one first.
const std::vector<std::string>& foxglove_protocols();

class FoxgloveSession final : public WebSession {
 public:
  static constexpr std::size_t kMaxSubscriptions = 256;
  static constexpr int kMaxRefusals = 30;

  /// The feed must outlive the session. `name` is shown by the viewer; `run` differs from that of any other run.
  FoxgloveSession(ViewerFeed& feed, const std::string& name, const std::string& run);

  Hearing on_message(std::string_view text) override;
  WebFrame next() override;

 private:
  struct Subscription {
    std::size_t channel = 0;
    std::uint64_t number = 0;  ///< of the last message sent
  };
  Hearing refuse(const std::string& why);
  Hearing subscribe(const nlohmann::json& message);
  Hearing unsubscribe(const nlohmann::json& message);
  void advertise();
  [[nodiscard]] WebFrame data();

  ViewerFeed& feed_;
  ViewerFeed::Viewer viewer_;
  std::deque<std::string> texts_;  ///< to be sent before any data
  std::size_t advertised_ = 0;     ///< channels
  std::map<std::uint32_t, Subscription> subscriptions_;
  std::uint32_t last_ = 0;  ///< subscription whose message was sent last: they take turns
  std::optional<Time> time_;
  int refusals_ = 0;
};

}  // namespace isobath

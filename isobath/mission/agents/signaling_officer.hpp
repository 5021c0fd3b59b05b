// SignalingOfficer: the vehicle's end of the link to the operator (Ganesan 2015, 5.1; ledger S6-40).
//
// Receives LinkFrame (from the operator) and StatusReport. Sends OperatorCommand, LinkFrame (to the operator), Health
// of "operator link" and Decision. A command is passed to the agents once, however often it arrived. Only the newest
// status report is sent, until it is acknowledged. Any whole frame is a heartbeat. An operator who was connected and
// then silent for `heartbeat_limit_s` is lost until the next frame; an operator who was never connected is not missed.
// A command that cannot be read, or that has an invalid mission, is refused: the operator receives the reason, and the
// agents receive nothing.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/mission/messages/agent.hpp>
#include <isobath/mission/messages/operator_link.hpp>

namespace isobath {

struct SignalingConfig {
  double repeat_s = 2;
  double heartbeat_limit_s = 30;
};
std::vector<Field> fields(SignalingConfig& config);

class SignalingOfficer final : public Agent {
 public:
  explicit SignalingOfficer(const SignalingConfig& config = {})
      : end_(seconds(config.repeat_s)), beat_limit_(seconds(config.heartbeat_limit_s)) {}

  void on_message(const Message& message, Time now, Outbox& out) override;
  void tick(Time now, Outbox& out) override;

  [[nodiscard]] const LinkEnd& link() const { return end_; }

 private:
  void on(const LinkFrame& frame, Time now, Outbox& out);
  void on_word(const FrameBytes& word, Time now, Outbox& out);
  void send_due(Time now, Outbox& out);

  LinkEnd end_;
  Duration beat_limit_;
  std::optional<Time> last_heard_;
  bool lost_ = false;
  StatusReport status_;
};

}  // namespace isobath

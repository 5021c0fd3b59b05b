#include <fmt/format.h>
#include <isobath/mission/agents/signaling_officer.hpp>

namespace isobath {
namespace {

constexpr const char* kSource = "operator link";

void say_health(HealthState state, std::string note, Time now, Outbox& out) {
  Health health;
  health.time = now;
  health.source = kSource;
  health.state = state;
  health.note = std::move(note);
  out.say(std::move(health));
}

void send(FrameBytes bytes, Outbox& out) { out.say(LinkFrame{LinkFrame::Way::kToOperator, std::move(bytes)}); }

}  // namespace

std::vector<Field> fields(SignalingConfig& c) {
  return {Field::real("repeat_s", &c.repeat_s, {0.01, 3600}, "s",
                      "Interval after which an unacknowledged message is sent again."),
          Field::real("heartbeat_limit_s", &c.heartbeat_limit_s, {0.1, 1e6}, "s",
                      "The link to an operator who was connected is lost after this time without a frame.")
              .was("beat_limit_s")};
}

void SignalingOfficer::on_message(const Message& message, Time now, Outbox& out) {
  if (const auto* frame = std::get_if<LinkFrame>(&message)) {
    if (frame->way == LinkFrame::Way::kFromOperator) on(*frame, now, out);
  } else if (const auto* status = std::get_if<StatusReport>(&message)) {
    status_ = *status;
    end_.send(to_bytes(status_), true);
    send_due(now, out);
  }
}

void SignalingOfficer::tick(Time now, Outbox& out) {
  send_due(now, out);
  if (lost_ || !last_heard_ || now - *last_heard_ <= beat_limit_) return;
  lost_ = true;
  say_health(HealthState::kLost, fmt::format("no frame for {:.1f} s", to_seconds(now - *last_heard_)), now, out);
}

void SignalingOfficer::on(const LinkFrame& frame, Time now, Outbox& out) {
  LinkEnd::Received received = end_.receive(frame.bytes);
  if (!received.valid) return;
  last_heard_ = now;
  if (lost_) say_health(HealthState::kOk, "connected again", now, out);
  lost_ = false;
  if (received.answer) send(std::move(*received.answer), out);
  if (received.word) {
    on_word(*received.word, now, out);
  } else {
    out.say(OperatorCommand{OperatorCommand::Kind::kBeat});
    send_due(now, out);  // an acknowledgement lets the next message follow
  }
}

void SignalingOfficer::on_word(const FrameBytes& word, Time now, Outbox& out) {
  try {
    out.say(command_of(word));
  } catch (const Error& error) {
    out.say(Decision{now, "signaling officer", "refuse command", error.what()});
    StatusReport refusal = status_;
    refusal.text = std::string("refused: ") + error.what();
    end_.send(to_bytes(refusal), true);
    send_due(now, out);
  }
}

void SignalingOfficer::send_due(Time now, Outbox& out) {
  for (FrameBytes& frame : end_.due(now)) send(std::move(frame), out);
}

}  // namespace isobath

#include <algorithm>
#include <array>
#include <isobath/base/printable_text.hpp>
#include <isobath/mission/messages/frame_bytes.hpp>
#include <isobath/mission/messages/operator_link.hpp>
#include <isobath/mission/plan/mission_file.hpp>

namespace isobath {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHead = 20;
constexpr std::size_t kTail = 4;
constexpr std::size_t kMaxText = 1000;  // bytes of a status
constexpr std::size_t kMaxSender = 255;

/// Whether the command carries who gave it: a byte for its length, then the text.
bool names_sender(OperatorCommand::Kind kind) { return kind >= OperatorCommand::Kind::kNewMission; }

}  // namespace

FrameBytes to_bytes(const Frame& frame) {
  FrameBytes out{'I', 'L', 1, static_cast<std::uint8_t>(frame.kind)};
  put(out, frame.session, 8);
  put(out, frame.number, 4);
  put(out, frame.word.size(), 4);
  out.insert(out.end(), frame.word.begin(), frame.word.end());
  put(out, crc32(out), 4);
  return out;
}

std::optional<Frame> frame_of(Bytes bytes) {
  if (bytes.size() < kHead + kTail || bytes[0] != 'I' || bytes[1] != 'L' || bytes[2] != 1) return std::nullopt;
  if (bytes[3] < 1 || bytes[3] > 3 || number_at(bytes, 16, 4) != bytes.size() - kHead - kTail) return std::nullopt;
  const Bytes all = bytes.first(bytes.size() - kTail);
  if (number_at(bytes, all.size(), 4) != crc32(all)) return std::nullopt;
  const Bytes word = all.subspan(kHead);
  return Frame{static_cast<FrameKind>(bytes[3]), number_at(bytes, 4, 8),
               static_cast<std::uint32_t>(number_at(bytes, 12, 4)), FrameBytes(word.begin(), word.end())};
}

void LinkEnd::send(FrameBytes word, bool instead_of_others) {
  if (instead_of_others) waiting_.clear();
  waiting_.push_back({++last_sent_, std::move(word), std::nullopt});
}

std::vector<FrameBytes> LinkEnd::due(Time now) {
  if (!session_) session_ = static_cast<std::uint64_t>(now.time_since_epoch().count());
  if (waiting_.empty()) return {};
  Word& word = waiting_.front();
  if (word.sent && now - *word.sent < repeat_) return {};
  word.sent = now;
  return {to_bytes(Frame{FrameKind::kWord, *session_, word.number, word.bytes})};
}

LinkEnd::Received LinkEnd::receive(Bytes bytes) {
  std::optional<Frame> frame = frame_of(bytes);
  if (!frame) {
    ++damaged_;
    return {};
  }
  Received received{true, std::nullopt, std::nullopt};
  if (frame->kind == FrameKind::kAcknowledgement) {
    const bool ours = session_ && frame->session == *session_ && !waiting_.empty() && waiting_.front().sent;
    if (ours && frame->number == waiting_.front().number) waiting_.pop_front();
  } else if (frame->kind == FrameKind::kWord && frame->session >= their_session_) {
    received.answer = to_bytes(Frame{FrameKind::kAcknowledgement, frame->session, frame->number, {}});
    if (frame->session > their_session_) last_received_ = 0;
    their_session_ = frame->session;
    if (frame->number > last_received_) {
      last_received_ = frame->number;
      received.word = std::move(frame->word);
    } else {
      ++repeated_;
    }
  }
  return received;
}

FrameBytes to_bytes(const OperatorCommand& command) {
  FrameBytes out{'c', static_cast<std::uint8_t>(command.kind)};
  if (names_sender(command.kind)) {
    const std::string by = command.by.substr(0, kMaxSender);
    out.push_back(static_cast<std::uint8_t>(by.size()));
    out.insert(out.end(), by.begin(), by.end());
  }
  if (command.plan) {
    const std::string text = write_mission(*command.plan);
    out.insert(out.end(), text.begin(), text.end());
  }
  return out;
}

OperatorCommand command_of(Bytes word) {
  using Kind = OperatorCommand::Kind;
  const Place place{"operator link"};
  if (word.size() < 2 || word[0] != 'c' || word[1] > static_cast<std::uint8_t>(Kind::kHandOver)) {
    throw Error("not a command", place);
  }
  OperatorCommand command{static_cast<Kind>(word[1]), nullptr};
  std::size_t read = 2;
  if (names_sender(command.kind)) {
    if (word.size() < 3 || word.size() < std::size_t{3} + word[2]) throw Error("a command that is cut short", place);
    read = std::size_t{3} + word[2];
    command.by = printable_text({reinterpret_cast<const char*>(word.data()) + 3, word[2]}, kMaxSender);
  }
  if (word.size() > read) {
    const std::string text(word.begin() + static_cast<std::ptrdiff_t>(read), word.end());
    command.plan = std::make_shared<const MissionPlan>(parse_mission(text, place.file));
  }
  const bool needs_plan = command.kind == Kind::kStart || command.kind == Kind::kNewMission;
  if (needs_plan && !command.plan) throw Error("a start without a mission", place);
  return command;
}

FrameBytes to_bytes(const StatusReport& status) {
  FrameBytes out{'s', static_cast<std::uint8_t>(status.phase)};
  put(out, status.point, 4);
  put(out, status.points, 4);
  const std::string text = status.text.substr(0, kMaxText);
  out.insert(out.end(), text.begin(), text.end());
  return out;
}

std::optional<StatusReport> status_of(Bytes word) {
  if (word.size() < 10 || word.size() > 10 + kMaxText || word[0] != 's' ||
      word[1] > static_cast<std::uint8_t>(MissionPhase::kAborted)) {
    return std::nullopt;
  }
  return StatusReport{static_cast<MissionPhase>(word[1]), number_at(word, 2, 4), number_at(word, 6, 4),
                      std::string(word.begin() + 10, word.end())};
}

void OperatorConsole::command(const OperatorCommand& command) {
  end_.send(to_bytes(command), command.kind == OperatorCommand::Kind::kAbort);
}

std::vector<FrameBytes> OperatorConsole::due(Time now) {
  std::vector<FrameBytes> frames = std::move(answers_);
  answers_.clear();
  for (FrameBytes& frame : end_.due(now)) frames.push_back(std::move(frame));
  if (!last_beat_ || now - *last_beat_ >= beat_) {
    last_beat_ = now;
    frames.push_back(to_bytes(Frame{FrameKind::kBeat, 0, 0, {}}));
  }
  return frames;
}

std::optional<StatusReport> OperatorConsole::on_frame(Bytes bytes) {
  LinkEnd::Received received = end_.receive(bytes);
  if (received.answer) answers_.push_back(std::move(*received.answer));
  return received.word ? status_of(*received.word) : std::nullopt;
}

}  // namespace isobath

// Operator link: messages between operator and vehicle over a link that loses, repeats and delays frames (Ganesan 2015,
// 5.1; ledger S6-40).
//
// LinkEnd is one end of the link. It repeats a message until the other end acknowledges it, one message after the
// other. It passes on each received message once, in order: numbers grow, and a message whose number is not newer has
// already been received. A new message may replace all that are still unsent or unacknowledged: an abort does not wait
// behind a mission, a status does not wait behind older ones. The session number (the time of the first frame) tells an
// end that has restarted from one that repeats itself; clocks must not run backwards between its starts.
//
// Frames are whole: the modem driver cuts them to the size that the modem takes. Layout, little endian: "IL", version
// 1, kind, session (8 bytes), number (4), length of the rest (4), the rest, CRC-32 of all before (4). Input is
// untrusted; anything that is not a whole frame is counted and skipped.
#pragma once

#include <cstdint>
#include <deque>
#include <isobath/mission/messages/frame_bytes.hpp>
#include <isobath/mission/messages/messages.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

enum class FrameKind : std::uint8_t { kWord = 1, kAcknowledgement = 2, kBeat = 3 };

struct Frame {
  FrameKind kind = FrameKind::kBeat;
  std::uint64_t session = 0;  ///< of the sender; in an acknowledgement, of the end that it answers
  std::uint32_t number = 0;
  FrameBytes word;
};

FrameBytes to_bytes(const Frame& frame);
std::optional<Frame> frame_of(std::span<const std::uint8_t> bytes);

class LinkEnd {
 public:
  /// `repeat`: interval after which an unacknowledged message is sent again; at least the link's round trip.
  explicit LinkEnd(Duration repeat) : repeat_(repeat) {}

  /// Sends a message after the others, or instead of all that are not acknowledged yet.
  void send(FrameBytes word, bool instead_of_others);
  /// The frames to transmit now.
  std::vector<FrameBytes> due(Time now);

  struct Received {
    bool valid = false;              ///< a whole frame
    std::optional<FrameBytes> word;  ///< the message, if it is new
    std::optional<FrameBytes> answer;
  };
  Received receive(std::span<const std::uint8_t> bytes);

  [[nodiscard]] bool all_acknowledged() const { return waiting_.empty(); }
  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }
  [[nodiscard]] std::uint64_t repeated() const { return repeated_; }  ///< messages that had already been received

 private:
  struct Word {
    std::uint32_t number = 0;
    FrameBytes bytes;
    std::optional<Time> sent;
  };

  Duration repeat_;
  std::deque<Word> waiting_;  ///< the first is in transit
  std::optional<std::uint64_t> session_;
  std::uint32_t last_sent_ = 0;
  std::uint64_t their_session_ = 0;
  std::uint32_t last_received_ = 0;
  std::uint64_t damaged_ = 0;
  std::uint64_t repeated_ = 0;
};

// Messages on the link. A mission goes as the TOML of write_mission, and is read and checked like any mission file.
FrameBytes to_bytes(const OperatorCommand& command);
/// Throws Error where it is not a command, or has a mission that is invalid.
OperatorCommand command_of(std::span<const std::uint8_t> word);
FrameBytes to_bytes(const StatusReport& status);
std::optional<StatusReport> status_of(std::span<const std::uint8_t> word);

/// The operator's end.
class OperatorConsole {
 public:
  explicit OperatorConsole(Duration repeat = std::chrono::seconds(2), Duration beat = std::chrono::seconds(5))
      : end_(repeat), beat_(beat) {}

  /// An abort replaces all commands that the vehicle has not acknowledged yet.
  void command(const OperatorCommand& command);
  /// The frames to transmit to the vehicle now, heartbeats included.
  std::vector<FrameBytes> due(Time now);
  /// Takes a frame from the vehicle; the acknowledgement goes with the next `due`.
  std::optional<StatusReport> on_frame(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool all_acknowledged() const { return end_.all_acknowledged(); }

 private:
  LinkEnd end_;
  Duration beat_;
  std::vector<FrameBytes> answers_;
  std::optional<Time> last_beat_;
};

}  // namespace isobath

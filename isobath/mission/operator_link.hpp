// Operator link: words between operator and vehicle over a link that loses, repeats and delays frames (Ganesan 2015,
// 5.1; ledger S6-40).
//
// LinkEnd is one end of it. What it sends is repeated until the other end acknowledges it, one piece after the other;
// what it receives is given on once, in order: numbers grow, and what is not newer was there before. A new word may
// take the place of all that are still unsent or unacknowledged: an abort does not wait behind a mission, a status
// not behind older ones. A number of its session (the time of its first frame) tells an end that has started anew from
// one that repeats itself; clocks must not run backwards between its starts.
//
// Frames are whole: cutting them to the size that a modem takes is the modem driver's. Layout, little endian: "IL",
// version 1, kind, session (8 bytes), number (4), length of the rest (4), the rest, CRC-32 of all before (4). Input is
// untrusted; what is not a whole frame is counted and passed over.
#pragma once

#include <cstdint>
#include <deque>
#include <isobath/mission/messages.hpp>
#include <optional>
#include <span>
#include <vector>

namespace isobath {

using FrameBytes = std::vector<std::uint8_t>;

enum class FrameKind : std::uint8_t { kWord = 1, kAcknowledgement = 2, kBeat = 3 };

struct Frame {
  FrameKind kind = FrameKind::kBeat;
  std::uint64_t session = 0;  ///< of the sender; of whom it answers, in an acknowledgement
  std::uint32_t number = 0;
  FrameBytes word;
};

FrameBytes to_bytes(const Frame& frame);
std::optional<Frame> frame_of(std::span<const std::uint8_t> bytes);

class LinkEnd {
 public:
  /// `repeat`: after which an unacknowledged word is sent again; of the link's round trip at least.
  explicit LinkEnd(Duration repeat) : repeat_(repeat) {}

  /// To be sent after the others, or instead of all that are not acknowledged yet.
  void send(FrameBytes word, bool instead_of_others);
  /// What is to go over the link now.
  std::vector<FrameBytes> due(Time now);

  struct Received {
    bool valid = false;              ///< a whole frame
    std::optional<FrameBytes> word;  ///< if it is new
    std::optional<FrameBytes> answer;
  };
  Received receive(std::span<const std::uint8_t> bytes);

  [[nodiscard]] bool all_acknowledged() const { return waiting_.empty(); }
  [[nodiscard]] std::uint64_t damaged() const { return damaged_; }
  [[nodiscard]] std::uint64_t repeated() const { return repeated_; }  ///< words that were there before

 private:
  struct Word {
    std::uint32_t number = 0;
    FrameBytes bytes;
    std::optional<Time> sent;
  };

  Duration repeat_;
  std::deque<Word> waiting_;  ///< the first is under way
  std::optional<std::uint64_t> session_;
  std::uint32_t last_sent_ = 0;
  std::uint64_t their_session_ = 0;
  std::uint32_t last_received_ = 0;
  std::uint64_t damaged_ = 0;
  std::uint64_t repeated_ = 0;
};

// Words. A mission goes as the TOML of write_mission, and is read and checked like any mission file.
FrameBytes to_bytes(const OperatorCommand& command);
/// Throws Error: not a command, or a mission that cannot be.
OperatorCommand command_of(std::span<const std::uint8_t> word);
FrameBytes to_bytes(const StatusReport& status);
std::optional<StatusReport> status_of(std::span<const std::uint8_t> word);

/// The operator's end.
class OperatorConsole {
 public:
  explicit OperatorConsole(Duration repeat = std::chrono::seconds(2), Duration beat = std::chrono::seconds(5))
      : end_(repeat), beat_(beat) {}

  /// An abort goes instead of whatever the vehicle has not acknowledged yet.
  void command(const OperatorCommand& command);
  /// What is to go to the vehicle now, beats among it.
  std::vector<FrameBytes> due(Time now);
  /// A frame from the vehicle; the answer goes with the next `due`.
  std::optional<StatusReport> hear(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool all_acknowledged() const { return end_.all_acknowledged(); }

 private:
  LinkEnd end_;
  Duration beat_;
  std::vector<FrameBytes> answers_;
  std::optional<Time> last_beat_;
};

}  // namespace isobath

// Bus: where every message of a crew passes once: it gets its number, is counted by sender and type, and is shown to
// the recorder (Ganesan 2015, 5.1; ledger S6-32, S6-33).
//
// The bus hands nothing on: who hears what, and in which thread, is the crew's (crew.hpp, threaded_crew.hpp). Numbers
// count up from 1 in the order of the calls. A recorder that throws is not called again; that it is lost is told once.
// One thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <isobath/mission/agent.hpp>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

inline constexpr std::size_t kMessageTypes = std::variant_size_v<Message>;
/// "route planned"; of an index of Message.
const char* message_name(std::size_t type);
inline const char* message_name(const Message& message) { return message_name(message.index()); }

/// Senders that are no seat.
inline constexpr const char* kFromOutside = "sensed";     ///< what came from outside
inline constexpr const char* kSupervisor = "supervisor";  ///< whoever runs the agents
inline constexpr const char* kHelmGate = "helm gate";
inline constexpr const char* kRecorder = "recorder";  ///< says nothing, but may be lost

struct Envelope {
  std::uint64_t number = 0;  ///< from 1
  Time time;                 ///< of saying
  std::string sender;        ///< name of the seat, or one of the names above
  Message message;
};

/// Sees every message in order; must not call back into the crew.
using Recorder = std::function<void(const Envelope&)>;

class Bus {
 public:
  using Counts = std::array<std::uint64_t, kMessageTypes>;  ///< one a type

  explicit Bus(Recorder recorder) : recorder_(std::move(recorder)) {}

  Envelope post(std::string sender, Message message, Time now);

  [[nodiscard]] std::uint64_t posted() const { return number_; }
  /// By sender: who says what.
  [[nodiscard]] const std::map<std::string, Counts>& said() const { return said_; }
  /// Why the recorder was given up, if it was since the last call.
  [[nodiscard]] std::optional<std::string> take_recorder_loss();

 private:
  Recorder recorder_;
  std::optional<std::string> recorder_loss_;
  std::uint64_t number_ = 0;
  std::map<std::string, Counts> said_;
};

/// What an agent said in one turn, or what it died of. Of a turn that ends in an exception nothing is kept.
struct Turn {
  std::vector<Message> said;
  std::optional<std::string> died;
};
Turn hear_in_turn(Agent& agent, const Message& message, Time now);
Turn tick_in_turn(Agent& agent, Time now);

}  // namespace isobath

// Bus: every message between agents passes through it once. The bus numbers the message, counts it by sender and type,
// and shows it to the recorder (Ganesan 2015, 5.1; ledger S6-32, S6-33).
//
// The bus also numbers decisions, from 1 in the order of the calls (Decision::number): every recorder, log and page
// thus shows the same number for the same decision.
//
// The bus delivers nothing: Executor and ThreadedExecutor decide which agent receives a message, and in which thread
// (executor.hpp, threaded_executor.hpp). Numbers count up from 1 in the order of the calls. A recorder that throws is
// not called again; its loss is reported once. One thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <isobath/mission/command/command_chain.hpp>
#include <isobath/mission/messages/agent.hpp>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

inline constexpr std::size_t kMessageTypes = std::variant_size_v<Message>;
/// Name of a message type, by its index in Message: "route planned".
const char* message_name(std::size_t type);
inline const char* message_name(const Message& message) { return message_name(message.index()); }

/// Senders that are not agents.
inline constexpr const char* kFromOutside = "sensed";     ///< input from outside
inline constexpr const char* kSupervisor = "supervisor";  ///< the executor of the agents
inline constexpr const char* kCommandArbiter = "helm gate";
inline constexpr const char* kRecorder = "recorder";  ///< sends nothing, but may be lost

struct Envelope {
  std::uint64_t number = 0;  ///< from 1
  Time time;                 ///< of sending
  std::string sender;        ///< name of the agent, or one of the names above
  Message message;
  std::optional<CommandLink> link = {};  ///< of a command
};

/// Receives every message in order; must not call back into the executor.
using Recorder = std::function<void(const Envelope&)>;

class Bus {
 public:
  using Counts = std::array<std::uint64_t, kMessageTypes>;  ///< one per type

  explicit Bus(Recorder recorder) : recorder_(std::move(recorder)) {}

  Envelope post(std::string sender, Message message, Time now);

  [[nodiscard]] std::uint64_t posted() const { return number_; }
  /// Number of messages, by sender and type.
  [[nodiscard]] const std::map<std::string, Counts>& said() const { return said_; }
  /// Number of messages of one sender, by the names of their types; without those that it never sent.
  [[nodiscard]] std::map<std::string, std::uint64_t> sent_by(const std::string& sender) const;
  /// Why the recorder was lost, if it was since the last call.
  [[nodiscard]] std::optional<std::string> take_recorder_loss();

 private:
  Recorder recorder_;
  CommandChain chain_;
  std::optional<std::string> recorder_loss_;
  std::uint64_t number_ = 0, decisions_ = 0;
  std::map<std::string, Counts> said_;
};

/// The messages of an agent's turn, or the reason of its death. A turn that ends in an exception keeps no message.
struct Turn {
  std::vector<Message> said;
  std::optional<std::string> died;
};
Turn deliver_in_turn(Agent& agent, const Message& message, Time now);
Turn tick_in_turn(Agent& agent, Time now);

}  // namespace isobath

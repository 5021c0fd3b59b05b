// MOOS messages: what clients and the database of a MOOS community (MOOSDB) say to each other over TCP, port 9000.
//
// A client greets with 32 bytes, "ELKS CAN'T DANCE 2/8/10" and zeros, then sends a packet with one message of data
// whose text is its name. The answer is a packet with one message, welcome or poison (refused). From then on both send
// packets of any number of messages. Numbers are little-endian.
//
//   packet    i32 bytes of the packet, i32 messages, u8 compressed (0: no), then the messages
//   message   i32 bytes of the message, i32 number, char type, char kind of data (D number, S text, B binary), texts
//             source, second source, community, key; f64 time (s since 1970), value, second value; text
//   text      i32 bytes, and these, without a zero at the end
//
// The bytes are untrusted. A packet has at most kMaxMoosPacket bytes; its messages must fill it exactly, else its bytes
// are noise. Compressed packets are refused. Written from public descriptions of the protocol; not run against a
// MOOSDB.
#pragma once

#include <isobath/io/bytes/framing.hpp>
#include <span>
#include <string>
#include <vector>

namespace isobath {

inline constexpr std::size_t kMaxMoosPacket = 1 << 20;  ///< bytes

struct MoosMessage {
  enum class Type : char {
    kNull = '.',      ///< the database answers with one, whose value is its time
    kNotify = 'N',    ///< a variable has a value
    kRegister = 'R',  ///< wants a variable; value: least time between two notifications, s
    kUnregister = 'U',
    kWildcard = '*',  ///< wants all variables that fit
    kData = 'i',      ///< the name of a client, in the handshake
    kPoison = 'K',    ///< the client is refused; the text says why
    kWelcome = 'W',
    kTiming = 'T'
  };
  enum class Kind : char { kNumber = 'D', kText = 'S', kBinary = 'B' };

  Type type = Type::kNull;
  Kind kind = Kind::kNumber;
  std::int32_t number = -1;
  std::string source, second_source, community;
  std::string key;  ///< name of the variable
  double time_s = 0, value = 0, second_value = 0;
  std::string text;

  bool operator==(const MoosMessage&) const = default;
};

/// A variable with a number or a text.
MoosMessage moos_number(std::string key, double value, double time_s);
MoosMessage moos_text(std::string key, std::string text, double time_s);

std::vector<std::byte> moos_greeting();
/// Whether a frame is the greeting, not a packet.
bool is_moos_greeting(Bytes frame);
/// The messages together must fit kMaxMoosPacket.
std::vector<std::byte> moos_packet(std::span<const MoosMessage> messages);

/// A greeting or a packet at the first byte.
Framing moos_frame_at(Bytes bytes);
/// The messages of a packet. Those that cannot be used are counted by reason in the report.
std::vector<MoosMessage> moos_messages_of(Bytes packet, SourceReport& report);

}  // namespace isobath

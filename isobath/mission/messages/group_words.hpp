// Group words: what the vehicles of a group tell one another over an acoustic link that loses, repeats and delays
// packets (ledger S2-50, S2-51).
//
// Two kinds of packet, each whole in itself: there are no acknowledgements, and a packet that arrives twice or late
// changes nothing. A status has a number that rises with each packet of its vehicle; a plan has the version of its
// leader. What was done (lanes that were sailed) only ever grows, so that it may be merged from any packet.
//
// Layout, little endian: "IG", version 3, kind (1), sender (1), then
//   status  number (2), north and east (2 each, in half metres), lane (1; 255: none), stations of it that were visited
//           (1), plan's leader (1; 255: no plan) and version (2), flags (1; bit 0: over, bit 1: from the last station
//           on, bit 2: ready, bit 3: a time to begin is agreed, bit 4: it finds no way to its lanes, bit 5: it goes
//           through the passage that it asked for, bit 6: passages follow), this time (2, whole seconds since 1970,
//           lower bits), lanes (1), lanes done (one bit each), obstacles (1; at most kMostTold), and for each of them
//           key (1), north and east (2 each, in half metres), radius and sigma (1 each, in quarters of a metre, rounded
//           up); passages: that which it asks for (1; 255: none), number of the ask (1), turns (1; at most
//           kMaxPassages), and for each of them passage and vehicle (4 bits each) and number of the ask (1)
//   plan    version (2), flags (1; bit 0: ascending), lanes (1), lanes done (one bit each), owners (4 bits a lane;
//           15: none)
// and the lower 16 bits of the CRC-32 of all before. With 20 lanes a plan has 24 bytes, a status 26, 7 more for each
// obstacle that it tells of, and 3 more for passages with 2 for each turn. Input is untrusted: anything else is no
// packet.
#pragma once

#include <Eigen/Core>
#include <isobath/mission/messages/frame_bytes.hpp>
#include <isobath/mission/plan/mission_plan.hpp>
#include <optional>
#include <variant>

namespace isobath {

/// One bit a lane.
using LaneBits = std::uint64_t;
static_assert(kMaxLanes <= 64);

inline constexpr std::size_t kMostTold = 8;

/// An obstacle that the sender's own sonar has seen.
struct ObstacleWord {
  std::uint8_t key = 0;                                ///< the lower bits of RememberedObstacle::id
  Eigen::Vector2d centre_W = Eigen::Vector2d::Zero();  ///< m, to half a metre
  double radius_m = 0;                                 ///< of a circle about it, with the rounding of the place
  double sigma_m = 0;                                  ///< of its place by the sender's navigation, an axis
  bool operator==(const ObstacleWord&) const = default;
};

/// A vehicle asks to go through a passage of the mission, alone.
struct PassageAsk {
  std::uint8_t passage = 0;  ///< index in the plan
  std::uint8_t number = 0;   ///< of the asks of this vehicle; it wraps
  bool passing = false;      ///< it has got its turn
  bool operator==(const PassageAsk&) const = default;
};
/// The gate keeper gives a vehicle its turn, for one ask.
struct PassageTurn {
  std::uint8_t passage = 0;
  std::uint8_t vehicle = 0;
  std::uint8_t number = 0;  ///< of the ask
  bool operator==(const PassageTurn&) const = default;
};

struct GroupStatus {
  std::uint8_t from = 0;  ///< index of the vehicle in the group
  std::uint16_t number = 0;
  Eigen::Vector2d place_W = Eigen::Vector2d::Zero();  ///< m, to half a metre
  std::optional<std::uint8_t> lane;                   ///< that it is sailing
  std::uint8_t stations = 0;                          ///< of this lane that it has visited
  bool backwards = false;                             ///< whether these are the last ones of the lane
  std::optional<std::uint8_t> leader;                 ///< whose plan it follows
  std::uint16_t version = 0;                          ///< of that plan
  bool over = false;                                  ///< its mission has ended; it will sail no more lanes
  bool ready = false;                                 ///< it waits at its first lane for the others
  std::optional<std::uint16_t> begin_s;               ///< when all begin together: the lower bits of the second
  bool no_way = false;                                ///< it finds no way to its lanes; it sails no more of them
  std::optional<PassageAsk> ask;
  std::uint8_t lanes = 0;          ///< of the area
  std::vector<PassageTurn> turns;  ///< of the gate keeper: whose turn it is; at most kMaxPassages
  LaneBits done = 0;
  std::vector<ObstacleWord> obstacles;  ///< at most kMostTold
  bool operator==(const GroupStatus&) const = default;
};

struct GroupPlan {
  std::uint8_t from = 0;  ///< the leader
  std::uint16_t version = 0;
  bool ascending = true;
  LaneBits done = 0;
  std::vector<std::optional<std::uint8_t>> owner;  ///< by lane: the vehicle
  bool operator==(const GroupPlan&) const = default;
};

FrameBytes to_bytes(const GroupStatus& status);
FrameBytes to_bytes(const GroupPlan& plan);
/// Whether a frame claims to be of a group; frames of the operator's link do not.
bool is_of_group(std::span<const std::uint8_t> bytes);
/// Empty where the bytes are not a whole packet.
std::optional<std::variant<GroupStatus, GroupPlan>> group_word_of(std::span<const std::uint8_t> bytes);

/// Whether a number that wraps is newer than another.
inline bool newer(std::uint16_t number, std::uint16_t than) {
  return number != than && static_cast<std::uint16_t>(number - than) < 0x8000;
}

}  // namespace isobath

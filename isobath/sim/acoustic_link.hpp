// AcousticLink: the modems of several vehicles in one water: range, delay, bit rate, loss, and packets that collide
// (ledger S2-50, S2-51).
//
// A modem sends one packet after the other; a packet of b bytes takes 8 b / bit_rate. It begins to arrive after
// `delay_s` and the way of the sound, and is received when it has arrived whole, unless
//   - the receiver was farther than `range_m` when the packet was sent,
//   - the receiver was itself sending (half duplex),
//   - a packet of another modem arrived at the same time: both are lost,
//   - it is lost by chance, with probability `loss`, for each receiver apart.
// A modem holds `kQueue` packets that wait; further ones are dropped. Every packet that is not received is counted by
// its reason. A function of its calls and the seed; one thread.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/base/time.hpp>
#include <span>
#include <vector>

namespace isobath {

struct AcousticLinkConfig {
  double range_m = 1000;
  double delay_s = 0.5;
  double loss = 0.1;
  double bit_rate = 640;  ///< bit/s
};
std::vector<Field> fields(AcousticLinkConfig& config);

/// Counts of the packets that one vehicle sent. Those of the second row count each receiver.
struct LinkCounts {
  std::uint64_t packets = 0, bytes = 0, dropped = 0;
  std::uint64_t received = 0, out_of_range = 0, deaf = 0, collided = 0, lost = 0;
};

class AcousticLink {
 public:
  static constexpr std::size_t kQueue = 4;
  static constexpr double kSoundSpeed = 1500;  ///< m/s

  AcousticLink(const AcousticLinkConfig& config, std::size_t vehicles, std::uint64_t seed);

  /// A modem is given a packet at a time that is not before that of an earlier call. `places_W`: of all vehicles.
  void send(std::size_t from, Time now, std::vector<std::uint8_t> bytes, std::span<const Eigen::Vector3d> places_W);

  struct Delivery {
    std::size_t to = 0;
    Time time;  ///< when the packet has arrived whole
    std::vector<std::uint8_t> bytes;
  };
  /// The packets that have arrived by this time, in the order of their arrival. All packets that were sent before must
  /// have been given.
  std::vector<Delivery> arrived(Time now);

  /// By vehicle.
  [[nodiscard]] const std::vector<LinkCounts>& counts() const { return counts_; }

 private:
  struct Span {
    Time begin, end;
    [[nodiscard]] bool overlaps(const Span& other) const { return begin < other.end && other.begin < end; }
  };
  struct Packet {
    std::size_t from = 0, to = 0;
    Span arrives;
    std::vector<std::uint8_t> bytes;
    bool done = false;
  };

  AcousticLinkConfig config_;
  std::uint64_t seed_;
  std::uint64_t number_ = 0;                ///< of receptions so far: the key of their chance
  std::vector<std::vector<Span>> sending_;  ///< by vehicle, the last ones
  std::vector<Packet> packets_;             ///< on their way, and those that may still collide
  std::vector<LinkCounts> counts_;
};

}  // namespace isobath

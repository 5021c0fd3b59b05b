#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/sim/acoustic_link.hpp>
#include <isobath/sim/random_at.hpp>
#include <utility>

namespace isobath {

std::vector<Field> fields(AcousticLinkConfig& c) {
  return {Field::real("range_m", &c.range_m, {0, 1e5}, "m", "Greatest distance at which a packet is received."),
          Field::real("delay_s", &c.delay_s, {0.1, 60}, "s", "Delay of the modems, beside the way of the sound."),
          Field::real("loss", &c.loss, {0, 1}, "1", "Share of the packets that each receiver loses."),
          Field::real("bit_rate", &c.bit_rate, {1, 1e6}, "bit/s", "Bits that a modem sends in a second.")};
}

AcousticLink::AcousticLink(const AcousticLinkConfig& config, std::size_t vehicles, std::uint64_t seed)
    : config_(config), seed_(seed), sending_(vehicles), counts_(vehicles) {}

void AcousticLink::send(std::size_t from, Time now, std::vector<std::uint8_t> bytes,
                        std::span<const Eigen::Vector3d> places_W) {
  ISOBATH_ASSERT(from < counts_.size() && places_W.size() == counts_.size());
  const std::vector<std::uint8_t> packet = std::move(bytes);
  std::vector<Span>& own = sending_[from];
  LinkCounts& count = counts_[from];
  const auto waiting = std::ranges::count_if(own, [now](const Span& span) { return span.begin > now; });
  if (static_cast<std::size_t>(waiting) >= kQueue) {
    ++count.dropped;
    return;
  }
  const Time begin = own.empty() ? now : std::max(now, own.back().end);
  const Span span{begin, begin + seconds(8 * static_cast<double>(packet.size()) / config_.bit_rate)};
  own.push_back(span);
  ++count.packets;
  count.bytes += packet.size();
  for (std::size_t to = 0; to < counts_.size(); ++to) {
    if (to == from) continue;
    const double away_m = (places_W[to] - places_W[from]).norm();
    if (!(away_m <= config_.range_m)) {
      ++count.out_of_range;
      continue;
    }
    const Duration on_its_way = seconds(config_.delay_s + away_m / kSoundSpeed);
    packets_.push_back({from, to, {span.begin + on_its_way, span.end + on_its_way}, packet});
  }
}

std::vector<AcousticLink::Delivery> AcousticLink::arrived(Time now) {
  std::stable_sort(packets_.begin(), packets_.end(),
                   [](const Packet& a, const Packet& b) { return a.arrives.end < b.arrives.end; });
  std::vector<Delivery> whole;
  for (Packet& packet : packets_) {
    if (packet.done || packet.arrives.end > now) continue;
    packet.done = true;
    LinkCounts& count = counts_[packet.from];
    const auto disturbs = [&packet](const Packet& other) {
      return other.to == packet.to && other.from != packet.from && other.arrives.overlaps(packet.arrives);
    };
    const auto hides = [&packet](const Span& own) { return own.overlaps(packet.arrives); };
    const double chance = random_at(seed_, packet.to, number_++).uniform();
    if (std::ranges::any_of(sending_[packet.to], hides)) {
      ++count.deaf;
    } else if (std::ranges::any_of(packets_, disturbs)) {
      ++count.collided;
    } else if (chance < config_.loss) {
      ++count.lost;
    } else {
      ++count.received;
      whole.push_back({packet.to, packet.arrives.end, packet.bytes});
    }
  }
  Time oldest = now;
  for (const Packet& packet : packets_) {
    if (!packet.done) oldest = std::min(oldest, packet.arrives.begin);
  }
  std::erase_if(packets_, [&](const Packet& packet) { return packet.done && packet.arrives.end < oldest; });
  for (std::vector<Span>& own : sending_) {
    while (own.size() > 1 && own.front().end < oldest) own.erase(own.begin());
  }
  return whole;
}

}  // namespace isobath

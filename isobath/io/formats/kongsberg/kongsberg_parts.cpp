#include <algorithm>
#include <isobath/io/formats/kongsberg/kongsberg_parts.hpp>

namespace isobath {

WaterRecord* WaterParts::add(const RecordView& record, Time time) {
  constexpr std::size_t kSectors = 44, kSector = 6, kBeam = 10;
  const std::size_t count = record.at<std::uint16_t>(20), number = record.at<std::uint16_t>(22);
  const std::size_t sectors = record.at<std::uint16_t>(24), beams = record.at<std::uint16_t>(28);
  const bool numbered = count > 0 && count <= kMaxParts && number > 0 && number <= count;
  if (!numbered || !record.holds(kSectors, sectors * kSector)) {
    reject(to_text(WaterFault::kBadSizes));
    return nullptr;
  }
  std::array<double, 256> tilts_deg{};  // by sector number
  for (std::size_t i = 0; i < sectors; ++i) {
    const std::size_t at = kSectors + i * kSector;
    tilts_deg[record.at<std::uint8_t>(at + 4)] = 0.01 * record.at<std::int16_t>(at);
  }
  Waiting& ping = waiting_of(record, time, count);
  if (!ping.parts[number - 1].empty()) {
    reject("duplicate part of a water column");
    return nullptr;
  }
  std::vector<Beam> part;
  const std::size_t held = ping.samples.size();
  std::size_t at = kSectors + sectors * kSector;
  for (std::size_t i = 0; i < beams; ++i) {
    const std::size_t size = record.at<std::uint16_t>(at + 4);
    if (!record.holds(at, kBeam + size)) {
      ping.samples.resize(held);
      reject("water column shorter than its beams");
      return nullptr;
    }
    part.push_back({0.01 * record.at<std::int16_t>(at), record.at<std::uint16_t>(at + 2), ping.samples.size(), size,
                    tilts_deg[record.at<std::uint8_t>(at + 8)]});
    const Bytes bytes = record.part(at + kBeam, size);
    ping.samples.insert(ping.samples.end(), bytes.begin(), bytes.end());
    at += kBeam + size;
  }
  if (part.empty()) {
    reject(to_text(WaterFault::kNoSamples));
    return nullptr;
  }
  ping.parts[number - 1] = std::move(part);
  if (--ping.missing > 0) return nullptr;

  whole_ = {};
  whole_.time = time;
  whole_.sample_hz = 0.01 * record.at<std::uint32_t>(32);
  whole_.sound_speed = 0.1 * record.at<std::uint16_t>(30);
  for (const auto& beams_of_part : ping.parts) {
    for (const Beam& b : beams_of_part) {
      whole_.beams.push_back({b.to_port_deg, b.first, Bytes(ping.samples).subspan(b.at, b.count), b.tilt_deg});
    }
  }
  return &whole_;
}

/// The incomplete ping of the record's head. A record of another ping starts a new one.
WaterParts::Waiting& WaterParts::waiting_of(const RecordView& record, Time time, std::size_t parts) {
  const auto counter = record.at<std::uint16_t>(16), serial = record.at<std::uint16_t>(18);
  const auto found =
      std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& w) { return w.serial == serial; });
  if (found != waiting_.end()) {
    if (found->counter == counter && found->time == time && found->parts.size() == parts) return *found;
    forget(found);
  } else if (waiting_.size() == kMaxHeads) {
    forget(waiting_.begin());
  }
  waiting_.push_back({serial, counter, time, std::vector<std::vector<Beam>>(parts), parts, {}});
  return waiting_.back();
}

void WaterParts::forget(std::vector<Waiting>::iterator ping) {
  if (ping->missing > 0) reject("water column with missing parts");
  waiting_.erase(ping);
}

void WaterParts::finish() {
  while (!waiting_.empty()) forget(waiting_.begin());
}

}  // namespace isobath

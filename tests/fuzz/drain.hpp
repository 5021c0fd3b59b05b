// What every fuzz target of a reader does: open the bytes, read all events, look at every sample, and hold the reader
// to its promises.
#pragma once

#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/io/bytes/byte_window.hpp>
#include <isobath/io/open_source.hpp>
#include <vector>

namespace isobath::fuzz {

/// Records of isobath_msgs in a log of ROS are events as they were written, whatever they hold; the gate judges them.
inline bool holds_records(const SourceReport& report) {
  return std::any_of(report.details.begin(), report.details.end(),
                     [](const auto& d) { return d.second.starts_with("isobath_msgs/"); });
}

inline void look_at(const Event& event, const SourceReport& report = {}) {
  if (const Swath* const swath = std::get_if<Swath>(&event)) {
    ISOBATH_ASSERT(check(*swath) == SwathFault::kNone || holds_records(report));
  }
  const Ping* const ping = std::get_if<Ping>(&event);
  if (!ping) return;
  // Sizes and angles are passed on as the device states them; the gate refuses what no map can use.
  const PingFault fault = check(*ping);
  ISOBATH_ASSERT(fault == PingFault::kNone || fault == PingFault::kTooWide || fault == PingFault::kBadScale ||
                 fault == PingFault::kNotFinite || holds_records(report));
  std::vector<float> line(static_cast<std::size_t>(ping->window.bins));
  float sum = 0;
  for (int b = 0; b < ping->fan->beams(); ++b) {
    ping->intensity.copy_beam(b, line.data());
    for (const float v : line) sum += v;
  }
  ISOBATH_ASSERT(!(sum < 0) || holds_records(report));
}

inline void drain(Source& source, std::size_t size) {
  while (const auto event = source.next()) look_at(*event, source.report());
  const SourceReport& report = source.report();
  ISOBATH_ASSERT(report.bytes_skipped <= size);
  std::uint64_t end = 0;
  for (const Damage& d : report.damages) {
    ISOBATH_ASSERT(d.offset + d.bytes <= size);
    end = d.offset + d.bytes;
  }
  ISOBATH_ASSERT(end <= size);
}

template <class Open>
int read_all(const std::uint8_t* data, std::size_t size, Open open) {
  try {
    const Bytes bytes = std::as_bytes(std::span(data, size));
    const auto source = open(ByteWindow("input", bytes, nullptr), InputConfig{});
    drain(*source, size);
  } catch (const Error&) {  // the one answer that is allowed to a header that cannot be right
  }
  return 0;
}

}  // namespace isobath::fuzz

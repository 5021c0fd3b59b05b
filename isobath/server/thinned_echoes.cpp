#include <algorithm>
#include <cstdint>
#include <cstring>
#include <isobath/display/display_bytes.hpp>
#include <isobath/display/display_state.hpp>
#include <isobath/server/thinned_echoes.hpp>
#include <vector>

namespace isobath {
namespace {

constexpr std::size_t kEchoHead = 48, kPlaceAt = 8;

std::size_t padded_samples(std::size_t samples) { return (kEchoHead + samples + 7) / 8 * 8; }

/// Empty if the payload is not that of echoes.
std::string thinned(std::string_view payload, std::size_t each) {
  std::uint16_t size[2];
  if (payload.size() < kEchoHead) return {};
  std::memcpy(size, payload.data(), sizeof size);
  const std::size_t beams = size[0], bins = size[1], bits_at = padded_samples(beams * bins);
  if (payload.size() < bits_at + (beams * bins + 7) / 8) return {};
  const std::size_t rows = (beams + each - 1) / each, columns = (bins + each - 1) / each;
  std::vector<std::uint8_t> samples(rows * columns), bits((samples.size() + 7) / 8);
  for (std::size_t beam = 0; beam < beams; ++beam) {
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const std::size_t from = beam * bins + bin, to = beam / each * columns + bin / each;
      samples[to] = std::max(samples[to], static_cast<std::uint8_t>(payload[kEchoHead + from]));
      const unsigned hit = static_cast<std::uint8_t>(payload[bits_at + from / 8]) >> from % 8 & 1U;
      bits[to / 8] = static_cast<std::uint8_t>(bits[to / 8] | hit << to % 8);
    }
  }
  DisplayBytes bytes;
  const auto share = static_cast<std::uint8_t>(each);
  bytes.add(size[0]).add(size[1]).add(share).add(share).add(std::uint16_t{0});
  const auto* place = reinterpret_cast<const std::uint8_t*>(payload.data()) + kPlaceAt;
  return bytes.append({place, kEchoHead - kPlaceAt}).append(samples).pad_to(8).append(bits).take();
}

}  // namespace

ThinnedEchoes thinned_echoes(std::string_view records, std::size_t max_bytes) {
  ThinnedEchoes out;
  for_each_record(records, [&](const DisplayRecord& r) {
    std::string thin;
    if (r.kind == DisplayKind::kEchoes && r.payload.size() > max_bytes) {
      std::size_t each = 2;
      while (each < ThinnedEchoes::kMostEach && r.payload.size() / (each * each) > max_bytes) ++each;
      thin = thinned(r.payload, each);
      out.thinned = out.thinned || !thin.empty();
    }
    append_record(out.records, r.kind, r.number, r.time, thin.empty() ? r.payload : std::string_view(thin), r.gone);
  });
  return out;
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <cstring>
#include <isobath/io/bytes/sample_arena.hpp>
#include <isobath/io/pooled_bins.hpp>

namespace isobath {
namespace {

template <class Sample>
std::byte* put_mean(std::byte* to, float mean) {
  const auto value = static_cast<Sample>(std::is_integral_v<Sample> ? std::floor(mean + 0.5f) : mean);
  std::memcpy(to, &value, sizeof value);
  return to + sizeof value;
}

std::byte* put_mean(std::byte* to, SampleType type, float mean) {
  switch (type) {
    case SampleType::kU8: return put_mean<std::uint8_t>(to, mean);
    case SampleType::kU16: return put_mean<std::uint16_t>(to, mean);
    case SampleType::kF32: break;
  }
  return put_mean<float>(to, mean);
}

int bytes_per_sample(SampleType type) { return type == SampleType::kU8 ? 1 : type == SampleType::kU16 ? 2 : 4; }

class PooledBins final : public Source {
 public:
  PooledBins(std::unique_ptr<Source> source, int max_bins) : source_(std::move(source)), max_bins_(max_bins) {}

  std::optional<Event> next() override {
    std::optional<Event> event = source_->next();
    auto* ping = event ? std::get_if<Ping>(&*event) : nullptr;
    if (!ping || check(*ping) != PingFault::kNone) return event;
    const double fine = ping->window.end_m() / ping->window.bin_m / max_bins_;
    const int together = static_cast<int>(std::min<double>(ping->window.bins, std::ceil(fine - 1e-9)));
    if (together > 1) pool(*ping, together);
    return event;
  }
  [[nodiscard]] const SourceReport& report() const override { return source_->report(); }

 private:
  /// The spans of the new bins that were sampled completely.
  static std::shared_ptr<const std::vector<BinSpan>> pooled(const std::vector<BinSpan>& fine, int together, int bins) {
    auto spans = std::make_shared<std::vector<BinSpan>>();
    for (const BinSpan& span : fine) {
      const int first = std::min((span.first + together - 1) / together, bins);
      spans->push_back({first, std::clamp(span.end / together, first, bins)});
    }
    return spans;
  }

  void pool(Ping& ping, int together) {
    const int bins = ping.window.bins / together;
    const int beams = ping.intensity.beams(), size = bytes_per_sample(ping.intensity.type());
    std::byte* const samples = arena_.take(std::size_t(beams) * std::size_t(bins) * std::size_t(size));
    std::byte* to = samples;
    beam_.resize(static_cast<std::size_t>(ping.window.bins));
    for (int b = 0; b < beams; ++b) {
      ping.intensity.copy_beam(b, beam_.data());
      const float* fine = beam_.data();
      for (int k = 0; k < bins; ++k) {
        float sum = 0;
        for (int i = 0; i < together; ++i) sum += *fine++;
        to = put_mean(to, ping.intensity.type(), sum / static_cast<float>(together));
      }
    }
    ping.intensity = Intensities(samples, ping.intensity.type(), beams, bins, std::ptrdiff_t{bins} * size, size);
    ping.storage = arena_.owner();
    if (ping.sampled) ping.sampled = pooled(*ping.sampled, together, bins);
    ping.window.bin_m *= together;
    ping.window.bins = bins;
  }

  std::unique_ptr<Source> source_;
  int max_bins_;
  SampleArena arena_;
  std::vector<float> beam_;
};

}  // namespace

std::unique_ptr<Source> with_pooled_bins(std::unique_ptr<Source> source, int max_bins) {
  if (max_bins <= 0) return source;
  return std::make_unique<PooledBins>(std::move(source), max_bins);
}

}  // namespace isobath

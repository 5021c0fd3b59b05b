#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/sonar/fan_cells.hpp>

namespace isobath {
namespace {

constexpr std::array<std::uint16_t, 256> squares() {
  std::array<std::uint16_t, 256> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint16_t>(i * i);
  return all;
}
constexpr std::array<std::uint16_t, 256> kSquares = squares();

/// Beams in the width of one, by the median spacing.
int beams_in_width(const BeamFan& fan) {
  const int beams = fan.beams();
  if (beams < 2) return 1;
  std::vector<double> spacing, width;
  for (int b = 1; b < beams; ++b) spacing.push_back((fan.azimuth[b] - fan.azimuth[b - 1]).radians());
  for (const Angle w : fan.width) width.push_back(w.radians());
  const auto median = [](std::vector<double>& v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  const double ratio = median(width) / median(spacing);
  return std::clamp(static_cast<int>(std::lround(ratio)), 1, beams);
}

std::shared_ptr<const BeamFan> pooled(const BeamFan& fan, int group) {
  auto out = std::make_shared<BeamFan>();
  out->height = fan.height;
  for (int b = 0; b < fan.beams(); b += group) {
    const int end = std::min(b + group, fan.beams());
    const Angle first = fan.azimuth[b], last = fan.azimuth[end - 1];
    out->azimuth.push_back((first + last) / 2);
    out->width.push_back(std::max(fan.width[b], last - first));
  }
  return out;
}

}  // namespace

BinSpan FanCells::beams_of(int beam) const {
  const int first = beam * beams_per_cell_;
  return {first, std::min(first + beams_per_cell_, sample_fan_->beams())};
}

BinSpan FanCells::bins_of(int bin) const {
  const int first = bin * bins_per_cell_;
  return {first, std::min(first + bins_per_cell_, sample_window_.bins)};
}

bool FanCells::prepare(const Ping& ping) {
  const bool same_fan = ping.fan == sample_fan_, same_window = ping.window == sample_window_;
  if (same_fan && same_window) return false;
  if (!same_fan) {
    sample_fan_ = ping.fan;
    beams_per_cell_ = beams_in_width(*ping.fan);
    fan_ = pooled(*ping.fan, beams_per_cell_);
  }
  sample_window_ = ping.window;
  bins_per_cell_ = std::max(1, ping.window.bins / range_cells_);
  const int bins = (ping.window.bins + bins_per_cell_ - 1) / bins_per_cell_;
  window_ = {ping.window.start_m, ping.window.bin_m * bins_per_cell_, bins};
  power_.assign(static_cast<std::size_t>(fan_->beams()) * static_cast<std::size_t>(bins), 0);
  row_.resize(static_cast<std::size_t>(ping.window.bins));
  sums_.resize(static_cast<std::size_t>(bins));
  totals_.resize(static_cast<std::size_t>(bins));
  counts_.resize(static_cast<std::size_t>(bins));
  return true;
}

void FanCells::pool(const Ping& ping) {
  const bool fits = beams_per_cell_ * bins_per_cell_ < (1 << 16);  // else a sum of squares of bytes overflows
  if (ping.intensity.type() == SampleType::kU8 && !ping.sampled && fits) {
    pool_bytes(ping);
  } else {
    pool_any(ping);
  }
}

void FanCells::pool_bytes(const Ping& ping) {
  const Intensities& z = ping.intensity;
  const std::ptrdiff_t across = z.beam_stride(), along = z.bin_stride();
  const int bins = window_.bins, samples = sample_window_.bins;
  const auto* data = reinterpret_cast<const std::uint8_t*>(z.data());
  for (int beam = 0; beam < beams(); ++beam) {
    const BinSpan group = beams_of(beam);
    std::fill(sums_.begin(), sums_.end(), 0u);
    for (int b = group.first; b < group.end; ++b) {
      const std::uint8_t* at = data + b * across;
      for (int k = 0, cell = 0; k < samples; ++cell) {
        std::uint32_t sum = 0;
        for (const int end = std::min(k + bins_per_cell_, samples); k < end; ++k, at += along) sum += kSquares[*at];
        sums_[static_cast<std::size_t>(cell)] += sum;
      }
    }
    float* out = power_.data() + static_cast<std::size_t>(beam) * static_cast<std::size_t>(bins);
    for (int cell = 0; cell < bins; ++cell) {
      const BinSpan span = bins_of(cell);
      const int count = (group.end - group.first) * (span.end - span.first);
      out[cell] = static_cast<float>(sums_[static_cast<std::size_t>(cell)]) / static_cast<float>(count);
    }
  }
}

void FanCells::pool_any(const Ping& ping) {
  const int bins = window_.bins;
  for (int beam = 0; beam < beams(); ++beam) {
    const BinSpan group = beams_of(beam);
    std::fill(totals_.begin(), totals_.end(), 0.f);
    std::fill(counts_.begin(), counts_.end(), 0.f);
    for (int b = group.first; b < group.end; ++b) {
      ping.intensity.copy_beam(b, row_.data());
      const BinSpan heard = sampled_bins(ping, b);
      for (int k = heard.first; k < heard.end; ++k) {
        const auto cell = static_cast<std::size_t>(k / bins_per_cell_);
        const float value = row_[static_cast<std::size_t>(k)];
        totals_[cell] += value * value;
        counts_[cell] += 1;
      }
    }
    float* out = power_.data() + static_cast<std::size_t>(beam) * static_cast<std::size_t>(bins);
    for (int cell = 0; cell < bins; ++cell) {
      const auto at = static_cast<std::size_t>(cell);
      out[cell] = counts_[at] > 0 ? totals_[at] / counts_[at] : -1.f;
    }
  }
}

}  // namespace isobath

#include <algorithm>
#include <isobath/perception/heard_cells.hpp>

namespace isobath {
namespace {

constexpr int kBeamsAPiece = 64;

bool is_set(const std::uint64_t* words, int i) { return (words[i / 64] >> (i % 64) & 1) != 0; }

/// Behind the first echo of enough bins, clear bins tell nothing.
void hide_shadows(const EchoDecisions& decisions, int shadow_bins, int beam, std::uint64_t* tells) {
  const std::uint64_t* hits = decisions.hits(beam);
  int run = 0, bin = 0;
  for (; bin < decisions.bins() && run < shadow_bins; ++bin)
    run = is_set(tells, bin) && is_set(hits, bin) ? run + 1 : 0;
  if (run < shadow_bins) return;
  for (int word = bin / 64; word < decisions.words(); ++word) {
    const std::uint64_t behind = word == bin / 64 ? ~std::uint64_t{0} << (bin % 64) : ~std::uint64_t{0};
    tells[word] &= ~behind | hits[word];
  }
}

}  // namespace

/// What a beam tells, and the sums over its own bins.
void HeardCells::take_beam(const EchoDecisions& decisions, int shadow_bins, int beam) {
  const auto row = static_cast<std::size_t>(beam) * words_;
  std::uint64_t *tells = heard_.data() + row, *echoes = echoes_.data() + row;
  const std::uint64_t *dim = decisions.dim(beam), *hits = decisions.hits(beam);
  for (int w = 0; w < words_; ++w) {
    tells[w] = decisions.usable()[w] & fit_[w];
    if (!dim) continue;
    tells[w] &= ~dim[w] | hits[w];
    for (std::uint64_t loud = dim[w] & tells[w]; loud != 0; loud &= loud - 1) {
      const int bin = 64 * w + std::countr_zero(loud);
      if (!(decisions.p_dim(beam, bin) > decisions.false_alarm)) tells[w] &= ~(loud & -loud);
    }
  }
  if (shadow_bins > 0) hide_shadows(decisions, shadow_bins, beam, tells);
  std::uint32_t sum = 0;  // two counters that wrap around; their differences over a rectangle do not
  std::int32_t* sums = sums_.data() + (static_cast<std::size_t>(beam) + 1) * (static_cast<std::size_t>(bins_) + 1);
  sums[0] = 0;
  for (int w = 0, bin = 0; w < words_; ++w) {
    echoes[w] = tells[w] & hits[w];
    std::uint64_t told = tells[w], hit = echoes[w];
    for (const int end = std::min(64 * (w + 1), bins_); bin < end; ++bin, told >>= 1, hit >>= 1) {
      sum += (static_cast<std::uint32_t>(told & 1) << 16) + static_cast<std::uint32_t>(hit & 1);
      sums[bin + 1] = static_cast<std::int32_t>(sum);
    }
  }
}

void HeardCells::update(const EchoDecisions& decisions, int shadow_bins, ThreadPool& pool) {
  const int beams = decisions.beams(), bins = decisions.bins();
  bins_ = bins;
  words_ = decisions.words();
  fit_.assign(static_cast<std::size_t>(words_), 0);
  for (int bin = 0; bin < bins; ++bin) {
    if (decisions.p_detect[bin] > decisions.false_alarm) fit_[bin / 64] |= std::uint64_t{1} << (bin % 64);
  }
  const auto stride = static_cast<std::size_t>(bins) + 1;
  heard_.resize(static_cast<std::size_t>(beams) * words_);
  echoes_.resize(heard_.size());
  sums_.resize((static_cast<std::size_t>(beams) + 1) * stride);
  std::fill_n(sums_.begin(), stride, 0);
  pool.share(beams, kBeamsAPiece, [&](int begin, int end) {
    for (int beam = begin; beam < end; ++beam) take_beam(decisions, shadow_bins, beam);
  });
  for (std::size_t i = stride; i < sums_.size(); ++i) {  // of the beams before it, too
    sums_[i] =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(sums_[i]) + static_cast<std::uint32_t>(sums_[i - stride]));
  }
}

std::pair<int, int> HeardCells::counts(const MixedVoxel& voxel) const {
  const auto before = [&](int beam, int bin) {
    return static_cast<std::uint32_t>(sums_[static_cast<std::size_t>(beam) * (bins_ + 1) + bin]);
  };
  const std::uint32_t both = before(voxel.beam_end, voxel.bin_end) - before(voxel.beam, voxel.bin_end) -
                             before(voxel.beam_end, voxel.bin) + before(voxel.beam, voxel.bin);
  return {static_cast<int>(both >> 16), static_cast<int>(both & 0xFFFF)};
}

}  // namespace isobath

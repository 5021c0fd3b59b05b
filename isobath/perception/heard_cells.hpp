// HeardCells: which cells (beam, bin) of a ping tell anything, and which of these hold an echo, with their counts over
// any rectangle in four look-ups (summed-area table).
//
// A cell tells something if an echo can be told from noise in it. Behind an echo of `shadow_bins` consecutive bins,
// clear bins of the beam tell nothing: objects there are hidden (S5-57). A dim bin (bottom or surface are loud there)
// tells something only if it holds an echo. Internal to the fan mapper.
#pragma once

#include <bit>
#include <cstdint>
#include <isobath/base/thread_pool.hpp>
#include <isobath/perception/fan_kernel.hpp>
#include <isobath/sonar/echo_decisions.hpp>
#include <utility>
#include <vector>

namespace isobath {

class HeardCells {
 public:
  /// `shadow_bins` 0: no shadows.
  void update(const EchoDecisions& decisions, int shadow_bins, ThreadPool& pool);

  /// Of a voxel's cells: those that tell anything, and of these those that hold an echo.
  [[nodiscard]] std::pair<int, int> counts(const MixedVoxel& voxel) const;
  /// Calls visit(beam, bin) for each cell of a voxel that holds an echo.
  template <class Visit>
  void each_echo(const MixedVoxel& voxel, const Visit& visit) const;
  /// FanView::sums, until the next ping.
  [[nodiscard]] const std::int32_t* sums() const { return sums_.data(); }

 private:
  void take_beam(const EchoDecisions& decisions, int shadow_bins, int beam);

  int bins_ = 0;
  int words_ = 0;                      ///< of a beam in the next two
  std::vector<std::uint64_t> heard_;   ///< bins that tell anything, beam after beam
  std::vector<std::uint64_t> echoes_;  ///< those that hold an echo
  std::vector<std::uint64_t> fit_;     ///< bins in which an echo can be told from noise
  std::vector<std::int32_t> sums_;
};

template <class Visit>
void HeardCells::each_echo(const MixedVoxel& voxel, const Visit& visit) const {
  const int first = voxel.bin / 64, last = (voxel.bin_end - 1) / 64;
  for (int beam = voxel.beam; beam < voxel.beam_end; ++beam) {
    const std::uint64_t* echoes = echoes_.data() + static_cast<std::size_t>(beam) * words_;
    for (int word = first; word <= last; ++word) {
      std::uint64_t left = echoes[word];
      if (word == first) left &= ~std::uint64_t{0} << voxel.bin % 64;
      if (word == last) left &= ~std::uint64_t{0} >> (63 - (voxel.bin_end - 1) % 64);
      for (; left != 0; left &= left - 1) visit(beam, 64 * word + std::countr_zero(left));
    }
  }
}

}  // namespace isobath

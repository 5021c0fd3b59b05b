#include <algorithm>
#include <bit>
#include <isobath/sonar/side_lobes.hpp>

namespace isobath {

void SideLobes::leave_out(const Ping& ping, EchoDecisions& decisions) {
  const int bins = ping.window.bins;
  beam_.resize(static_cast<std::size_t>(bins));
  loudest_.assign(static_cast<std::size_t>(bins), 0);
  around_.resize(static_cast<std::size_t>(bins));
  for (int b = 0; b < ping.fan->beams(); ++b) {
    ping.intensity.copy_beam(b, beam_.data());
    for (std::size_t k = 0; k < loudest_.size(); ++k) loudest_[k] = std::max(loudest_[k], beam_[k]);
  }
  for (int k = 0; k < bins; ++k) {
    const auto from = loudest_.begin() + std::max(0, k - kSmear),
               to = loudest_.begin() + std::min(bins, k + kSmear + 1);
    around_[static_cast<std::size_t>(k)] = *std::max_element(from, to);
  }
  for (int b = 0; b < ping.fan->beams(); ++b) {
    ping.intensity.copy_beam(b, beam_.data());
    for (int w = 0; w < decisions.words(); ++w) {
      for (std::uint64_t left = decisions.hits(b)[w]; left != 0; left &= left - 1) {
        const int bin = 64 * w + std::countr_zero(left);
        const auto k = static_cast<std::size_t>(bin);
        if (beam_[k] < kLevel * around_[k]) decisions.set_blind(b, bin);
      }
    }
  }
}

}  // namespace isobath

#include <isobath/sim/random_at.hpp>

namespace isobath {

std::uint64_t seed_at(std::uint64_t seed, std::uint64_t a, std::uint64_t b) {
  const std::uint64_t first = Random(seed).bits() ^ a;
  const std::uint64_t second = Random(first).bits() ^ b;
  return Random(second).bits();
}

Random random_at(std::uint64_t seed, std::uint64_t a, std::uint64_t b) { return Random(seed_at(seed, a, b)); }

}  // namespace isobath

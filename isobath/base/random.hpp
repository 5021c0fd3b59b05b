// Random: random numbers that are the same on every machine: splitmix64, uniform from the top 53 bits, normal by
// Box-Muller (cosine branch, one pair of uniforms a number). Small, seeded, copyable; not for cryptography.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace isobath {

class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) : state_(seed) {}

  constexpr std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [0, 1).
  constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// An index in [0, count); 0 < count <= 2^53. Bias below count / 2^53.
  constexpr std::uint64_t index(std::uint64_t count) {
    return static_cast<std::uint64_t>(uniform() * static_cast<double>(count));
  }
  /// Standard normal.
  double normal() {
    const double u = 1 - uniform();  // (0, 1]: the logarithm stays finite
    const double v = uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }
  /// An independent stream, for a part whose draws must not change the numbers of the others.
  constexpr Random fork() { return Random(bits()); }

 private:
  std::uint64_t state_;
};

}  // namespace isobath

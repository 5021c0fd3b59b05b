// random_at: random numbers by key instead of by order of drawing, so that parts of a simulation do not affect each
// other's numbers.
#pragma once

#include <isobath/base/random.hpp>

namespace isobath {

/// An independent stream of random numbers for each (seed, a, b).
Random random_at(std::uint64_t seed, std::uint64_t a, std::uint64_t b);
/// The seed of that stream.
std::uint64_t seed_at(std::uint64_t seed, std::uint64_t a, std::uint64_t b);

}  // namespace isobath

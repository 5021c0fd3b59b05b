// random_at: random numbers by place rather than by turn, so that no part of a simulation disturbs another's.
#pragma once

#include <isobath/base/random.hpp>

namespace isobath {

/// A stream of random numbers of its own for each place in (seed, a, b).
Random random_at(std::uint64_t seed, std::uint64_t a, std::uint64_t b);
/// What that stream starts from.
std::uint64_t seed_at(std::uint64_t seed, std::uint64_t a, std::uint64_t b);

}  // namespace isobath

// Counts what the whole program allocates with operator new: "allocates nothing" is a difference of two counts.
#pragma once

#include <cstdint>

namespace isobath::test {

std::uint64_t allocations();

}  // namespace isobath::test

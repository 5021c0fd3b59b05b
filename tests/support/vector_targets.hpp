// Vector targets: the instruction sets that the vector kernels (Highway) are compiled for and that this processor has.
// For tests, which compare the kernels of all of them; otherwise the best one is used.
#pragma once

#include <vector>

namespace isobath::test {

/// Names, best first.
std::vector<const char*> vector_targets();
/// From now on all kernels use only this one; empty: the best. Throws Error for an unknown name.
void use_vector_target(const char* name);

}  // namespace isobath::test

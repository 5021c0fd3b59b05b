// OperatorFrame: what came over the link from the operator, as it arrived: one whole frame, not yet looked into (ledger
// S6-40). Whoever is at the vehicle's end of the link says what it means, and whether it is one at all.
#pragma once

#include <cstdint>
#include <isobath/base/time.hpp>
#include <vector>

namespace isobath {

struct OperatorFrame {
  Time time;  ///< of its arrival
  std::vector<std::uint8_t> bytes;
};

}  // namespace isobath

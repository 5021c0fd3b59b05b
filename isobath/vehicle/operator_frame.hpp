// OperatorFrame: one whole frame as it arrived over the link from the operator or from another vehicle of the group,
// not yet decoded (ledger S6-40, S2-51). The decoder at the vehicle's end of the link interprets it and checks whether
// it is valid.
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

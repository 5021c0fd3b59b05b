// A library of another time: no part of it but the version may be believed.
#include <cstdint>

extern "C" __attribute__((visibility("default"))) const std::uint32_t isobath_agent[8];
const std::uint32_t isobath_agent[8] = {};

// Exit codes of the program: 0 success, 1 the run failed its own checks, 2 bad usage or input, or output that cannot be
// written.
#pragma once

namespace isobath::app {

inline constexpr int kSuccess = 0, kFailedChecks = 1, kBadInput = 2;

}  // namespace isobath::app

// The commit and the compiler of this build, for --version.
#pragma once

namespace isobath::app {

extern const char* const kCommit;    ///< "commit 1a2b3c4", or "no commit" outside of a repository
extern const char* const kCompiler;  ///< "GNU 12.2.0, Release"

}  // namespace isobath::app

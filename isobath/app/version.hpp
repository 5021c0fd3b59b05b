// The commit, the compiler and the build type of this build, for --version.
#pragma once

namespace isobath::app {

extern const char* const kCommit;     ///< "1a2b3c4"; empty outside of a repository
extern const char* const kCompiler;   ///< "GNU 12.2.0"
extern const char* const kBuildType;  ///< "Release"

}  // namespace isobath::app

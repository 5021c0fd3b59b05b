// Tests that enumerate for long are left out where a sanitizer makes them ten times as long: what it could find in
// them, it finds in the shorter tests of the same code.
#pragma once

#include <gtest/gtest.h>

#ifdef ISOBATH_SANITIZED
#define ISOBATH_NOT_SANITIZED() GTEST_SKIP() << "enumerates for long; other tests call the same code"
#else
#define ISOBATH_NOT_SANITIZED() static_cast<void>(0)
#endif

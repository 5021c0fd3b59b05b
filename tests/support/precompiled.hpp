// As cmake/precompiled.hpp, for the tests.
#pragma once

#include <cmake/precompiled.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

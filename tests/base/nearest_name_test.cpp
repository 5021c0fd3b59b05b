#include <gtest/gtest.h>
#include <isobath/base/nearest_name.hpp>

namespace isobath {
namespace {

const std::vector<std::string> kNames{"run", "serve", "sim", "info", "clutter-low", "clutter-high", "false_alarm"};

TEST(NearestName, IsTheOneWithTheFewestOtherLetters) {
  EXPECT_EQ(nearest_name("rnu", kNames), "run") << "an exchange of neighbours is one slip";
  EXPECT_EQ(nearest_name("sevre", kNames), "serve");
  EXPECT_EQ(nearest_name("SERVE", kNames), "serve") << "without regard to case";
  EXPECT_EQ(nearest_name("inf", kNames), "info");
  EXPECT_EQ(nearest_name("clutter-lwo", kNames), "clutter-low");
}

TEST(NearestName, IsAlsoOneThatContainsWhatWasTyped) {
  EXPECT_EQ(nearest_name("alarm", kNames), "false_alarm");
  EXPECT_EQ(nearest_name("clutter", kNames), "clutter-low") << "the first of equals";
}

TEST(NearestName, IsNoneWhereNothingIsNear) {
  EXPECT_EQ(nearest_name("calibrate", kNames), "");
  EXPECT_EQ(nearest_name("xyz", kNames), "");
  EXPECT_EQ(nearest_name("", kNames), "");
  EXPECT_EQ(nearest_name("run", {}), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), kNames), "") << "and no long work";
}

TEST(DidYouMean, IsAQuestionOrNothing) {
  EXPECT_EQ(did_you_mean("serv", kNames), "did you mean serve?");
  EXPECT_EQ(did_you_mean("xyz", kNames), "");
}

}  // namespace
}  // namespace isobath

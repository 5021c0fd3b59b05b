// RevisitRecord: known laws of differences must come back, as shares and as uncertainty.
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/revisit_record.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr double kDay = 60 * 24;  // minutes
constexpr double kNormal95 = 1.96;

/// Soundings of another day over bottoms of all slopes: errors of depth (standard deviation in margins) and position.
RevisitRecord another_day(double vertical, double horizontal_m, double margin_m) {
  Random random(11);
  RevisitRecord record;
  for (int i = 0; i < 20000; ++i) {
    const double slope = 0.5 * random.uniform() * random.uniform();
    const double error = vertical * margin_m * random.normal() + slope * horizontal_m * random.normal();
    record.add({.difference_m = error, .margin_m = margin_m, .confidence = 10, .slope = slope, .apart_min = kDay});
  }
  return record;
}

// ledger: S1-76
TEST(RevisitRecord, FindsTheErrorsOfDepthAndPosition) {
  for (const double margin_m : {0.5, 2.0}) {
    const auto found = another_day(0.3, 3, margin_m).uncertainty();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->apart, RevisitRecord::kSurvey);
    // Slopes of a class differ by half, and with them what errors of position do.
    for (const double slope : {0.0, 0.1, 0.2, 0.3}) {
      const double expected = kNormal95 * std::hypot(0.3 * margin_m, slope * 3);
      EXPECT_NEAR(found->tvu_m(margin_m, slope), expected, 0.25 * expected) << margin_m << " " << slope;
    }
    EXPECT_NEAR(found->tvu_m(margin_m, 0.0), kNormal95 * 0.3 * margin_m, 0.07 * margin_m);
  }
}

// ledger: S1-76
TEST(RevisitRecord, StatesNoLessOnASteeperSlope) {
  Random random(13);
  RevisitRecord record;
  for (int i = 0; i < 600; ++i) {
    record.add({.difference_m = 0.4 * random.normal(), .slope = 0.6 * random.uniform(), .apart_min = kDay});
  }
  const auto found = record.uncertainty();
  ASSERT_TRUE(found);
  for (double slope = 0; slope < 1; slope += 0.01) {
    EXPECT_GE(found->tvu_m(0.5, slope + 0.01), found->tvu_m(0.5, slope));
    EXPECT_NEAR(found->tvu_m(0.5, slope), kNormal95 * 0.4, 0.25) << "slopes do not matter here";
  }
}

TEST(RevisitRecord, WithoutSlopesItStatesOneQuantile) {
  Random random(12);
  RevisitRecord record;
  for (int i = 0; i < 5000; ++i) record.add({.difference_m = 0.1 * random.normal(), .apart_min = kDay});
  const auto found = record.uncertainty();
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->tvu_m(0.5, std::nullopt), kNormal95 * 0.1, 0.02);
}

// ledger: S1-45 S1-76
TEST(RevisitRecord, PromisesWhatEachConfidenceHasKept) {
  RevisitRecord record;
  for (int i = 0; i < 100; ++i) {
    record.add({.difference_m = i < 80 ? 0.1 : 1.0, .confidence = 7, .apart_min = kDay});
    record.add({.difference_m = i < 97 ? 0.1 : 1.0, .confidence = 12, .apart_min = kDay});
    record.add({.difference_m = 2.0, .confidence = 7, .apart_min = 10});  // of the same survey
  }
  EXPECT_NEAR(record.promise(5)->share, 80.5 / 101, 1e-12);
  EXPECT_NEAR(record.promise(14)->share, 97.5 / 101, 1e-12);
  EXPECT_EQ(record.promise(14)->apart, RevisitRecord::kSurvey);
  EXPECT_NEAR(record.promise(20)->share, 177.5 / 201, 1e-12) << "of all, for there is none of this class";
  EXPECT_EQ(record.count(RevisitRecord::kPass), 100u);
}

TEST(RevisitRecord, StatesNothingOfFewAndIgnoresWhatIsNone) {
  RevisitRecord record;
  EXPECT_FALSE(record.promise(10));
  EXPECT_FALSE(record.uncertainty());
  for (int i = 0; i < 29; ++i) record.add({.difference_m = 0.1, .apart_min = 10});
  EXPECT_FALSE(record.uncertainty()) << "one is lacking";
  const RevisitRecord before = record;
  record.add({.difference_m = NAN, .apart_min = 10});
  record.add({.difference_m = 0, .margin_m = 0, .apart_min = 10});
  record.add({.difference_m = 0, .apart_min = 4});
  record.add({.difference_m = 0, .confidence = -1, .apart_min = 10});
  EXPECT_EQ(record, before);
  record.add(
      {.difference_m = 1e300, .confidence = 99, .slope = std::numeric_limits<double>::infinity(), .apart_min = 10});
  ASSERT_TRUE(record.uncertainty());
  EXPECT_EQ(record.uncertainty()->apart, RevisitRecord::kPass);
  EXPECT_TRUE(std::isfinite(record.uncertainty()->tvu_m(0.5, 0.1)));
}

TEST(RevisitRecord, IsTheSameFromItsWordsAndAddsUp) {
  const RevisitRecord one = another_day(0.3, 3, 0.5);
  EXPECT_EQ(RevisitRecord::of(one.words()), one);
  RevisitRecord two = one;
  two += one;
  EXPECT_EQ(two.count(RevisitRecord::kSurvey), 40000u);
  EXPECT_NEAR(two.uncertainty()->tvu_m(0.5, 0.1), one.uncertainty()->tvu_m(0.5, 0.1), 1e-12);
}

}  // namespace
}  // namespace isobath

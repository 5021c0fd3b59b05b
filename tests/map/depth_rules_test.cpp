// The rule by which readings change what is believed of one pixel.
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/depth_rules.hpp>
#include <rapidcheck/gtest.h>

namespace isobath {
namespace {

DepthPixel charted(double depth_m, int confidence) {
  return {DepthPixel::word_of_depth(depth_m), DepthPixel::word_of_state(confidence, 0, 0)};
}

PixelReading says(Claim claim, double depth_m, int step) {
  return {.claim = claim,
          .depth_cm = static_cast<std::int32_t>(std::lround(100 * depth_m)),
          .margin_cm = 50,
          .step = step,
          .flag = claim == Claim::kBottomAt ? kSeenByDepth : kSeenByObstacle,
          .minute = 7};
}

int readings_until_replaced(int confidence, int threshold, int step) {
  DepthRules rules;
  rules.threshold = threshold;
  DepthPixel pixel = charted(10, confidence);
  for (int n = 1; n < 100; ++n) {
    if (apply(pixel, says(Claim::kBottomAt, 5, step), rules) == Verdict::kReplaced) return n;
  }
  return 0;
}

// ledger: S1-47
TEST(DepthRules, a_new_depth_is_believed_after_the_predicted_number_of_readings) {
  for (int threshold = 1; threshold <= kFullConfidence; ++threshold) {
    for (int confidence = threshold; confidence <= kFullConfidence; ++confidence) {
      for (int step = 1; step <= 4; ++step) {
        EXPECT_EQ(readings_until_replaced(confidence, threshold, step), (confidence - threshold) / step + 1)
            << "confidence " << confidence << ", threshold " << threshold << ", step " << step;
      }
    }
  }
  EXPECT_EQ(readings_until_replaced(4, 2, 1), 3);  // the paper's 3 to 4 readings
  EXPECT_EQ(readings_until_replaced(5, 2, 1), 4);
}

// ledger: S1-76
TEST(DepthRules, what_was_confirmed_500_times_is_unlearned_after_19_clear_readings) {
  const DepthRules rules;
  DepthPixel pixel = charted(3, 5);
  for (int i = 0; i < 500; ++i) apply(pixel, says(Claim::kAtMost, 3, 1), rules);
  EXPECT_EQ(pixel.confidence(), kFullConfidence);
  int readings = 0;
  Verdict verdict = Verdict::kConflicted;
  while (verdict != Verdict::kReplaced && readings < 1000) {
    verdict = apply(pixel, says(Claim::kAtLeast, 6, 1), rules);
    ++readings;
  }
  EXPECT_EQ(readings, 19);
  EXPECT_DOUBLE_EQ(pixel.depth_m(), 6);
}

// ledger: S1-51, S1-62, S1-63, S1-E09
TEST(DepthRules, readings_affirm_conflict_or_say_nothing) {
  const DepthPixel at_10 = charted(10, 5);
  EXPECT_EQ(judge(at_10, says(Claim::kBottomAt, 10.5, 2)), Verdict::kAffirmed);  // within the margin of 0.5 m
  EXPECT_EQ(judge(at_10, says(Claim::kBottomAt, 10.51, 2)), Verdict::kConflicted);
  EXPECT_EQ(judge(at_10, says(Claim::kBottomAt, 9.49, 2)), Verdict::kConflicted);
  EXPECT_EQ(judge(at_10, says(Claim::kAtLeast, 9, 1)), Verdict::kIrrelevant);  // never gains by clear water
  EXPECT_EQ(judge(at_10, says(Claim::kAtLeast, 10, 1)), Verdict::kIrrelevant);
  EXPECT_EQ(judge(at_10, says(Claim::kAtLeast, 11, 1)), Verdict::kConflicted);
  EXPECT_EQ(judge(at_10, says(Claim::kAtMost, 11, 1)), Verdict::kAffirmed);
  EXPECT_EQ(judge(at_10, says(Claim::kAtMost, 10, 1)), Verdict::kAffirmed);
  EXPECT_EQ(judge(at_10, says(Claim::kAtMost, 9, 1)), Verdict::kConflicted);
  EXPECT_EQ(judge(at_10, says(Claim::kSomewhere, 11, 1)), Verdict::kAffirmed);
  EXPECT_EQ(judge(at_10, says(Claim::kSomewhere, 9, 1)), Verdict::kIrrelevant);
}

// ledger: S1-48
TEST(DepthRules, one_reading_moves_the_confidence_by_the_step_of_its_sensor) {
  const DepthRules rules;
  DepthPixel pixel = charted(10, 8);
  apply(pixel, says(Claim::kBottomAt, 10, 2), rules);
  EXPECT_EQ(pixel.confidence(), 10);
  apply(pixel, says(Claim::kAtMost, 9, 1), rules);
  EXPECT_EQ(pixel.confidence(), 9);
}

// ledger: S1-45, S1-49, S2-36
RC_GTEST_PROP(DepthRulesProperty, depth_changes_only_by_conflict_and_confidence_keeps_its_range, ()) {
  const DepthRules rules;
  DepthPixel pixel = charted(*rc::gen::inRange(0, 30), rules.base_prior);
  for (int i = 0; i < 100; ++i) {
    const auto claim = static_cast<Claim>(*rc::gen::inRange(0, 4));
    const PixelReading reading = says(claim, 0.1 * *rc::gen::inRange(0, 300), *rc::gen::inRange(1, 5));
    const DepthPixel before = pixel;
    const Verdict verdict = apply(pixel, reading, rules);
    RC_ASSERT(pixel.confidence() >= 0 && pixel.confidence() <= kFullConfidence);
    if (verdict == Verdict::kIrrelevant) RC_ASSERT(pixel == before);
    if (verdict != Verdict::kReplaced) RC_ASSERT(pixel.depth_word == before.depth_word);
    if (verdict == Verdict::kReplaced) {
      RC_ASSERT(pixel.confidence() == rules.base_sensor);
      RC_ASSERT(pixel.has(kSensed));
      RC_ASSERT(pixel.depth_cm() == reading.depth_cm);
      RC_ASSERT(judge(before, reading) == Verdict::kConflicted);
    }
    const bool stands_for_it = verdict == Verdict::kAffirmed || verdict == Verdict::kReplaced;
    // What a beam without an echo clears, no sonar has seen: nothing is known below it.
    const unsigned seen = reading.claim == Claim::kAtLeast ? 0 : reading.flag;
    RC_ASSERT(((pixel.flags() & seen) == seen) || !stands_for_it);
    if (verdict == Verdict::kConflicted) RC_ASSERT(pixel.flags() == before.flags());
    if (verdict == Verdict::kReplaced) RC_ASSERT(pixel.flags() == (seen | kSensed));
  }
}

TEST(DepthRules, a_reading_that_does_not_count_leaves_an_unknown_pixel_unsure_until_one_counts) {
  const DepthRules rules;
  DepthPixel pixel;
  PixelReading weak = says(Claim::kBottomAt, 8, 0), strong = says(Claim::kBottomAt, 8.1, 3);
  EXPECT_EQ(apply(pixel, weak, rules), Verdict::kReplaced);
  EXPECT_TRUE(pixel.known() && rules.unsure(pixel));
  EXPECT_EQ(apply(pixel, strong, rules), Verdict::kReplaced) << "it agrees, and is the first that counts";
  EXPECT_EQ(pixel.confidence(), rules.base_sensor);
  EXPECT_DOUBLE_EQ(pixel.depth_m(), 8.1);
  weak.depth_cm = 300;
  EXPECT_EQ(apply(pixel, weak, rules), Verdict::kConflicted);
  EXPECT_EQ(pixel.confidence(), rules.base_sensor);
}

// ledger: S1-62 S1-63
TEST(DepthRules, clear_water_down_to_a_depth_is_told_from_an_object_that_reaches_up_to_it) {
  const DepthRules rules;
  DepthPixel clear, object;
  PixelReading reading = says(Claim::kAtLeast, 5, 1);
  reading.flag = kSeenByObstacle;
  apply(clear, reading, rules);
  reading.claim = Claim::kAtMost;
  apply(object, reading, rules);
  EXPECT_TRUE(clear.clear_only());
  EXPECT_FALSE(object.clear_only());
  apply(clear, reading, rules);
  EXPECT_FALSE(clear.clear_only()) << "something reaches up to there";
}

// ledger: S1-46
TEST(DepthRules, constants_that_do_not_fit_together_are_refused) {
  DepthRules rules;
  rules.check();
  rules.base_sensor = rules.base_prior;
  EXPECT_THROW(rules.check(), Error);
  rules = {};
  rules.threshold = rules.base_prior + 1;
  EXPECT_THROW(rules.check(), Error);
}

// ledger: S1-50, S1-D08
// 5 % of the readings of a true bottom at 10 m are spurious: higher bases delay what is new and let fewer spurious
// readings through.
TEST(DepthRules, a_higher_base_delays_detection_and_keeps_false_obstacles_out) {
  int last_delay = 0, last_false = 1 << 30;
  for (int base = 2; base <= 15; ++base) {
    DepthRules rules;
    rules.base_prior = base;
    rules.base_sensor = base + 1;
    Random random(42);
    int false_obstacles = 0;
    DepthPixel pixel = charted(10, base);
    for (int i = 0; i < 20000; ++i) {
      // Charted anew every 20 readings: a vehicle that comes to places it has not seen.
      if (i % 20 == 0) pixel = charted(10, base);
      const bool spurious = random.uniform() < 0.05;
      const Verdict verdict =
          apply(pixel, says(spurious ? Claim::kAtMost : Claim::kAtLeast, spurious ? 4 : 8, 1), rules);
      false_obstacles += verdict == Verdict::kReplaced && pixel.depth_m() < 5 ? 1 : 0;
    }
    const int delay = readings_until_replaced(base, rules.threshold, 1);
    EXPECT_GE(delay, last_delay) << base;
    EXPECT_LE(false_obstacles, last_false) << base;
    last_delay = delay;
    last_false = false_obstacles;
  }
  EXPECT_EQ(last_delay, 14);
  EXPECT_EQ(last_false, 0);
}

TEST(DepthRules, an_unknown_pixel_takes_the_first_depth_it_is_given) {
  const DepthRules rules;
  for (const Claim claim : {Claim::kBottomAt, Claim::kAtLeast, Claim::kAtMost}) {
    DepthPixel pixel;
    EXPECT_EQ(apply(pixel, says(claim, 4, 1), rules), Verdict::kReplaced);
    EXPECT_DOUBLE_EQ(pixel.depth_m(), 4);
  }
  DepthPixel pixel;
  EXPECT_EQ(apply(pixel, says(Claim::kSomewhere, 4, 1), rules), Verdict::kIrrelevant);
  EXPECT_FALSE(pixel.known());
}

TEST(DepthRules, refining_moves_an_agreeing_depth_by_its_share) {
  DepthRules rules;
  rules.refine = true;
  DepthPixel pixel;
  apply(pixel, says(Claim::kBottomAt, 10, 2), rules);  // confidence 6
  apply(pixel, says(Claim::kBottomAt, 10.4, 2), rules);
  EXPECT_NEAR(pixel.depth_m(), 10 + 0.4 * 2 / 8, 0.005);
  EXPECT_EQ(pixel.confidence(), 8);
}

// ledger: S1-18
TEST(DepthPixel, words_hold_depth_confidence_flags_and_age) {
  for (const double depth : {-3.17, 0.0, 0.01, 9.3, 10994.0}) {
    const DepthPixel pixel{DepthPixel::word_of_depth(depth), DepthPixel::word_of_state(20, kTrack | kSensed, 4000000)};
    EXPECT_NEAR(pixel.depth_m(), depth, 1e-9);
    EXPECT_LT(pixel.depth_word, 1U << 31);
    EXPECT_LT(pixel.state_word, 1U << 31);
    EXPECT_EQ(pixel.confidence(), 20);
    EXPECT_TRUE(pixel.has(kTrack));
    EXPECT_FALSE(pixel.has(kSeenByDepth));
    EXPECT_TRUE(pixel.has(kSensed));
    EXPECT_EQ(pixel.minute(), 4000000U);
  }
  const DepthPixel late{0, DepthPixel::word_of_state(0, 0, 0xffffffffU)};
  EXPECT_EQ(late.minute(), DepthPixel::kLastMinute);
}

}  // namespace
}  // namespace isobath

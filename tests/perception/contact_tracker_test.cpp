#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/perception/contact_tracker.hpp>
#include <numbers>
#include <tests/support/count_allocations.hpp>

namespace isobath::contact_tracker {
namespace {

using Eigen::Vector2d;
using Origin = Contact::Origin;

constexpr double kSigma_deg = 3;

RememberedObstacle obstacle(int number, double north, double east, double half_north = 8, double half_east = 3) {
  RememberedObstacle o;
  o.id = static_cast<std::uint32_t>(number);
  o.number = number;
  o.margin_m = 1;
  o.outline_W = {{north - half_north, east - half_east},
                 {north + half_north, east - half_east},
                 {north + half_north, east + half_east},
                 {north - half_north, east + half_east}};
  return o;
}

/// A vehicle that hears sounds.
struct Listener {
  explicit Listener(ContactConfig config = {}, std::uint64_t seed = 1)
      : tracker(config), random(seed), bias_deg(0.5 * kSigma_deg * random.normal()) {}
  void hear(const Vector2d& at, const Vector2d& sound, double frequency_hz) {
    const Vector2d d = sound - at;
    const double own = std::sqrt(0.75) * kSigma_deg;
    PassiveBearing heard;
    heard.time = Time(seconds(now_s));
    heard.sigma = Angle::degrees(kSigma_deg);
    heard.bearing = Angle::radians(std::atan2(d.y(), d.x())) + Angle::degrees(bias_deg + own * random.normal());
    heard.frequency_hz = frequency_hz;
    heard.resolution_hz = 0.5;
    tracker.hear(heard, {Pose{Rotation(), {at.x(), at.y(), 4}}, 0.3, 0});
  }
  const Contact& judge(const std::vector<RememberedObstacle>& known) {
    tracker.update(Time(seconds(now_s)), known);
    return tracker.contacts().front();
  }
  /// North along east 0 from `from` to `to`, a bearing a second at 0.8 m/s.
  void pass(const Vector2d& sound, double from, double to, double frequency_hz = 120) {
    for (double north = from; north <= to; north += 0.8, now_s += 1) hear({north, 0}, sound, frequency_hz);
  }
  ContactTracker tracker;
  Random random;
  double bias_deg;
  double now_s = 0;
};

// ledger: S4-54
TEST(ContactTracker, ABearingOnlyTrackIsAttachedToTheObstacleInThatDirection) {
  const std::vector<RememberedObstacle> known{obstacle(3, 30, 20), obstacle(7, 66, 20)};
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Listener listener({}, seed);
    listener.pass({30, 20}, -10, 50);
    const Contact& contact = listener.judge(known);
    EXPECT_EQ(contact.bearings, 76U);
    EXPECT_NEAR(contact.frequency_hz, 120, 1e-6);
    EXPECT_NEAR(contact.none + contact.probability, 1, 0.01);
    right += contact.origin == Origin::kObstacle && contact.obstacle == 3 ? 1 : 0;
    ASSERT_TRUE(contact.place) << "its bearings cross";
    const Vector2d off = contact.place->mean - Vector2d(30, 20);
    EXPECT_LT(off.dot(contact.place->covariance.inverse() * off), 18) << "1 in 8000";
  }
  EXPECT_EQ(right, 20);
}

// ledger: S4-54
TEST(ContactTracker, AVehicleThatStaysWhereItIsCannotTellWhatLiesBehindOneAnother) {
  Listener listener;
  const std::vector<RememberedObstacle> known{obstacle(1, 0, 25, 3), obstacle(2, 0, 60, 6)};
  for (int i = 0; i < 300; ++i, listener.now_s += 1) listener.hear({0, 0}, {0, 60}, 120);
  EXPECT_EQ(listener.judge(known).origin, Origin::kUnknown);
  EXPECT_FALSE(listener.tracker.contacts().front().place);
  listener.pass({0, 60}, 0, 45);
  EXPECT_EQ(listener.judge(known).obstacle, 2) << "once it has moved";
}

// ledger: S4-54
TEST(ContactTracker, ASoundWithoutAnObstacleBelongsToNone) {
  Listener listener;
  listener.pass({30, -45}, -10, 50);
  const std::vector<RememberedObstacle> known{obstacle(3, 30, 20), obstacle(7, 30, -18)};
  EXPECT_EQ(listener.judge(known).origin, Origin::kNone) << "it lies behind obstacle 7";
  EXPECT_EQ(listener.judge({}).origin, Origin::kNone);
}

// ledger: S4-54
TEST(ContactTracker, DetachesWhereTheProbabilityFalls) {
  Listener listener;
  listener.pass({30, 20}, -10, 50);
  EXPECT_EQ(listener.judge({obstacle(3, 30, 20)}).obstacle, 3);
  EXPECT_EQ(listener.tracker.contacts().front().attached_after, 76U);
  EXPECT_EQ(listener.judge({obstacle(3, 30, 20), obstacle(4, 30, 20)}).origin, Origin::kUnknown) << "two in one place";
  EXPECT_EQ(listener.judge({obstacle(4, 80, 20)}).origin, Origin::kNone);
  EXPECT_EQ(listener.tracker.contacts().front().changes, 3U);
}

TEST(ContactTracker, LinesAreToldApartByFrequencyAndDirection) {
  Listener listener;
  for (int i = 0; i < 200; ++i, listener.now_s += 1) {
    const Vector2d at(0.5 * i, 0);
    listener.hear(at, {50, 40}, 120 + 0.02 * i);  // a motor that speeds up by 4 Hz, eight cells
    listener.hear(at, {50, 40}, 130);
    listener.hear(at, {50, -40}, 130);  // the same frequency from the other side
  }
  listener.judge({});
  ASSERT_EQ(listener.tracker.contacts().size(), 3U);
  for (const Contact& contact : listener.tracker.contacts()) EXPECT_EQ(contact.bearings, 200U);
  EXPECT_EQ(listener.tracker.left_out(), 0U);
}

TEST(ContactTracker, MoreLinesThanItKeepsAreCounted) {
  Listener listener;
  for (int i = 0; i < 10; ++i, listener.now_s += 1) {
    for (int line = 0; line < 20; ++line) listener.hear({0, 0}, {0, 30}, 100 + 10 * line);
  }
  listener.judge({});
  EXPECT_EQ(listener.tracker.contacts().size(), ContactTracker::kLines);
  EXPECT_EQ(listener.tracker.left_out(), 40U);
  EXPECT_EQ(listener.tracker.bearings(), 200U);
}

TEST(ContactTracker, ALineThatWasHardlyHeardMakesRoom) {
  Listener listener;
  for (int line = 0; line < 16; ++line) listener.hear({0, 0}, {0, 30}, 100 + 10 * line);
  listener.now_s = 60;
  for (int i = 0; i < 10; ++i, listener.now_s += 1) listener.hear({0, 0}, {0, 30}, 999);
  EXPECT_NEAR(listener.judge({}).frequency_hz, 999, 1e-6);
  EXPECT_EQ(listener.tracker.left_out(), 0U);
}

TEST(ContactTracker, MovesAlongWithAJumpOfThePosition) {
  Listener listener;
  listener.pass({30, 20}, -10, 50);
  listener.tracker.move({100, -40});
  EXPECT_EQ(listener.judge({obstacle(3, 130, -20)}).obstacle, 3);
}

TEST(ContactTracker, HearingAllocatesNothing) {
  Listener listener;
  listener.pass({30, 20}, -10, 50);
  const std::uint64_t before = test::allocations();
  listener.pass({30, 20}, 50, 150);
  EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace isobath::contact_tracker

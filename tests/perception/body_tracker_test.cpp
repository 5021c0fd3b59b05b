// Tracks against the bodies whose readings they were given, in clutter.
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/perception/tracking/body_tracker.hpp>
#include <limits>
#include <map>
#include <set>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Path = std::function<Vector2d(double)>;

constexpr double kSide = 60;  // m: the water that is looked at, centred on zero
constexpr double kSigma = 0.3;

Time at(double seconds_in) { return Time(isobath::seconds(seconds_in)); }

/// The whole square is looked at alike.
struct Square final : BodyTracker::Coverage {
  explicit Square(double detection_in) : probability(detection_in) {}
  [[nodiscard]] double detection(const Vector2d& p) const override {
    return p.cwiseAbs().maxCoeff() <= kSide / 2 ? probability : 0;
  }
  double probability;
};

BodyReading reading_at(const Vector2d& p) {
  BodyReading r;
  r.p_W = p;
  r.covariance = kSigma * kSigma * Matrix2d::Identity();
  return r;
}

/// Looks at 1 Hz: each body is read with the probability of the coverage, and `clutter` false readings fall anywhere.
class Sea {
 public:
  Sea(std::vector<Path> bodies, double detection, int clutter, std::uint64_t seed)
      : bodies_(std::move(bodies)), square_(detection), clutter_(clutter), random_(seed) {}

  std::vector<BodyReading> look(double t) {
    std::vector<BodyReading> readings;
    for (const Path& body : bodies_) {
      const Vector2d p = body(t);
      if (random_.uniform() < square_.detection(p))
        readings.push_back(reading_at(p + kSigma * Vector2d(random_.normal(), random_.normal())));
    }
    for (int k = 0; k < clutter_; ++k) {
      readings.push_back(reading_at({random_.uniform(-kSide / 2, kSide / 2), random_.uniform(-kSide / 2, kSide / 2)}));
    }
    return readings;
  }
  [[nodiscard]] const Square& coverage() const { return square_; }
  [[nodiscard]] Vector2d truth(std::size_t body, double t) const { return bodies_[body](t); }

 private:
  std::vector<Path> bodies_;
  Square square_;
  int clutter_;
  Random random_;
};

Path straight(const Vector2d& from, const Vector2d& velocity) {
  return [=](double t) -> Vector2d { return from + t * velocity; };
}

BodyTrackerConfig config_for(int clutter) {
  BodyTrackerConfig config;
  config.clutter = std::max(clutter, 1) / (kSide * kSide);
  return config;
}

const BodyTrack* nearest_confirmed(const BodyTracker& tracker, const Vector2d& p, double within) {
  const BodyTrack* nearest = nullptr;
  for (const BodyTrack& track : tracker.tracks()) {
    const double distance = (track.filter.position() - p).norm();
    if (track.confirmed && distance < within) {
      nearest = &track;
      within = distance;
    }
  }
  return nearest;
}

std::size_t confirmed(const BodyTracker& tracker) {
  return static_cast<std::size_t>(std::ranges::count_if(tracker.tracks(), &BodyTrack::confirmed));
}

// ledger: S3-04 S3-15
TEST(BodyTracker, HoldsACrossingBodyInClutterByOneNumber) {
  int held = 0, looks = 0;
  double false_tracks = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    constexpr int kClutter = 10;
    Sea sea({straight({-25, -10}, {0.8, 0.3})}, 0.9, kClutter, seed);
    BodyTracker tracker(config_for(kClutter), {});
    std::set<std::uint32_t> numbers;
    for (int k = 0; k < 60; ++k) {
      tracker.update(at(k), sea.look(k), sea.coverage());
      if (k < 10) continue;
      ++looks;
      const BodyTrack* track = nearest_confirmed(tracker, sea.truth(0, k), 2);
      held += track != nullptr;
      if (track != nullptr) numbers.insert(track->number);
      false_tracks += static_cast<double>(confirmed(tracker)) - (track != nullptr ? 1 : 0);
    }
    EXPECT_LE(numbers.size(), 2U) << seed;
  }
  EXPECT_GT(held, 0.95 * looks);
  EXPECT_LT(false_tracks, 0.1 * looks);
}

// Two bodies cross at an angle of 40 degrees in the middle of the water, at the same time. ledger: S3-15
TEST(BodyTracker, KeepsTwoThatCrossApart) {
  int switched = 0;
  constexpr int kRuns = 40;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    Sea sea({straight({-20, -7}, {1, 0.35}), straight({-20, 7}, {1, -0.35})}, 0.9, 5, seed);
    BodyTracker tracker(config_for(5), {});
    std::uint32_t before = 0, after = 0;
    for (int k = 0; k <= 40; ++k) {
      tracker.update(at(k), sea.look(k), sea.coverage());
      const BodyTrack* track = nearest_confirmed(tracker, sea.truth(0, k), 2);
      if (k == 12 && track != nullptr) before = track->number;
      if (k == 35 && track != nullptr) after = track->number;
    }
    switched += before == 0 || before != after;
  }
  EXPECT_LE(switched, 3);
}

// What is moored gets no velocity: less than 0.1 m/s in 95 % of the confirmed tracks. ledger: S3-15
TEST(BodyTracker, GivesMooredBodiesNoVelocity) {
  int fast = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Sea sea({straight({-10, 5}, {0, 0}), straight({12, 3}, {0, 0}), straight({3, -15}, {0, 0})}, 0.8, 10, seed);
    BodyTracker tracker(config_for(10), {});
    for (int k = 0; k < 40; ++k) {
      tracker.update(at(k), sea.look(k), sea.coverage());
      if (k < 20) continue;
      for (const BodyTrack& track : tracker.tracks()) {
        if (!track.confirmed) continue;
        ++all;
        fast += track.filter.estimate().mean.segment<2>(2).norm() > 0.1;
      }
    }
  }
  EXPECT_GT(all, 1000);
  EXPECT_LT(fast, 0.05 * all);
}

TEST(BodyTracker, ForgetsWhatLeavesAndIsMissedOnlyWhereItIsLookedAt) {
  Sea sea({straight({0, 0}, {0, 0})}, 0.9, 0, 1);
  BodyTracker tracker(config_for(1), {});
  for (int k = 0; k < 10; ++k) tracker.update(at(k), sea.look(k), sea.coverage());
  ASSERT_EQ(confirmed(tracker), 1U);
  const Square blind(0);
  for (int k = 10; k < 40; ++k) tracker.update(at(k), {}, blind);  // nothing looks there
  EXPECT_EQ(confirmed(tracker), 1U);
  for (int k = 40; k < 46; ++k) tracker.update(at(k), {}, sea.coverage());
  EXPECT_EQ(confirmed(tracker), 0U);
}

TEST(BodyTracker, FollowsABodyThatStopsAndOneThatStarts) {
  const Path stops = [](double t) -> Vector2d { return {std::min(t, 20.0) - 20, 5}; };
  const Path starts = [](double t) -> Vector2d { return {std::max(t, 20.0) - 20, -5}; };
  int wrong = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Sea sea({stops, starts}, 0.9, 3, seed);
    BodyTracker tracker(config_for(3), {});
    for (int k = 0; k <= 40; ++k) tracker.update(at(k), sea.look(k), sea.coverage());
    const BodyTrack* stopped = nearest_confirmed(tracker, sea.truth(0, 40), 2);
    const BodyTrack* started = nearest_confirmed(tracker, sea.truth(1, 40), 2);
    if (stopped == nullptr || started == nullptr) {
      ++wrong;
      continue;
    }
    const auto speed = [](const BodyTrack& t) { return t.filter.estimate().mean.segment<2>(2).norm(); };
    wrong += speed(*stopped) > 0.2 || std::abs(speed(*started) - 1) > 0.25;
  }
  EXPECT_LE(wrong, 2);
}

// Two bodies that come together, go side by side for 15 s nearer than the sonar can tell them apart, and part.
TEST(BodyTracker, FollowsTwoThatMergeAndPart) {
  const auto side = [](double sign) {
    return [sign](double t) -> Vector2d {
      const double apart = t < 15 ? 15 - t : t > 30 ? t - 30 : 0;
      return {0.8 * t - 20, sign * (0.05 + 0.6 * apart)};
    };
  };
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Sea sea({side(1), side(-1)}, 0.9, 3, seed);
    BodyTracker tracker(config_for(3), {});
    for (int k = 0; k <= 44; ++k) {
      std::vector<BodyReading> readings = sea.look(k);
      if (k >= 14 && k <= 31) std::erase_if(readings, [](const BodyReading& r) { return r.p_W.y() < -0.6; });
      tracker.update(at(k), readings, sea.coverage());
    }
    right += nearest_confirmed(tracker, sea.truth(0, 44), 2) != nullptr &&
             nearest_confirmed(tracker, sea.truth(1, 44), 2) != nullptr &&
             nearest_confirmed(tracker, sea.truth(0, 44), 2) != nearest_confirmed(tracker, sea.truth(1, 44), 2);
  }
  EXPECT_GE(right, 18);
}

// The track that stays says which one it was found to be one body with. ledger: S3-15
TEST(BodyTracker, SaysWhichTrackWasOfTheSameBody) {
  const auto beside = [](double sign) {
    return [sign](double t) -> Vector2d { return {0.8 * t - 20, sign * std::max(0.0, 12 - t)}; };
  };
  int said = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Sea sea({beside(1), beside(-1)}, 0.9, 3, seed);
    BodyTracker tracker(config_for(3), {});
    for (int k = 0; k <= 30; ++k) tracker.update(at(k), sea.look(k), sea.coverage());
    said += std::ranges::any_of(tracker.tracks(), [](const BodyTrack& one) { return one.merged > one.number; });
  }
  EXPECT_GE(said, 10);
}

// A correction of the own position moves the tracks, and gives them no velocity. ledger: S3-15
TEST(BodyTracker, TakesACorrectionOfThePositionForNoVelocity) {
  Sea sea({straight({0, 0}, {0, 0})}, 0.95, 0, 1);
  BodyTracker tracker(config_for(1), {});
  for (int k = 0; k < 20; ++k) tracker.update(at(k), sea.look(k), sea.coverage());
  const std::uint32_t number = tracker.tracks().front().number;
  tracker.shift({5, -3});
  std::vector<BodyReading> moved = sea.look(20);
  for (BodyReading& r : moved) r.p_W += Vector2d(5, -3);
  tracker.update(at(20), moved, sea.coverage());
  ASSERT_EQ(confirmed(tracker), 1U);
  EXPECT_EQ(tracker.tracks().front().number, number);
  EXPECT_LT(tracker.tracks().front().filter.estimate().mean.segment<2>(2).norm(), 0.05);
}

TEST(BodyTracker, KnowsTheExtentOfABody) {
  Random random(1);
  Sea sea({straight({-10, 0}, {0.5, 0})}, 1, 0, 1);
  BodyTracker tracker(config_for(1), {});
  for (int k = 0; k < 20; ++k) {
    std::vector<BodyReading> readings = sea.look(k);
    for (BodyReading& r : readings) {
      r.echoes = 20;
      r.scatter.setZero();
      for (int i = 0; i < 20; ++i) {
        const Vector2d off(2 * random.normal(), 0.5 * random.normal());
        r.scatter += off * off.transpose() / 20;
      }
    }
    tracker.update(at(k), readings, sea.coverage());
  }
  ASSERT_EQ(confirmed(tracker), 1U);
  const Matrix2d& extent = tracker.tracks().front().extent;
  EXPECT_NEAR(extent(0, 0), 4, 1.2);
  EXPECT_NEAR(extent(1, 1), 0.25, 0.1);
}

TEST(BodyTracker, RefusesAndCountsWhatIsNoReading) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const Square square(0.9);
  BodyTracker tracker({}, {});
  std::vector<BodyReading> bad(5, reading_at({1, 2}));
  bad[0].p_W.x() = kNaN;
  bad[1].covariance.setZero();
  bad[2].covariance << 1, 2, 2, 1;
  bad[3].scatter(0, 0) = std::numeric_limits<double>::infinity();
  bad[4].echoes = -1;
  EXPECT_TRUE(tracker.update(at(5), bad, square));
  EXPECT_EQ(tracker.counts().unusable, 5U);
  EXPECT_TRUE(tracker.tracks().empty());
  const std::vector<BodyReading> good(1, reading_at({1, 2}));
  EXPECT_FALSE(tracker.update(at(4), good, square));  // time runs backwards
  EXPECT_EQ(tracker.counts().out_of_order, 1U);
  EXPECT_TRUE(tracker.update(at(5), good, square));
  EXPECT_EQ(tracker.tracks().size(), 1U);
  BodyTrackerConfig config;
  config.drop = 0.5;
  config.confirm = 0.5;
  EXPECT_THROW(BodyTracker(config, {}), Error);
}

// A track that teleports is two bodies: the old one is missed, and goes; a new one begins.
TEST(BodyTracker, BeginsANewTrackWhereABodyTeleports) {
  const Path teleports = [](double t) -> Vector2d { return {t < 15 ? -20.0 : 20.0, 0}; };
  Sea sea({teleports}, 0.95, 0, 1);
  BodyTracker tracker(config_for(1), {});
  std::set<std::uint32_t> numbers;
  for (int k = 0; k < 30; ++k) {
    tracker.update(at(k), sea.look(k), sea.coverage());
    if (const BodyTrack* track = nearest_confirmed(tracker, sea.truth(0, k), 2)) numbers.insert(track->number);
  }
  EXPECT_EQ(numbers.size(), 2U);
  EXPECT_EQ(confirmed(tracker), 1U);
}

// A thousand false readings in each look: their number and that of the tracks is bounded, and what is left out is told.
TEST(BodyTracker, BoundsTheWorkOfALook) {
  Sea sea({straight({0, 0}, {0, 0})}, 0.9, 2000, 1);
  BodyTracker tracker(config_for(2000), {});
  for (int k = 0; k < 3; ++k) tracker.update(at(k), sea.look(k), sea.coverage());
  EXPECT_EQ(tracker.counts().readings, 3000U);
  EXPECT_GE(tracker.counts().above_max_readings, 3000U);
  EXPECT_LE(tracker.tracks().size(), 400U);
  EXPECT_GT(tracker.counts().above_max_tracks, 0U);
}

// Where an empty sea gives false readings only, hardly ever is a track confirmed.
TEST(BodyTracker, ConfirmsNothingInAnEmptySea) {
  std::size_t false_tracks = 0;
  constexpr int kLooks = 300;
  Sea sea({}, 0.9, 10, 1);
  BodyTracker tracker(config_for(10), {});
  for (int k = 0; k < kLooks; ++k) {
    tracker.update(at(k), sea.look(k), sea.coverage());
    false_tracks += confirmed(tracker);
  }
  EXPECT_LT(false_tracks, kLooks / 10);
}

}  // namespace
}  // namespace isobath

// Shifts of the window beside the readings: nothing lost, nothing doubled, nothing seen half.
#include <atomic>
#include <condition_variable>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <mutex>
#include <tests/perception/mapper_rig.hpp>
#include <thread>

namespace isobath::test {
namespace {

/// Holds the thread of a shift until it is let through.
class Gate {
 public:
  void wait() {
    std::unique_lock guard(lock_);
    opened_.wait(guard, [this] { return permits_ > 0; });
    --permits_;
  }
  void open() {
    {
      const std::scoped_lock guard(lock_);
      ++permits_;
    }
    opened_.notify_one();
  }

 private:
  std::mutex lock_;
  std::condition_variable opened_;
  int permits_ = 0;
};

struct Mission {
  int held_readings = 25;   ///< readings that come while each shift is held open
  bool leap = false;        ///< into the next shift before the last one is over
  double range_cap_m = 50;  ///< of the sonars
  bool busy = true;         ///< echoes, soundings; else clear water far above the bottom, and a sounding now and then
};

struct Ended {
  std::unique_ptr<Rig> rig;
  std::vector<PixelChange> changes;
};

/// A zigzag over uneven ground, once in the way that the configuration says.
Ended sail(const DepthMapperConfig& config, const Mission& mission) {
  Ended end{std::make_unique<Rig>(), {}};
  Rig& rig = *end.rig;
  rig.map_config.window_pixels = 128;
  rig.map_config.area_m = 256;
  rig.charted_m = 40;
  rig.parts.mapper = config;
  rig.parts.evidence.range_cap_m = mission.range_cap_m;
  rig.start = {-60, -60};
  rig.build();
  rig.mapper->on_change([&end](const PixelChange& change) { end.changes.push_back(change); });
  Gate gate;
  if (config.background) rig.mapper->before_shift([&gate] { gate.wait(); });
  Random random(7);
  std::uint64_t let_through = 0, begun = 0;
  int since = 0;
  const auto let = [&] {
    if (!config.background || rig.mapper->counts().shifts == let_through) return;
    ++let_through;
    since = 0;
    gate.open();
  };
  Swath swath;
  swath.beam_width = Angle::degrees(1.5);
  for (int i = 0; i < 420; ++i) {
    const double t = 0.6 * i;
    double north = -60 + 0.28 * i, east = -60 + 30 * std::abs(std::sin(i / 45.0)) + 0.1 * i;
    if (mission.leap && i % 140 > 70) north += 40;
    const Pose X_WB = at(north, east, 3, i, 4 * std::sin(0.3 * i), 6 * std::cos(0.2 * i));
    const double bottom = 14 + 3 * std::sin(north / 9) + 2 * std::cos(east / 7) + random.uniform(-0.6, 0.6);
    const auto take = [&](const RangeReading& reading) {
      if (rig.mapper->counts().shifts != begun) {  // held from its beginning
        begun = rig.mapper->counts().shifts;
        since = 0;
      }
      rig.mapper->update(reading, X_WB, random.uniform(0, 1));
      if (++since > mission.held_readings) let();
    };
    for (const double azimuth : {-40.0, 0.0, 40.0}) {
      const bool echo = mission.busy && random.uniform() < 0.7;
      take(with_range(looking(mission.busy ? 4 : 0, 8, azimuth),
                      echo ? std::optional(random.uniform(3, 48)) : std::nullopt, t));
    }
    if (mission.busy || i % 20 == 0) take(with_range(looking(90, 6), bottom - 3, t));
    if (mission.busy && i % 3 == 0) {
      swath.time = Time{} + seconds(t);
      swath.soundings.clear();
      for (int k = -12; k <= 12; ++k) {
        const auto z = static_cast<float>(bottom - 3 + 0.1 * k + (random.uniform() < 0.05 ? 9 : 0));
        swath.soundings.push_back({{0, static_cast<float>(k), z}, std::hypot(static_cast<float>(k), z), 0.1F});
      }
      rig.mapper->update(swath, X_WB, 0.3);
    }
    // Whatever waits must not wait for a gate that only this thread opens.
    if (config.background && mission.leap) let();
    rig.mapper->passed(Time{} + seconds(t), X_WB);
  }
  let();
  rig.mapper->finish();
  rig.map->flush();
  return end;
}

void expect_same(const Ended& a, const Ended& b) {
  EXPECT_TRUE(a.rig->map->trees().sensed() == b.rig->map->trees().sensed());
  EXPECT_TRUE(a.rig->map->trees().state() == b.rig->map->trees().state());
  EXPECT_EQ(a.rig->map->window().extent(), b.rig->map->window().extent());
  const DepthCounts &m = a.rig->mapper->counts(), &n = b.rig->mapper->counts();
  EXPECT_EQ(m.readings, n.readings);
  EXPECT_EQ(m.soundings, n.soundings);
  EXPECT_EQ(m.merged, n.merged);
  EXPECT_EQ(m.applied, n.applied);
  EXPECT_EQ(m.affirmed, n.affirmed);
  EXPECT_EQ(m.conflicted, n.conflicted);
  EXPECT_EQ(m.replaced, n.replaced);
  EXPECT_EQ(m.explained, n.explained);
  EXPECT_EQ(m.outside, n.outside);
  EXPECT_EQ(m.shifts, n.shifts);
  EXPECT_EQ(m.refused, n.refused);
  ASSERT_EQ(a.changes.size(), b.changes.size());
  for (std::size_t i = 0; i < a.changes.size(); ++i) {
    ASSERT_EQ(a.changes[i].pixel, b.changes[i].pixel);
    ASSERT_EQ(a.changes[i].after, b.changes[i].after);
  }
}

DepthMapperConfig beside() {
  DepthMapperConfig config;
  config.background = true;
  return config;
}

// ledger: S1-31, S1-32, S1-30
TEST(DepthMapperShift, the_map_is_bit_for_bit_that_of_shifts_without_duration) {
  const Ended on_the_spot = sail({}, {});
  ASSERT_GE(on_the_spot.rig->mapper->counts().shifts, 4U);
  ASSERT_GT(on_the_spot.rig->mapper->counts().explained, 20U);
  for (const int held : {0, 1, 40, 90}) {
    const Ended background = sail(beside(), {.held_readings = held});
    expect_same(on_the_spot, background);
    if (held > 1) {
      EXPECT_GT(background.rig->mapper->counts().queued, static_cast<std::uint64_t>(held));
    }
  }
}

// ledger: S1-32
TEST(DepthMapperShift, nor_is_the_map_another_where_the_next_shift_is_due_before_the_last_is_over) {
  const Ended on_the_spot = sail({}, {.leap = true});
  ASSERT_GT(on_the_spot.rig->mapper->counts().shifts, sail({}, {}).rig->mapper->counts().shifts);
  expect_same(on_the_spot, sail(beside(), {.held_readings = 1 << 30, .leap = true}));
}

// ledger: S1-33
TEST(DepthMapperShift, the_queue_is_shorter_without_readings_that_changed_nothing_and_the_map_the_same) {
  for (const bool busy : {false, true}) {
    const Mission mission{.held_readings = 40, .range_cap_m = 5, .busy = busy};
    DepthMapperConfig less = beside();
    less.queue_all = false;
    less.prefilter = false;
    DepthMapperConfig all = less;
    all.queue_all = true;
    const Ended with_all = sail(all, mission), with_less = sail(less, mission);
    expect_same(with_all, with_less);
    EXPECT_GE(with_all.rig->mapper->counts().queued, 40U);
    EXPECT_EQ(with_all.rig->mapper->counts().spared, 0U);
    const DepthCounts& counts = with_less.rig->mapper->counts();
    EXPECT_GT(counts.queued, 0U);
    if (!busy) {
      EXPECT_GT(counts.spared, counts.queued / 3);
    }
  }
}

// ledger: S1-02
TEST(DepthMapperShift, the_changes_replayed_on_the_starting_map_give_the_final_one) {
  for (const bool background : {false, true}) {
    DepthMapperConfig config;
    config.background = background;
    const Ended end = sail(config, {});
    const int side = 1 << end.rig->map->area().levels;
    std::vector<DepthPixel> copy(static_cast<std::size_t>(side) * static_cast<std::size_t>(side),
                                 {DepthPixel::word_of_depth(40), DepthPixel::word_of_state(5, 0, 0)});
    for (const PixelChange& change : end.changes) {
      const auto slot = static_cast<std::size_t>(change.pixel.row) * static_cast<std::size_t>(side) +
                        static_cast<std::size_t>(change.pixel.column);
      if (change.pixel.row < 0 || change.pixel.column < 0 || change.pixel.row >= side || change.pixel.column >= side) {
        continue;  // beyond the operational area nothing is kept
      }
      ASSERT_EQ(copy[slot], change.before);
      copy[slot] = change.after;
    }
    std::vector<DepthPixel> map(copy.size());
    end.rig->map->snapshot()->read({0, 0, side, side}, map);
    EXPECT_TRUE(map == copy);
    EXPECT_GT(end.changes.size(), 10000U);
  }
}

// ledger: S1-31
TEST(DepthMapperShift, queries_during_a_shift_are_answered_from_the_old_window_with_all_that_came_since) {
  Rig rig;
  rig.map_config.window_pixels = 128;
  rig.parts.mapper.background = true;
  rig.charted_m = 30;
  rig.build();
  Gate gate;
  rig.mapper->before_shift([&gate] { gate.wait(); });
  const PixelWindow old_extent = rig.map->window().extent();
  rig.mapper->passed(Time{}, at(20, 0, 2));
  ASSERT_EQ(rig.mapper->counts().shifts, 1U);
  EXPECT_EQ(rig.map->snapshot()->window().extent(), old_extent);
  Swath swath;
  swath.soundings.push_back({{0, 0, 10}, 10, 0.05F});
  for (int i = 0; i < 3; ++i) rig.mapper->update(swath, at(25, 0, 2), 0);
  EXPECT_NEAR(rig.depth(25, 0), 12, 1e-9) << "in the old window";
  for (int i = 0; i < 3; ++i) rig.mapper->update(swath, at(40, 0, 2), 0);
  EXPECT_NEAR(rig.depth(40, 0), 30, 1e-9) << "beyond it: the chart, until the new one is there";
  const auto held = rig.map->snapshot();
  gate.open();
  rig.mapper->finish();
  EXPECT_FALSE(rig.map->window().extent() == old_extent);
  EXPECT_NEAR(rig.depth(25, 0), 12, 1e-9);
  EXPECT_NEAR(rig.depth(40, 0), 12, 1e-9);
  EXPECT_NEAR(held->at(rig.map->grid().at({40, 0})).depth_m(), 30, 1e-9) << "a version stays what it was";
  EXPECT_EQ(rig.mapper->counts().queued, 6U);
}

// ledger: S1-03, S1-31
TEST(DepthMapperShift, every_answer_is_that_of_one_whole_version) {
  // Each round writes its number as the depth of a row of pixels that runs through the whole window and beyond, at
  // once; so whoever finds two depths in it, or another sum than the writer, has seen half a round.
  Rig rig;
  rig.map_config.window_pixels = 64;
  rig.map_config.area_m = 128;
  rig.parts.mapper.background = true;
  rig.parts.rules.threshold = 2;
  rig.parts.evidence.depth_weight = rig.parts.evidence.weight_cap = kFullConfidence;
  rig.parts.mapper.range_weighting = false;
  rig.parts.mapper.spread_sigmas = 0;
  rig.charted_m = 1;
  rig.build();
  struct Published {
    std::mutex lock;
    std::shared_ptr<const DepthSnapshot> snapshot;
    std::int32_t round_cm = 0;
    std::uint64_t sum = 0;
  } published;
  const PixelWindow all{0, 0, 256, 256};
  const auto sum_of = [&all](const DepthSnapshot& snapshot, std::vector<DepthPixel>& pixels) {
    snapshot.read(all, pixels);
    std::uint64_t sum = snapshot.version();
    for (const DepthPixel& p : pixels) sum = sum * 31 + p.depth_word + std::uint64_t{p.state_word} * 7;
    return sum;
  };
  const auto publish = [&](std::int32_t round_cm, std::vector<DepthPixel>& pixels) {
    const auto snapshot = rig.map->snapshot();
    const std::uint64_t sum = sum_of(*snapshot, pixels);
    const std::scoped_lock guard(published.lock);
    published.snapshot = snapshot;
    published.round_cm = round_cm;
    published.sum = sum;
  };
  std::vector<DepthPixel> own(256 * 256);
  publish(100, own);
  std::atomic<bool> over{false};
  std::atomic<int> wrong{0}, answers{0};
  std::vector<std::thread> readers;
  for (int r = 0; r < 3; ++r) {
    readers.emplace_back([&] {
      std::vector<DepthPixel> pixels(256 * 256);
      std::vector<DepthBlock> blocks(32 * 32);
      do {
        std::shared_ptr<const DepthSnapshot> snapshot;
        std::int32_t round_cm = 0;
        std::uint64_t sum = 0;
        {
          const std::scoped_lock guard(published.lock);
          snapshot = published.snapshot;
          round_cm = published.round_cm;
          sum = published.sum;
        }
        bool right = sum_of(*snapshot, pixels) == sum;
        snapshot->read_blocks({0, 0, 32, 32}, blocks);
        const PixelWindow window = snapshot->window().extent();
        for (int row = std::max(window.row, 0); row < std::min(window.row + window.height, 256); ++row) {
          const Pixel p{128, row};
          right = right && snapshot->at(p).depth_cm() == round_cm;
          right = right && blocks[static_cast<std::size_t>((row / 8) * 32 + 16)].max_cm >= round_cm;
        }
        wrong += !right;
        ++answers;
      } while (!over);
    });
  }
  Swath swath;
  swath.frame = Swath::Frame::kLevel;
  swath.heading = Angle();
  for (int round = 1; round <= 60; ++round) {
    const double north = 45 * std::sin(round / 6.0);
    const double depth = 1 + 2.0 * round;
    rig.mapper->passed(Time{}, at(north, 0, 1));
    swath.soundings.clear();
    for (int row = 0; row < 256; ++row) {
      const Eigen::Vector2d centre = rig.map->grid().centre({128, row});
      swath.soundings.push_back(
          {{static_cast<float>(centre.x() - north), static_cast<float>(centre.y() - 0.25F), static_cast<float>(depth)},
           1,
           0.05F});
    }
    rig.mapper->update(swath, at(north, 0.25, 0), 0);
    publish(static_cast<std::int32_t>(std::lround(100 * depth)), own);
  }
  over = true;
  for (std::thread& reader : readers) reader.join();
  rig.mapper->finish();
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(answers, 3);
  EXPECT_GT(rig.mapper->counts().shifts, 5U);
}

}  // namespace
}  // namespace isobath::test

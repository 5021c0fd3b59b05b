#include <cmath>
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/perception/grid_mapper.hpp>
#include <isobath/perception/obstacle_detector.hpp>
#include <optional>
#include <tests/support/count_allocations.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

struct Rig {
  Rig(std::vector<double> azimuth_deg, double width_deg, RangeWindow window) {
    auto fan = std::make_shared<BeamFan>();
    for (const double a : azimuth_deg) {
      fan->azimuth.push_back(Angle::degrees(a));
      fan->width.push_back(Angle::degrees(width_deg));
    }
    ping.fan = fan;
    ping.window = window;
    clear();
  }
  void clear() {
    decisions.reset(ping.fan->beams(), ping.window.bins);
    decisions.p_detect.assign(static_cast<std::size_t>(ping.window.bins), 0.8f);
  }
  Ping ping;
  EchoDecisions decisions;
};

std::vector<double> spread(double from, double to, int count) {
  std::vector<double> a;
  for (int i = 0; i < count; ++i) a.push_back(from + (to - from) * i / (count - 1));
  return a;
}

BodyGridConfig plane(int cells, double cell_m) {
  BodyGridConfig c;
  c.cells_x = c.cells_y = cells;
  c.cell_m = cell_m;
  return c;
}

Pose at(double x, double y, double heading_deg) {
  return {Rotation::from_heading(Angle::degrees(heading_deg)), {x, y, 0}};
}

Time time_of(double s) { return Time(seconds(s)); }

std::vector<double> copy_of(const BodyGrid& g) { return {g.log_odds().begin(), g.log_odds().end()}; }

// A target of the world as threshold decisions of an ideal sensor at a pose.
void see(Rig& s, const Pose& X_WB, const Vector2d& target_W) {
  s.clear();
  const Eigen::Vector3d p = X_WB.inverse() * Eigen::Vector3d(target_W.x(), target_W.y(), X_WB.translation.z());
  for (int b = 0; b < s.decisions.beams(); ++b) {
    const Angle off = (Angle::radians(std::atan2(p.y(), p.x())) - s.ping.fan->azimuth[b]).wrapped();
    const int bin = static_cast<int>((p.head<2>().norm() - s.ping.window.start_m) / s.ping.window.bin_m);
    if (abs(off) <= s.ping.fan->width[b] / 2 && bin >= 0 && bin < s.ping.window.bins) s.decisions.set_hit(b, bin);
  }
}

// ledger: S6-12 S6-11
TEST(OverlapTable, RowsEqualDirectComputationInEveryDirection) {
  Random random(11);
  const Rig s({-20, 0, 33}, 7, {1.5, 0.6, 30});
  OverlapTableConfig config;
  config.offset_steps = 4;
  OverlapTable table(config, 0.5, 200);
  const std::vector<double> gain(30, 0.7);
  table.prepare(*s.ping.fan, s.ping.window, gain);
  for (int round = 0; round < 60; ++round) {
    const Angle azimuth = Angle::degrees(round < 16 ? round * 45.0 : random.uniform(-400, 400));
    const Vector2d sensor(random.uniform(-20, 20), random.uniform(-20, 20));
    const OverlapTable::Row row = table.row(1, azimuth, sensor);
    const Angle rounded = Angle::radians(std::atan2(row.direction.y(), row.direction.x()));
    EXPECT_LE(abs((rounded - azimuth).wrapped()).degrees(), 0.1251);
    EXPECT_LE((row.sensor - sensor / 0.5).cwiseAbs().maxCoeff(), 0.1251);
    for (int k = 0; k < 30; ++k) {
      const AnnularSector bin{s.ping.window.edge(k) / 0.5, s.ping.window.edge(k + 1) / 0.5, rounded, Angle::degrees(7)};
      double sum = 0;
      for (const OverlapTable::Entry& e : row.bin(k)) {
        const Cell c = row.cell(row.cells[e.cell]);
        EXPECT_NEAR(e.share, overlap_area(bin, {Vector2d(c.x, c.y) - row.sensor, 1}), 1e-6);
        sum += e.share;
      }
      const double area = (bin.outer * bin.outer - bin.inner * bin.inner) * bin.width.radians() / 2;
      EXPECT_NEAR(sum, area, 1e-6 * (1 + area)) << "no cell is missing";
    }
  }
}

// ledger: S6-12
TEST(OverlapTable, ForgettingRowsChangesNothing) {
  ISOBATH_NOT_SANITIZED();
  Rig s(spread(-60, 60, 64), 2, {0, 0.1, 200});
  Random random(12);
  GridMapperConfig tight;
  tight.table.table_mb = 1;
  GridMapper a(plane(100, 0.4), {});
  GridMapper b(plane(100, 0.4), tight);
  for (int i = 0; i < 20; ++i) {
    s.clear();
    for (int n = 0; n < 300; ++n) {
      s.decisions.set_hit(static_cast<int>(random.index(64)), static_cast<int>(random.index(200)));
    }
    a.update(s.ping, s.decisions, at(0.13 * i, 0.07 * i, 2.1 * i));
    b.update(s.ping, s.decisions, at(0.13 * i, 0.07 * i, 2.1 * i));
  }
  EXPECT_GT(b.table().rows_built(), a.table().rows_built());
  EXPECT_EQ(copy_of(a.grid()), copy_of(b.grid()));
}

// ledger: S6-15 S6-12
TEST(GridMapper, ATinyGridFollowsBayesRuleBinByBin) {
  Random random(13);
  for (int round = 0; round < 30; ++round) {
    Rig s({random.uniform(-180, 180)}, random.uniform(10, 80), {random.uniform(0, 0.5), 0.5, 3});
    GridMapper mapper(plane(5, 1), {});
    std::vector<double> p;
    for (std::size_t i = 0; i < 25; ++i) {
      mapper.grid().set_probability(mapper.grid().cells().cell(i), random.uniform(0.01, 0.9));
      p.push_back(mapper.grid().probability(mapper.grid().cells().cell(i)));
    }
    for (int k = 0; k < 3; ++k) {
      s.decisions.p_detect[k] = static_cast<float>(random.uniform(0.5, 0.99));
      if (random.uniform() < 0.5) s.decisions.set_hit(0, k);
    }
    OverlapTable table({}, 1, 9);
    table.prepare(*s.ping.fan, s.ping.window, std::vector<double>(3, 0.5));
    const OverlapTable::Row row = table.row(0, s.ping.fan->azimuth[0], mapper.grid().position());
    // S6-15 as it is written, in probabilities: clear bins first, then echoes.
    for (const bool hit : {false, true}) {
      for (int k = 0; k < 3; ++k) {
        if (s.decisions.hit(0, k) != hit) continue;
        const double f = s.decisions.false_alarm;
        const double d = (double(s.decisions.p_detect[k]) - f) / (1 - f);
        const std::vector<double> before = p;
        for (const OverlapTable::Entry& x : row.bin(k)) {
          double others = 1;
          for (const OverlapTable::Entry& e : row.bin(k)) {
            if (e.cell != x.cell) {
              others *= 1 - d * double(e.share) * before[mapper.grid().cells().index(row.cell(row.cells[e.cell]))];
            }
          }
          const std::size_t i = mapper.grid().cells().index(row.cell(row.cells[x.cell]));
          const double a = double(x.share);
          const double q = (1 - d * a * before[i]) * others;
          p[i] = hit ? before[i] * (1 - (1 - f) * (1 - d * a) * others) / (1 - (1 - f) * q)
                     : before[i] * (1 - d * a) / (1 - d * a * before[i]);
        }
      }
    }
    mapper.update(s.ping, s.decisions, {});
    for (std::size_t i = 0; i < 25; ++i) {
      EXPECT_NEAR(mapper.grid().probability(mapper.grid().cells().cell(i)), p[i], 1e-12) << round;
    }
  }
}

// ledger: S6-09 S6-E05
TEST(GridMapper, BlindBinsLeaveTheGridAsItIs) {
  for (const bool hit : {false, true}) {
    Rig s({0}, 10, {0, 1, 20});
    for (int k = 0; k < 20; ++k) {
      if (hit) s.decisions.set_hit(0, k);
      if (k < 9) s.decisions.set_unusable(k);
      if (k >= 9) s.decisions.p_detect[k] = k % 2 == 0 ? 0.02f : 0.0f;  // not above f: no information either
    }
    GridMapper mapper(plane(60, 1), {});
    const std::vector<double> before = copy_of(mapper.grid());
    mapper.update(s.ping, s.decisions, {});
    EXPECT_EQ(copy_of(mapper.grid()), before);
  }
}

// ledger: S6-15 S6-72
TEST(GridMapper, AFanCountsAsItsBeamsOneAfterAnother) {
  Rig fan({-5, 0, 5}, 8, {0, 0.5, 30});
  GridMapper whole(plane(60, 0.5), {});
  GridMapper single(plane(60, 0.5), {});
  for (int b = 0; b < 3; ++b) fan.decisions.set_hit(b, 10 + b);
  whole.update(fan.ping, fan.decisions, {});
  for (int b = 0; b < 3; ++b) {
    Rig one({-5.0 + 5 * b}, 8, {0, 0.5, 30});
    one.decisions.set_hit(0, 10 + b);
    single.update(one.ping, one.decisions, {});
  }
  EXPECT_EQ(copy_of(whole.grid()), copy_of(single.grid()));
}

// ledger: S6-13 S6-17
TEST(GridMapper, TheBlockMattersInThePrintedFormOnly) {
  using Update = GridMapperConfig::Update;
  const auto after = [](Update update, int block) {
    Rig s({10}, 5, {0, 1, 20});
    s.decisions.set_hit(0, 12);
    GridMapperConfig c;
    c.update = update;
    c.block = block;
    GridMapper mapper(plane(60, 1), c);
    mapper.update(s.ping, s.decisions, {});
    return copy_of(mapper.grid());
  };
  EXPECT_EQ(after(Update::kBin, 3), after(Update::kBin, 9));
  const double best_3 = std::ranges::max(after(Update::kPrinted, 3));
  const double best_9 = std::ranges::max(after(Update::kPrinted, 9));
  const double best = std::ranges::max(after(Update::kBin, 3));
  EXPECT_GT(best, best_3);
  EXPECT_GT(best_3, best_9);
  EXPECT_NEAR(std::ranges::max(after(Update::kAnyTarget, 3)), best, 0.05);
}

// ledger: S6-10
TEST(GridMapper, TheSameRelativeSceneGivesTheSameGridAnywhere) {
  const auto run = [](const Pose& X_WO) {
    Rig s(spread(-50, 50, 40), 3, {0, 0.5, 60});
    GridMapper mapper(plane(120, 0.5), {});
    for (int i = 0; i < 20; ++i) {
      const Pose X_OB = at(0.31 * i, -0.11 * i, 1.7 * i);
      see(s, X_OB, {20, 4});
      mapper.update(s.ping, s.decisions, X_WO * X_OB);
    }
    return copy_of(mapper.grid());
  };
  const std::vector<double> here = run({});
  const std::vector<double> there = run(at(5321.5, -871.25, 211));
  double largest = 0;
  for (std::size_t i = 0; i < here.size(); ++i) largest = std::max(largest, std::abs(here[i] - there[i]));
  EXPECT_LT(largest, 1e-9);
}

TEST(GridMapper, MountingRollAndPitchTurnTheBeamsInTheLevelPlane) {
  const auto strongest = [](const Pose& X_WB, const Pose& X_BS) {
    Rig s({30}, 2, {0, 0.5, 40});
    s.ping.X_BS = X_BS;
    s.decisions.set_hit(0, 20);
    GridMapper mapper(plane(80, 0.5), {});
    mapper.update(s.ping, s.decisions, X_WB);
    const auto l = mapper.grid().log_odds();
    const auto i = static_cast<std::size_t>(std::ranges::max_element(l) - l.begin());
    return Vector2d(mapper.grid().to_level_body(mapper.grid().cells().centre(mapper.grid().cells().cell(i))));
  };
  const auto polar = [](double bearing_deg) {
    return Vector2d(10.25 * std::cos(bearing_deg * M_PI / 180), 10.25 * std::sin(bearing_deg * M_PI / 180));
  };
  EXPECT_LT((strongest({}, {}) - polar(30)).norm(), 0.6);
  EXPECT_LT(
      (strongest(at(3, 4, 77), {Rotation::from_heading(Angle::degrees(50)), {1, 2, 0}}) - polar(80) - Vector2d(1, 2))
          .norm(),
      0.6);
  const Pose upside_down{Rotation::from_heading_pitch_roll({}, {}, Angle::degrees(180)), {}};
  EXPECT_LT((strongest(upside_down, {}) - polar(-30)).norm(), 0.6) << "right is left upside down";
}

// ledger: S6-19
TEST(GridMapper, WaterSeenClearAThousandTimesStillYieldsATarget) {
  BodyGridConfig c = plane(9, 1);
  BodyGrid grid(c);
  double& l = grid.log_odds()[grid.cells().index({6, 4})];
  std::vector<double> scratch(2);
  for (int i = 0; i < 1000; ++i) {
    l = std::max(l + clear_increment(Likelihood().gain(), 1), grid.log_odds_min());
  }
  int hits = 0;
  while (hits < 10 && ObstacleDetector().detect(grid, {}, {}).obstacles.empty()) {
    update_hit(std::span(&l, 1), std::vector<double>{1.0}, {0.8, 0.02}, scratch);
    ++hits;
  }
  EXPECT_LE(hits, 4);
}

// ledger: S6-30 S6-24
TEST(GridMapper, OneEchoIsNoObstacleTwoAreAndTwoMissesClearIt) {
  const auto detections = [](const std::string& echoes) {
    BodyGrid grid(plane(9, 1));
    double& l = grid.log_odds()[grid.cells().index({6, 4})];
    std::vector<double> scratch(2);
    std::string found;
    for (const char echo : echoes) {
      const Likelihood sensor{0.8, 0.02};
      if (echo == '1') {
        update_hit(std::span(&l, 1), std::vector<double>{1.0}, sensor, scratch);
      } else {
        l += clear_increment(sensor.gain(), 1);
      }
      l = std::clamp(l, grid.log_odds_min(), grid.log_odds_max());
      found += ObstacleDetector().detect(grid, {}, {}).obstacles.empty() ? '0' : '1';
    }
    return found;
  };
  EXPECT_EQ(detections("1000"), "0000");
  EXPECT_EQ(detections("1100"), "0110");
  EXPECT_EQ(detections("1111"), "0111");
}

// ledger: S6-27 S6-26
TEST(GridMapper, ATargetOutOfSightForTwentySecondsIsWhereItShouldBe) {
  Rig s(spread(-45, 45, 46), 2, {0, 0.5, 100});
  GridMapper mapper(plane(200, 0.5), {});
  const Vector2d target(30, 3);
  const auto pose = [](double t) { return at(1.5 * t, 0, t < 5 ? 0 : 180 * std::min(1.0, (t - 5) / 5)); };
  for (double t = 0; t < 4; t += 0.2) {
    see(s, pose(t), target);
    s.ping.time = time_of(t);
    mapper.update(s.ping, s.decisions, pose(t));
  }
  for (double t = 4; t <= 24; t += 0.2) mapper.advance(time_of(t), pose(t));
  const Pose X_WB = pose(24);
  mapper.advance(time_of(24), X_WB);
  const Detection d = ObstacleDetector().detect(mapper.grid(), time_of(24), X_WB);
  ASSERT_EQ(d.obstacles.size(), 1u);
  const Eigen::Vector3d expected = X_WB.inverse() * Eigen::Vector3d(target.x(), target.y(), 0);
  EXPECT_LT((nearest_point(d.obstacles[0].outline, expected.head<2>()) - expected.head<2>()).norm(), 0.5);
  EXPECT_GT(d.obstacles[0].hits, 10u);
  EXPECT_EQ(d.obstacles[0].last_hit, Time(std::chrono::milliseconds(3800)));
}

// ledger: S6-22 S6-27
TEST(GridMapper, WithoutFixTheContentsFadeAndIgnoredMotionLeavesThemBehind) {
  const auto after = [](MotionKind kind, const DisplacementSource& source) {
    Rig s({0}, 4, {0, 0.5, 60});
    s.decisions.set_hit(0, 40);
    GridMapperConfig c;
    c.motion = {.kind = kind, .along = 0.2, .across = 0.1};
    GridMapper mapper(plane(100, 0.5), c);
    for (int i = 0; i < 4; ++i) mapper.update(s.ping, s.decisions, {});
    for (int i = 1; i <= 100; ++i) mapper.advance(time_of(i * 0.1), at(0.1 * i, 0, 0), source);
    const auto cell = mapper.grid().cell_at({10.25, 0.0}).value();
    double sum = 0;
    for (int x = -1; x <= 1; ++x) {
      for (int y = -2; y <= 2; ++y) sum += mapper.grid().probability({cell.x + x, cell.y + y});
    }
    return sum;
  };
  const double exact = after(MotionKind::kAuto, {true, true});
  EXPECT_GT(exact, 0.8);
  EXPECT_LT(after(MotionKind::kAuto, {false, false}), 0.8 * exact);
  EXPECT_NEAR(after(MotionKind::kDeterministic, {false, false}), exact, 1e-12);
  EXPECT_LT(after(MotionKind::kIgnored, {}), 0.3);
}

// ledger: S6-12
TEST(GridMapper, AllocatesNothingOnceWarm) {
  ISOBATH_NOT_SANITIZED();
  Rig s(spread(-60, 60, 64), 2, {0, 0.1, 200});
  for (int b = 0; b < 64; ++b) s.decisions.set_hit(b, 150 - b);
  GridMapperConfig c;
  c.table.table_mb = 2;  // rows come and go all the time
  GridMapper mapper(plane(100, 0.4), c);
  const auto run = [&](int from, int to) {
    for (int i = from; i < to; ++i) {
      s.ping.time = time_of(0.1 * i);
      mapper.update(s.ping, s.decisions, at(0.13 * i, 0.07 * i, 3.1 * i), {i % 2 == 0, false});
    }
  };
  run(0, 20);
  const std::uint64_t rows = mapper.table().rows_built();
  const std::uint64_t before = test::allocations();
  run(20, 60);
  EXPECT_EQ(test::allocations() - before, 0u);
  EXPECT_GT(mapper.table().rows_built(), rows);
}

TEST(GridMapper, RefusesWhatItCannotDo) {
  GridMapperConfig c;
  c.block = 0;
  EXPECT_THROW(GridMapper({}, c), Error);
  c = {};
  c.table.table_mb = 0;
  EXPECT_THROW(GridMapper({}, c), Error);
}

// A dim bin counts with its own p_D, whether it holds an echo or not: as a sonar that has that p_D everywhere. One that
// tells nothing leaves the grid as it is.
// ledger: S6-69 S6-15
TEST(GridMapper, DimBinsCountWithTheirOwnProbability) {
  using Update = GridMapperConfig::Update;
  for (const Update form : {Update::kBin, Update::kPrinted, Update::kAnyTarget}) {
    for (const bool echo : {false, true}) {
      const auto mapped = [&](float p_detect, std::optional<float> p_dim) {
        Rig s({0}, 5, {1, 0.5, 12});
        s.decisions.p_detect.assign(12, p_detect);
        if (p_dim) {
          const std::uint64_t all = 0xfff;
          s.decisions.set_dim(0, &all, std::vector<float>(12, *p_dim).data());
        }
        if (echo) s.decisions.set_hit(0, 7);
        GridMapperConfig config;
        config.update = form;
        GridMapper mapper(plane(41, 0.5), config);
        mapper.update(s.ping, s.decisions, at(0, 0, 0));
        return copy_of(mapper.grid());
      };
      const auto weak = mapped(0.3f, {}), dim = mapped(0.8f, 0.3f), silent = mapped(0.8f, 0.0f);
      const double prior = GridMapper(plane(41, 0.5), {}).grid().log_odds_prior();
      double most = 0;
      for (std::size_t i = 0; i < weak.size(); ++i) {
        EXPECT_NEAR(dim[i], weak[i], 1e-9);
        EXPECT_NEAR(silent[i], prior, 1e-9);
        most = std::max(most, std::abs(weak[i] - prior));
      }
      EXPECT_GT(most, 0.1) << "that it says anything at all";
    }
  }
}

}  // namespace
}  // namespace isobath

// Against enumeration of every state of cells, parts and detectors: Bayes' rule in its plainest form.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/perception/bin_update.hpp>
#include <numeric>
#include <vector>

namespace isobath {
namespace {

using List = std::vector<double>;

// P(S = 1 | which parts are occupied).
using Sensor = std::function<double(const std::vector<bool>& parts)>;

struct Joint {
  double hit = 0;  ///< P(S = 1)
  List occupied_and_hit;
  List occupied;
};

Joint enumerate(const List& p, const List& a, const Sensor& sensor) {
  const std::size_t n = p.size();
  Joint j{0, List(n, 0.0), List(n, 0.0)};
  for (unsigned cells = 0; cells < 1u << n; ++cells) {
    for (unsigned parts = 0; parts < 1u << n; ++parts) {
      double weight = 1;
      std::vector<bool> part(n);
      for (std::size_t i = 0; i < n; ++i) {
        const bool occupied = cells >> i & 1;
        part[i] = parts >> i & 1;
        weight *= occupied ? p[i] * (part[i] ? a[i] : 1 - a[i]) : (1 - p[i]) * (part[i] ? 0 : 1);
      }
      const double hit = weight * sensor(part);
      j.hit += hit;
      for (std::size_t i = 0; i < n; ++i) {
        if (cells >> i & 1) {
          j.occupied_and_hit[i] += hit;
          j.occupied[i] += weight;
        }
      }
    }
  }
  return j;
}

double posterior(const Joint& j, std::size_t i, bool hit) {
  return hit ? j.occupied_and_hit[i] / j.hit : (j.occupied[i] - j.occupied_and_hit[i]) / (1 - j.hit);
}

int count(const std::vector<bool>& parts) { return static_cast<int>(std::count(parts.begin(), parts.end(), true)); }

Sensor one_false_alarm(const Likelihood& s) {
  return [s](const std::vector<bool>& parts) { return 1 - (1 - s.false_alarm) * std::pow(1 - s.gain(), count(parts)); };
}
Sensor false_alarm_each(const Likelihood& s, int block) {
  return [s, block](const std::vector<bool>& parts) {
    return 1 - std::pow(1 - s.false_alarm, block) * std::pow(1 - s.gain(), count(parts));
  };
}
Sensor any_target(const Likelihood& s) {
  return [s](const std::vector<bool>& parts) { return count(parts) > 0 ? s.p_detect : s.false_alarm; };
}

struct Case {
  List p, a;
  Likelihood sensor;
  [[nodiscard]] List log_odds() const {
    List l;
    for (const double x : p) l.push_back(log_odds_of(x));
    return l;
  }
};

Case random_case(Random& random) {
  Case c;
  const auto n = 1 + random.index(5);
  for (std::size_t i = 0; i < n; ++i) {
    c.p.push_back(random.uniform(0.001, 0.999));
    c.a.push_back(random.uniform(0.001, 1));
  }
  c.sensor.false_alarm = random.uniform(0.001, 0.2);
  c.sensor.p_detect = random.uniform(c.sensor.false_alarm + 0.01, 1);
  return c;
}

List scratch(100);

void update_clear(List& log_odds, const List& share, const Likelihood& sensor) {
  for (std::size_t i = 0; i < log_odds.size(); ++i) log_odds[i] += clear_increment(sensor.gain(), share[i]);
}

// ledger: S6-15 S6-16 S6-E01 S6-E02
TEST(BinUpdate, DefaultFormIsBayesRule) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    const Case c = random_case(random);
    const Joint j = enumerate(c.p, c.a, one_false_alarm(c.sensor));
    List hit = c.log_odds();
    List clear = c.log_odds();
    update_hit(hit, c.a, c.sensor, scratch);
    update_clear(clear, c.a, c.sensor);
    for (std::size_t i = 0; i < c.p.size(); ++i) {
      EXPECT_NEAR(probability_of(hit[i]), posterior(j, i, true), 1e-12);
      EXPECT_NEAR(probability_of(clear[i]), posterior(j, i, false), 1e-12);
      // Total probability: both outcomes together return the prior.
      EXPECT_NEAR(j.hit * probability_of(hit[i]) + (1 - j.hit) * probability_of(clear[i]), c.p[i], 1e-12);
    }
  }
}

// ledger: S6-16
TEST(BinUpdate, EqualsTheLogOddsFormOfTheLedger) {
  Random random(6);
  for (int round = 0; round < 200; ++round) {
    const Case c = random_case(random);
    List l = c.log_odds();
    update_hit(l, c.a, c.sensor, scratch);
    const double d = c.sensor.gain();
    const double quiet = std::log1p(-c.sensor.false_alarm);
    for (std::size_t x = 0; x < c.p.size(); ++x) {
      double others = 0;
      for (std::size_t i = 0; i < c.p.size(); ++i) others += i == x ? 0 : std::log1p(-d * c.a[i] * c.p[i]);
      const double rise =
          std::log(-std::expm1(quiet + std::log1p(-d * c.a[x]) + others)) - std::log(-std::expm1(quiet + others));
      EXPECT_NEAR(l[x] - log_odds_of(c.p[x]), rise, 1e-11);
      const double f = c.sensor.false_alarm;
      EXPECT_GE(rise, -1e-12);
      EXPECT_LE(rise, std::log((f + (c.sensor.p_detect - f) * c.a[x]) / f) + 1e-12);
    }
  }
}

// ledger: S6-16 S6-19
TEST(BinUpdate, CertaintyGivesNumbersAndAMillionUpdatesStayFinite) {
  List l = {800, 800};
  const List a = {1, 1};
  const Likelihood certain{1, 0.02};
  update_hit(l, a, certain, scratch);
  EXPECT_TRUE(std::isfinite(l[0]));
  update_clear(l, a, certain);
  EXPECT_TRUE(std::isfinite(l[0]));
  update_any_target(false, l, a, certain, scratch);
  EXPECT_TRUE(std::isfinite(l[0]));
  Random random(7);
  l = {0, 0, 0};
  const List share = {1, 0.5, 0.01};
  const double most = log_odds_of(1 - 1e-4);
  for (int i = 0; i < 1000000; ++i) {
    random.uniform() < 0.4 ? update_hit(l, share, {}, scratch) : update_clear(l, share, {});
    for (double& x : l) {
      ASSERT_TRUE(std::isfinite(x));
      x = std::clamp(x, -most, most);
    }
  }
}

// ledger: S6-14 S6-E20
TEST(BinUpdate, OneWholeCellSeesTheSensorItself) {
  const Likelihood s{0.8, 0.02};
  List hit = {0.3};
  List clear = {0.3};
  update_hit(hit, List{1}, s, scratch);
  update_clear(clear, List{1}, s);
  EXPECT_NEAR(hit[0] - 0.3, std::log(0.8 / 0.02), 1e-13);
  EXPECT_NEAR(clear[0] - 0.3, std::log(0.2 / 0.98), 1e-13);
}

// ledger: S6-17 S6-E03
TEST(BinUpdate, PrintedFormIsBayesRuleWithAFalseAlarmInEveryCellOfTheBlock) {
  Random random(8);
  for (int round = 0; round < 100; ++round) {
    const Case c = random_case(random);
    const int block = static_cast<int>(c.p.size() + random.index(20));
    const Joint j = enumerate(c.p, c.a, false_alarm_each(c.sensor, block));
    const Joint one = enumerate(c.p, c.a, one_false_alarm(c.sensor));
    List l = c.log_odds();
    update_hit_printed(l, c.a, c.sensor, block, scratch);
    for (std::size_t i = 0; i < c.p.size(); ++i) {
      EXPECT_NEAR(probability_of(l[i]), posterior(j, i, true), 1e-12);
      EXPECT_NEAR(posterior(j, i, false), posterior(one, i, false), 1e-12) << "S = 0 is the same";
    }
  }
  const Sensor empty = false_alarm_each({0.8, 0.02}, 0);
  for (const auto& [r, p] : {std::pair(1, 0.020), std::pair(3, 0.166), std::pair(5, 0.397), std::pair(7, 0.628)}) {
    EXPECT_NEAR(false_alarm_each({0.8, 0.02}, r * r)({}), p, 6e-4);
  }
}

// ledger: S6-17 S6-E03
TEST(BinUpdate, PrintedFormDependsOnTheBlockAsTheDerivationSays) {
  const List a(4, 0.5);
  for (const auto& [block, expected] :
       {std::pair(4, 0.160), std::pair(9, 0.114), std::pair(25, 0.074), std::pair(49, 0.060)}) {
    List l(4, log_odds_of(0.05));
    update_hit_printed(l, a, {0.8, 0.02}, block, scratch);
    EXPECT_NEAR(probability_of(l[0]), expected, 6e-4) << block;
  }
  List l(4, log_odds_of(0.05));
  update_hit(l, a, {0.8, 0.02}, scratch);
  EXPECT_NEAR(probability_of(l[0]), 0.2322, 5e-5);
  List any(4, log_odds_of(0.05));
  update_any_target(true, any, a, {0.8, 0.02}, scratch);
  EXPECT_NEAR(probability_of(any[0]), 0.2305, 5e-5);
}

// ledger: S6-18 S6-E04
TEST(BinUpdate, AnyTargetFormIsBayesRule) {
  Random random(9);
  for (int round = 0; round < 100; ++round) {
    const Case c = random_case(random);
    const Joint j = enumerate(c.p, c.a, any_target(c.sensor));
    for (const bool hit : {false, true}) {
      List l = c.log_odds();
      update_any_target(hit, l, c.a, c.sensor, scratch);
      for (std::size_t i = 0; i < c.p.size(); ++i) EXPECT_NEAR(probability_of(l[i]), posterior(j, i, hit), 1e-12);
    }
  }
}

// ledger: S6-13
TEST(BinUpdate, CellsWithoutOverlapChangeNothing) {
  List few = {-2, -1};
  List many = {-2, -1, 3, 0.5, -4};
  update_hit(few, List{0.3, 0.6}, {}, scratch);
  update_hit(many, List{0.3, 0.6, 0, 0, 0}, {}, scratch);
  EXPECT_DOUBLE_EQ(few[0], many[0]);
  EXPECT_DOUBLE_EQ(few[1], many[1]);
  EXPECT_DOUBLE_EQ(many[2], 3);
}

// ledger: S6-72
TEST(BinUpdate, MarginalsDecideAsTheJointDistributionDoes) {
  Random random(10);
  int agree = 0;
  constexpr int kRuns = 1000;
  for (int run = 0; run < kRuns; ++run) {
    List joint(512);
    List l(9, log_odds_of(0.01));
    for (unsigned s = 0; s < 512; ++s)
      joint[s] = std::pow(0.01, std::popcount(s)) * std::pow(0.99, 9 - std::popcount(s));
    const unsigned truth = run % 2 == 0 ? 0 : 1u << random.index(9);
    const Likelihood sensor{0.8, 0.02};
    for (int scan = 0; scan < 6; ++scan) {
      // Three bins across the block, as a beam that comes at an angle lays them.
      const double tilt = random.uniform(0, 1);
      for (int bin = 0; bin < 3; ++bin) {
        List a(9);
        for (int i = 0; i < 9; ++i) {
          a[i] = std::clamp(1 - std::abs(i / 3 + tilt * (i % 3 - 1) - bin), 0.0, 1.0);
        }
        double quiet = 1 - sensor.false_alarm;
        for (int i = 0; i < 9; ++i) quiet *= truth >> i & 1 ? 1 - sensor.gain() * a[i] : 1;
        const bool hit = random.uniform() >= quiet;
        double sum = 0;
        for (unsigned s = 0; s < 512; ++s) {
          double silent = 1 - sensor.false_alarm;
          for (int i = 0; i < 9; ++i) silent *= s >> i & 1 ? 1 - sensor.gain() * a[i] : 1;
          joint[s] *= hit ? 1 - silent : silent;
          sum += joint[s];
        }
        for (double& p : joint) p /= sum;
        hit ? update_hit(l, a, sensor, scratch) : update_clear(l, a, sensor);
      }
    }
    double exact = 0;
    for (unsigned s = 0; s < 512; ++s) exact += joint[s] * std::popcount(s);
    const double marginal =
        std::accumulate(l.begin(), l.end(), 0.0, [](double sum, double x) { return sum + probability_of(x); });
    agree += (exact >= 0.8) == (marginal >= 0.8);
  }
  EXPECT_GE(agree, kRuns * 95 / 100);
}

}  // namespace
}  // namespace isobath

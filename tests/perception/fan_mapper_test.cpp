// Fans into voxels against the same rules written out in double, cell by cell; against enumeration of an arc; and what
// must hold of any map: no bin is dropped, nothing behind changes.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/perception/fan_mapper.hpp>
#include <map>
#include <numbers>
#include <set>
#include <tests/perception/fan_looks.hpp>
#include <tests/support/sanitized.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;
using Rule = FanMapperConfig::Rule;
using namespace test;

constexpr double kTurn = 2 * std::numbers::pi;

/// The rule of stamping on an empty map, in double and with real angles. `sure` is false where a rectangle ends so near
/// to the border of a cell that rounding decides.
struct Expected {
  double log_odds = 0;
  bool seen = false, sure = true;
};
Expected expected(const Look& look, const Pose& X_WS, double voxel, const VoxelIndex& v) {
  const BeamFan& f = *look.ping.fan;
  const Vector3d p_W = ((v.cast<double>().array() + 0.5) * voxel).matrix() - X_WS.translation;
  const Vector3d p = X_WS.rotation.inverse() * p_W;
  const double range = p.norm(), flat = p.head<2>().norm();
  const double height =
      std::max(range * sin(f.height * 0.5), 0.5 * voxel * (X_WS.rotation * Vector3d::UnitZ()).lpNorm<1>());
  Expected e;
  if (std::abs(std::abs(p.z()) - height) < 1e-4) e.sure = false;
  if (std::abs(p.z()) > height) return e;
  const double half_r = 0.5 * voxel * p_W.lpNorm<1>() / range;
  const auto bin_of = [&](double r) {
    const double bin = r / look.ping.window.bin_m;
    if (std::abs(bin - std::round(bin)) < 1e-3) e.sure = false;
    return static_cast<int>(std::floor(bin));
  };
  const int bin = std::max(0, bin_of(range - half_r)),
            end = std::min(look.ping.window.bins, bin_of(range + half_r) + 1);
  const double half_t = 0.5 * voxel * (X_WS.rotation * Vector3d(-p.y(), p.x(), 0)).lpNorm<1>() / flat,
               q = half_t / flat;
  const double azimuth = std::atan2(p.y(), p.x());
  double ratios = 0;
  int cells = 0, beams = 0;
  if (std::abs(q - 0.5) < 1e-3) e.sure = false;
  for (int b = 0; b < f.beams(); ++b) {
    const double half = 0.5 * f.width[b].radians(), left = f.azimuth[b].radians() - half, right = left + 2 * half;
    // A table of directions is no finer, and the width of a voxel is rounded up.
    constexpr double kEntry = 1.5 * kTurn / FanView::kDirections;
    const auto doubtful = [&](double beyond) { return beyond > -kEntry && beyond < kEntry + 6 * q * q; };
    if (doubtful(azimuth - q - right) || doubtful(left - azimuth - q)) e.sure = false;
    if (q < 0.5 && (azimuth + q < left || azimuth - q > right)) continue;
    ++beams;
    for (int k = bin; k < end; ++k, ++cells) ratios += look.decisions.hit(b, k) ? 0.8 / 0.02 : 0.2 / 0.98;
  }
  e.seen = cells > 0;
  if (e.seen) e.log_odds = std::clamp(beams, 1, 4) * std::log(ratios / cells);
  return e;
}

// ledger: S5-06 S5-11 S5-12 S5-14 S5-16 S5-E03
TEST(FanMapper, SaysOfEachVoxelWhatItsCellsSayAtAnyAttitude) {
  ISOBATH_NOT_SANITIZED();
  constexpr double kVoxel = 0.25;
  Random random(3);
  std::size_t sure = 0, all = 0;
  for (int round = 0; round < 8; ++round) {
    Look look = fan(20, 60, 0.1, 40);
    for (int b = 0; b < 20; ++b) {
      for (int k = 20; k < 60; ++k) {
        if (random.uniform() < 0.05) look.decisions.set_hit(b, k);
      }
    }
    const double heading = random.uniform(-180, 180), pitch = random.uniform(-60, 60), roll = random.uniform(-180, 180);
    Vector3d at;
    for (int a = 0; a < 3; ++a) at[a] = random.uniform(-20, 20);
    const Pose X_WB = pose(heading, pitch, roll, at);
    look.ping.X_BS = pose(10, -5, 30, {0.5, 0.1, -0.2});
    const Pose X_WS = X_WB * look.ping.X_BS;

    VoxelBlocks map({-30'000, 30'000});
    FanMapper(by(Rule::kStamp), kVoxel, 0).update(look.ping, look.decisions, X_WB, map);
    const VoxelIndex centre = floor_of(X_WS.translation / kVoxel);
    for (int i = -27; i <= 27; ++i) {
      for (int j = -27; j <= 27; ++j) {
        for (int k = -27; k <= 27; ++k) {
          const VoxelIndex v = centre + VoxelIndex(i, j, k);
          const Expected e = expected(look, X_WS, kVoxel, v);
          const LogOdds16 found = map.at(v);
          all += e.seen ? 1 : 0;
          if (!e.sure) continue;
          sure += e.seen ? 1 : 0;
          ASSERT_EQ(found != kUnseen, e.seen) << v.transpose() << " round " << round;
          if (e.seen) {
            ASSERT_NEAR(to_log_odds(found), e.log_odds, 0.002) << v.transpose() << " round " << round;
          }
        }
      }
    }
  }
  EXPECT_GT(sure, 10'000u);
  EXPECT_GT(static_cast<double>(sure), 0.3 * static_cast<double>(all));
}

// ledger: S5-16 S5-60
TEST(FanMapper, DropsNoBin) {
  ISOBATH_NOT_SANITIZED();
  for (const double attitude : {0.0, 23.0}) {
    Look look = fan(24, 80, 0.05, 30, 15, 60);
    const Pose X_WB = pose(45 + attitude, attitude, 2 * attitude, {0.1, 0.2, 5});
    const auto map_of = [&] {
      VoxelBlocks map;
      FanMapper(by(Rule::kMarginal), 0.3, odds(0.05)).update(look.ping, look.decisions, X_WB, map);
      return contents(map);
    };
    const auto silent = map_of();
    for (int b = 0; b < 24; ++b) {
      for (int k = 0; k < 80; ++k) {
        look.decisions.set_hit(b, k);
        ASSERT_NE(map_of(), silent) << "beam " << b << " bin " << k;
        look.decisions.hits(b)[k / 64] = 0;
      }
    }
  }
}

// Silence by the rule `aspects`, voxel by voxel the law of dependent looks. ledger: S5-14
TEST(FanMapper, LetsSilenceSaturateByTheLawOfAspects) {
  ISOBATH_NOT_SANITIZED();
  const Look look = fan(16, 60, 0.2, 20);
  VoxelBlocks map;
  FanMapperConfig config = by(Rule::kAspects);
  config.max_looks = 1;
  FanMapper mapper(config, 0.25, odds(0.05));
  const AspectLaw law{config.aspects};
  double expected = 0;
  for (int n = 1; n <= 60; ++n) {
    mapper.update(look.ping, look.decisions, {}, map);
    expected += law.silence(0.8f, 0.02) * law.share(expected);
    for (const auto& [v, e] : contents(map)) {
      ASSERT_NEAR(to_log_odds(static_cast<LogOdds16>(e)), expected, 0.03) << "after " << n << " pings";
    }
  }
  EXPECT_GT(expected, 0.2 * 60 * law.silence(0.8f, 0.02)) << "the sum of as many independent looks is five times it";
}

// By the rule `aspects` an arc that is heard again and again from one place is suspected, and no voxel of it is more.
// ledger: S5-31
TEST(FanMapper, RaisesAnArcHeardFromOnePlaceToTheLimitOfOneDirection) {
  Look look = fan(9, 60, 0.2, 20);
  for (int b = 0; b < 9; ++b) look.decisions.set_hit(b, 50);
  VoxelBlocks map;
  FanMapperConfig config = by(Rule::kAspects);
  FanMapper mapper(config, 0.25, odds(0.05));
  for (int n = 0; n < 50; ++n) mapper.update(look.ping, look.decisions, {}, map);
  double most = -100;
  for (const auto& [v, e] : contents(map)) most = std::max(most, to_log_odds(static_cast<LogOdds16>(e)));
  EXPECT_NEAR(most, config.aspects.max_log_odds, 0.001);

  // From another place, where the line of sight has turned by a right angle, it rises farther.
  const VoxelIndex at = floor_of(Vector3d(10.1, 0, 0.1) / 0.25);
  for (int n = 0; n < 8; ++n) {
    mapper.update(look.ping, look.decisions, pose(90, 0, 0, {10.1, -10.1, 0.1}), map);
    mapper.update(look.ping, look.decisions, {}, map);
  }
  EXPECT_GT(to_log_odds(map.at(at)), config.aspects.max_log_odds + 0.1);
}

// An echo is what the detector says: with the delivered false-alarm rate a single one raises more. ledger: S6-14
TEST(FanMapper, WeighsAnEchoByTheFalseAlarmRateThatItIsTold) {
  const auto raised = [](double false_alarm) {
    Look look = fan(9, 60, 0.2, 20);
    look.decisions.false_alarm = false_alarm;
    look.decisions.set_hit(4, 50);
    VoxelBlocks map;
    FanMapper(by(Rule::kAspects), 0.25, odds(0.05)).update(look.ping, look.decisions, {}, map);
    return to_log_odds(map.at(floor_of(Vector3d(10.1, 0, 0.1) / 0.25)));
  };
  EXPECT_GT(raised(0.02), 0);
  EXPECT_GT(raised(0.0001), raised(0.02));
}

/// P(occupied) of each of n voxels after one echo from their arc, by all of their 2^n states.
std::vector<double> enumerated(const std::vector<double>& prior, double p_detect, double false_alarm) {
  std::vector<double> posterior(prior.size(), 0);
  double all = 0;
  for (unsigned state = 0; state < 1u << prior.size(); ++state) {
    double p = state == 0 ? false_alarm : p_detect;
    for (std::size_t i = 0; i < prior.size(); ++i) p *= (state >> i & 1) != 0 ? prior[i] : 1 - prior[i];
    all += p;
    for (std::size_t i = 0; i < prior.size(); ++i) posterior[i] += (state >> i & 1) != 0 ? p : 0;
  }
  for (double& p : posterior) p /= all;
  return posterior;
}

// ledger: S5-31
TEST(FanMapper, SharesAnEchoOverItsArcAsEnumerationDoes) {
  // One beam of one thin bin: each voxel that it meets has this cell alone.
  Random random(8);
  for (int round = 0; round < 20; ++round) {
    Look look = fan(1, 1, 0.01, 0.05, 12);
    look.ping.window.start_m = 9.99;
    look.decisions.p_detect[0] = 0.9f;
    look.decisions.false_alarm = 0.05;
    const Pose X_WB{{}, {0.02, 0.125, 0.125}};
    VoxelBlocks met;
    FanMapper(by(Rule::kStamp), 0.25, 0).update(look.ping, look.decisions, X_WB, met);
    look.decisions.set_hit(0, 0);
    const auto arc = contents(met);
    ASSERT_GE(arc.size(), 9u);
    ASSERT_LE(arc.size(), 14u);
    VoxelBlocks map;
    std::vector<double> before;
    for (const auto& [v, e] : arc) {
      const VoxelIndex at(v[0], v[1], v[2]);
      map.add(at, to_evidence(random.uniform(-3, 3)));
      before.push_back(1 / (1 + std::exp(-(to_log_odds(map.at(at)) + odds(0.05)))));
    }
    const auto expected = enumerated(before, 0.9, 0.05);
    FanMapper(by(Rule::kMarginal), 0.25, odds(0.05)).update(look.ping, look.decisions, X_WB, map);
    std::size_t i = 0;
    for (const auto& [v, e] : arc) {
      const double p = 1 / (1 + std::exp(-(to_log_odds(map.at({v[0], v[1], v[2]})) + odds(0.05))));
      EXPECT_NEAR(p, expected[i], 0.001) << "voxel " << i << " of round " << round;
      ++i;
    }
  }
}

// A reading that is a brightness: likelier by L where something echoes. Any L, also one below 1. ledger: S5-25 S5-31
TEST(FanMapper, SharesALikelihoodRatioOverItsArcAsEnumerationDoes) {
  Random random(12);
  for (const double ratio : {0.3, 1.0, 4.0, 50.0}) {
    Look look = fan(1, 1, 0.01, 0.05, 12);
    look.ping.window.start_m = 9.99;
    look.decisions.set_hit(0, 0);
    look.decisions.set_ratio(0, 0, static_cast<float>(ratio));
    const Pose X_WB{{}, {0.02, 0.125, 0.125}};
    VoxelBlocks stamped, map;
    FanMapper(by(Rule::kStamp), 0.25, 0).update(look.ping, look.decisions, X_WB, stamped);
    std::vector<double> before;
    const auto arc = contents(stamped);
    ASSERT_GE(arc.size(), 9u);
    for (const auto& [v, e] : arc) {
      EXPECT_NEAR(to_log_odds(static_cast<LogOdds16>(e)), std::log(ratio), 0.001) << "the paper's increment";
      const VoxelIndex at(v[0], v[1], v[2]);
      map.add(at, to_evidence(random.uniform(-3, 3)));
      before.push_back(1 / (1 + std::exp(-(to_log_odds(map.at(at)) + odds(0.05)))));
    }
    const auto expected = enumerated(before, ratio, 1);
    FanMapper(by(Rule::kMarginal), 0.25, odds(0.05)).update(look.ping, look.decisions, X_WB, map);
    std::size_t i = 0;
    for (const auto& [v, e] : arc) {
      const double p = 1 / (1 + std::exp(-(to_log_odds(map.at({v[0], v[1], v[2]})) + odds(0.05))));
      EXPECT_NEAR(p, expected[i], 0.001) << "voxel " << i << " at ratio " << ratio;
      ++i;
    }
  }
}

// An echo or none is the case of two brightnesses. ledger: S5-25
TEST(FanMapper, TakesARatioOfDetectionToFalseAlarmForThePlainEcho) {
  for (const Rule rule : {Rule::kMarginal, Rule::kStamp}) {
    FanMapperConfig config = by(rule);
    config.visibility = 0.35;
    Look plain = fan(31, 120, 0.1, 15), known = fan(31, 120, 0.1, 15);
    Random random(3);
    for (int n = 0; n < 200; ++n) {
      const int beam = static_cast<int>(random.index(31));
      const int bin = static_cast<int>(random.index(120));
      plain.decisions.set_hit(beam, bin);
      known.decisions.set_hit(beam, bin);
      known.decisions.set_ratio(beam, bin, static_cast<float>(static_cast<double>(0.8f) / 0.02));
    }
    VoxelBlocks a, b;
    FanMapper first(config, 0.25, odds(0.05)), second(config, 0.25, odds(0.05));
    for (int n = 0; n < 3; ++n) {
      first.update(plain.ping, plain.decisions, {}, a);
      second.update(known.ping, known.decisions, {}, b);
    }
    const auto of_plain = contents(a), of_known = contents(b);
    ASSERT_EQ(of_plain.size(), of_known.size());
    for (const auto& [v, e] : of_plain) ASSERT_NEAR(e, of_known.at(v), 3) << "units of evidence: rounding of the ratio";
  }
}

// ledger: S5-31 S5-E14
TEST(FanMapper, SharesAnEchoOverAnArcWhereThePapersUpdateRaisesAllOfIt) {
  const auto shared = [](double n) {
    const double E = std::pow(0.95, n);
    return 0.05 * 0.9 / (0.9 * (1 - E) + 0.05 * E);
  };
  EXPECT_NEAR(shared(16), 0.086, 0.0005);
  for (const Rule rule : {Rule::kMarginal, Rule::kStamp}) {
    Look look = fan(1, 1, 0.01, 0.05, 22.5);
    look.ping.window.start_m = 9.99;
    look.decisions.p_detect[0] = 0.9f;
    look.decisions.false_alarm = 0.05;
    look.decisions.set_hit(0, 0);
    VoxelBlocks map;
    FanMapper(by(rule), 0.25, odds(0.05)).update(look.ping, look.decisions, {{}, {0.02, 0.125, 0}}, map);
    const auto all = contents(map);
    EXPECT_GE(all.size(), 16u);
    const double p = rule == Rule::kStamp ? 0.486 : shared(static_cast<double>(all.size()));
    for (const auto& [v, e] : all) {
      EXPECT_NEAR(1 / (1 + std::exp(-(to_log_odds(static_cast<LogOdds16>(e)) + odds(0.05)))), p, 0.001);
    }
  }
}

// ledger: S5-31
TEST(FanMapper, LooksAgainFromOnePlaceMakeNoVoxelOfAnArcCertain) {
  Look look = fan(9, 60, 0.2, 20);
  for (int b = 0; b < 9; ++b) look.decisions.set_hit(b, 50);
  const auto max_after = [&](Rule rule) {
    VoxelBlocks map;
    FanMapper mapper(by(rule), 0.25, odds(0.05));
    for (int n = 0; n < 50; ++n) mapper.update(look.ping, look.decisions, {}, map);
    double most = 0;
    for (const auto& [v, e] : contents(map))
      most = std::max(most, 1 / (1 + std::exp(-(to_log_odds(static_cast<LogOdds16>(e)) + odds(0.05)))));
    return most;
  };
  EXPECT_LT(max_after(Rule::kMarginal), 0.6);
  EXPECT_GT(max_after(Rule::kStamp), 0.97);
}

// ledger: S5-09 S5-28 S5-35
TEST(FanMapper, TwoCrossedFansFindThePlaceThatNeitherFinds) {
  // A ball of 0.3 m at 20 m ahead; one fan lies flat, one stands upright.
  const Vector3d target(20.1, 1.1, 0.9);
  const auto heard = [&](const Pose& X_WS) {
    Look look = fan(61, 300, 0.1, 30);
    look.ping.X_BS = X_WS;
    const Vector3d p = X_WS.inverse() * target;
    const double azimuth = std::atan2(p.y(), p.x()) * 360 / kTurn;
    look.decisions.set_hit(static_cast<int>(std::lround(azimuth)) + 30, static_cast<int>(p.norm() / 0.1));
    return look;
  };
  std::vector<VoxelBlocks> maps(2);
  for (int s = 0; s < 2; ++s) {
    const Look look = heard(pose(0, 0, s == 0 ? 0 : 90));
    FanMapper mapper(by(Rule::kMarginal), 0.25, odds(0.02));
    for (int n = 0; n < 10; ++n) mapper.update(look.ping, look.decisions, {}, maps[static_cast<std::size_t>(s)]);
  }
  VoxelIndex best = VoxelIndex::Zero();
  double most = -100;
  for (const auto& [v, e] : contents(maps[0])) {
    const VoxelIndex at(v[0], v[1], v[2]);
    if (maps[1].at(at) == kUnseen) continue;
    if (const double sum = to_log_odds(static_cast<LogOdds16>(e)) + to_log_odds(maps[1].at(at)); sum > most) {
      most = sum;
      best = at;
    }
  }
  EXPECT_LT((((best.cast<double>().array() + 0.5) * 0.25).matrix() - target).norm(), 0.45);
}

// What only one fan hears has the resolution of that fan: an arc as high as the beam. ledger: S5-09 S5-E17
TEST(FanMapper, OneFanAloneKnowsOnlyAnArc) {
  for (const bool flat : {true, false}) {
    Look look = fan(61, 300, 0.1, 30, 15);
    look.ping.X_BS = pose(0, 0, flat ? 0 : 90);
    look.decisions.set_hit(30, 200);
    VoxelBlocks map;
    FanMapper(by(Rule::kStamp), 0.25, odds(0.02)).update(look.ping, look.decisions, {}, map);
    double along_arc = 0, in_plane = 0;
    for (const auto& [v, e] : contents(map)) {
      if (e <= 0) continue;
      const Vector3d p = (VoxelIndex(v[0], v[1], v[2]).cast<double>().array() + 0.5) * 0.25;
      along_arc = std::max(along_arc, std::abs(flat ? p.z() : p.y()));
      in_plane = std::max(in_plane, std::abs(flat ? p.y() : p.z()));
    }
    EXPECT_NEAR(along_arc, 20.05 * std::sin(Angle::degrees(7.5).radians()), 0.4);
    EXPECT_LT(in_plane, 20.05 * Angle::degrees(1).radians() + 0.4);
  }
}

// Depth grows downwards, elevation upwards: what a vehicle with its nose up hears ahead lies above it, and what an
// vertical fan hears to its right, below. ledger: S5-11 S5-E02
TEST(FanMapper, PutsWhatIsHeardAboveAbove) {
  const auto heard_at = [](const Pose& X_WB, const Pose& X_BS, int beam) {
    Look look = fan(61, 300, 0.1, 30, 3);
    look.ping.X_BS = X_BS;
    look.decisions.set_hit(beam, 200);
    VoxelBlocks map;
    FanMapper(by(Rule::kStamp), 0.25, 0).update(look.ping, look.decisions, X_WB, map);
    Vector3d sum = Vector3d::Zero();
    int n = 0;
    for (const auto& [v, e] : contents(map)) {
      if (e <= 0) continue;
      sum += ((VoxelIndex(v[0], v[1], v[2]).cast<double>().array() + 0.5) * 0.25).matrix();
      ++n;
    }
    return Vector3d(sum / n);
  };
  const double range = 20.05, s20 = std::sin(Angle::degrees(20).radians()), c20 = std::sqrt(1 - s20 * s20);
  const Vector3d level(0, 0, 40);
  EXPECT_LT((heard_at(pose(0, 20, 0, level), {}, 30) - Vector3d(range * c20, 0, 40 - range * s20)).norm(), 0.3);
  EXPECT_LT((heard_at({{}, level}, pose(0, 0, 90), 50) - Vector3d(range * c20, 0, 40 + range * s20)).norm(), 0.3);
  EXPECT_LT((heard_at({{}, level}, pose(0, 0, 90), 10) - Vector3d(range * c20, 0, 40 - range * s20)).norm(), 0.3);
}

// ledger: S5-31
TEST(FanMapper, ForecastsTheEchoesOfAMap) {
  // Nothing but one voxel is known: its cells echo by p_D where it fills them alone, all others by false alarm.
  VoxelMapConfig config;
  config.prior = 0.001;
  VoxelMap map(config);
  const VoxelIndex wall = floor_of(Vector3d(8, 0, 0.1) / 0.25);
  map.layer("flat").add(wall, to_evidence(6.9 + 6.9));
  Look look = fan(31, 120, 0.1, 15);
  FanMapper mapper(by(Rule::kMarginal), 0.25, odds(0.001));
  const auto forecast = mapper.forecast(look.ping, look.decisions, {}, map);
  ASSERT_EQ(forecast.size(), 31u * 120u);
  const auto at = [&](int beam, int bin) { return forecast[static_cast<std::size_t>(beam * 120 + bin)]; };
  EXPECT_GT(at(15, 81).p_echo, 0.04);  // one of the cells that the voxel spans
  EXPECT_GT(at(15, 81).seen, 0);
  EXPECT_NEAR(at(15, 40).p_echo, 0.02, 0.005);
  EXPECT_NEAR(at(2, 81).p_echo, 0.02, 0.005);
  EXPECT_EQ(at(2, 40).seen, 0);
  for (const EchoForecast& f : forecast) {
    EXPECT_GE(f.p_echo, 0.0199f);
    EXPECT_LE(f.p_echo, 0.8001f);
  }
}

// ledger: S5-16
TEST(FanMapper, LeavesWhatIsBehindAndBeyondAsItIs) {
  const Look look = fan(32, 50, 0.2, 45);
  VoxelBlocks map;
  FanMapper(by(Rule::kMarginal), 0.25, 0).update(look.ping, look.decisions, pose(0, 0, 0, {0, 0, 3}), map);
  const auto all = contents(map);
  EXPECT_GT(all.size(), 1000u);
  for (const auto& [v, e] : all) {
    EXPECT_GE(v[0], -2);
    EXPECT_LE(std::hypot((v[0] + 0.5) * 0.25, (v[1] + 0.5) * 0.25), 10.0 + 0.3);
    EXPECT_LT(e, 0);
  }
}

// ledger: S5-39
TEST(FanMapper, MapsNothingAboveTheSurface) {
  const Look look = fan(32, 100, 0.2, 45, 30);
  VoxelBlocks map;
  FanMapper mapper(by(Rule::kMarginal), 0.25, 0);
  mapper.set_surface(0);
  mapper.update(look.ping, look.decisions, pose(0, 0, 0, {0, 0, 1}), map);
  const auto all = contents(map);
  EXPECT_GT(all.size(), 1000u);
  for (const auto& [v, e] : all) EXPECT_GE(v[2], 0);
}

// ledger: S5-57
TEST(FanMapper, ClearsNothingBehindAStrongEcho) {
  Look look = fan(32, 100, 0.1, 30);
  for (int b = 10; b < 22; ++b) {
    for (int k = 50; k < 54; ++k) look.decisions.set_hit(b, k);
  }
  look.decisions.set_hit(2, 50);  // one bin alone is no pylon
  const auto map_with = [&](int shadow_bins) {
    VoxelBlocks map;
    FanMapper(by(Rule::kMarginal, shadow_bins), 0.25, 0).update(look.ping, look.decisions, {}, map);
    return map;
  };
  const VoxelBlocks hidden = map_with(3), open = map_with(0);
  const VoxelIndex behind = floor_of(Vector3d(8, 0, 0) / 0.25), before = floor_of(Vector3d(4, 0, 0) / 0.25);
  EXPECT_EQ(hidden.at(behind), kUnseen);
  EXPECT_LT(open.at(behind), 0);
  EXPECT_LT(hidden.at(before), 0);
  const double beside = Angle::degrees(-30 + 60.0 / 31 * 2).radians();
  EXPECT_LT(hidden.at(floor_of(Vector3d(8 * std::cos(beside), 8 * std::sin(beside), 0) / 0.25)), 0);
}

// ledger: S5-11
TEST(FanMapper, TakesASonarMountedUpsideDown) {
  // A target to starboard is in a beam to port of a sonar that hangs head over.
  Look look = fan(31, 100, 0.1, 30);
  look.ping.X_BS = pose(0, 0, 180);
  look.decisions.set_hit(5, 80);
  VoxelBlocks map;
  FanMapper(by(Rule::kStamp), 0.25, 0).update(look.ping, look.decisions, {}, map);
  const double azimuth = -look.ping.fan->azimuth[5].radians();
  EXPECT_GT(map.at(floor_of(Vector3d(8.05 * std::cos(azimuth), 8.05 * std::sin(azimuth), 0.1) / 0.25)), 0);
  EXPECT_LT(map.at(floor_of(Vector3d(8.05 * std::cos(azimuth), -8.05 * std::sin(azimuth), 0.1) / 0.25)), 0);
}

// ledger: S5-12
TEST(FanMapper, TakesFansWiderThanHalfTheCircle) {
  Look look = fan(61, 40, 0.2, 150);
  look.decisions.set_hit(60, 30);  // 150 degrees to starboard
  VoxelBlocks map;
  FanMapper(by(Rule::kStamp), 0.25, 0).update(look.ping, look.decisions, {}, map);
  const double a = Angle::degrees(150).radians();
  EXPECT_GT(map.at(floor_of(Vector3d(6.1 * std::cos(a), 6.1 * std::sin(a), 0) / 0.25)), 0);
  EXPECT_LT(map.at(floor_of(Vector3d(6.1 * std::cos(a), -6.1 * std::sin(a), 0) / 0.25)), 0);
  EXPECT_EQ(map.at(floor_of(Vector3d(-6, 0, 0) / 0.25)), kUnseen);
}

// ledger: S6-09 S6-69
TEST(FanMapper, LearnsNothingFromBinsThatTellNothing) {
  Look look = fan(8, 64, 0.2, 20);
  for (int k = 0; k < 64; ++k) look.decisions.set_unusable(k);
  look.decisions.set_hit(3, 40);
  VoxelBlocks map;
  FanMapper mapper(by(Rule::kMarginal), 0.25, 0);
  mapper.update(look.ping, look.decisions, {}, map);
  EXPECT_TRUE(contents(map).empty());

  // A dim bin says something where it holds an echo, and no more than its own p_D allows.
  Look loud = fan(8, 64, 0.2, 20, 15, 60);
  std::vector<float> p(64, 0.3f);
  const std::uint64_t bits = std::uint64_t{0x3FF} << 36;
  for (int b = 0; b < 8; ++b) loud.decisions.set_dim(b, &bits, p.data());
  VoxelBlocks dim;
  FanMapper(by(Rule::kStamp), 0.5, 0).update(loud.ping, loud.decisions, {}, dim);
  const VoxelIndex in = floor_of(Vector3d(8.0, 0, 0) / 0.5);
  EXPECT_EQ(dim.at(in), kUnseen);
  for (int b = 0; b < 8; ++b) {
    for (int k = 36; k < 46; ++k) loud.decisions.set_hit(b, k);
  }
  FanMapper(by(Rule::kStamp), 0.5, 0).update(loud.ping, loud.decisions, {}, dim);
  EXPECT_NEAR(to_log_odds(dim.at(in)), std::log(0.3 / 0.02), 0.01);
}

// ledger: S5-14
TEST(FanMapper, CountsBeamsWithinAWidthAsOneLook) {
  const auto clear_at_2_m = [](double width) {
    Look look = fan(81, 40, 0.1, 20);
    auto wide = std::make_shared<BeamFan>(*look.ping.fan);
    wide->width.assign(81, Angle::degrees(width));
    look.ping.fan = wide;
    VoxelBlocks map({-30'000, 30'000});
    FanMapper(by(Rule::kStamp), 0.25, 0).update(look.ping, look.decisions, {}, map);
    return to_log_odds(map.at(floor_of(Vector3d(2, 0, 0) / 0.25)));
  };
  const double one = std::log(0.2 / 0.98);
  EXPECT_NEAR(clear_at_2_m(30), one, 0.01);
  EXPECT_NEAR(clear_at_2_m(3.5), 17 * 0.5 / 3.5 * one, 0.01);  // it spans seventeen of them
  EXPECT_NEAR(clear_at_2_m(0.5), 4 * one, 0.01);               // no more than max_looks
}

TEST(FanMapper, RefusesVoxelsThatAreNotOfTheSonarsScale) {
  const Look look = fan(512, 500, 0.01, 60);
  VoxelBlocks map;
  EXPECT_EQ(FanMapper::fault_of(look.ping, 0.025), nullptr);
  for (const double voxel_m : {2.0, 0.001}) {
    EXPECT_NE(FanMapper::fault_of(look.ping, voxel_m), nullptr);
    EXPECT_THROW(FanMapper(by(Rule::kStamp), voxel_m, 0).update(look.ping, look.decisions, {}, map), Error);
  }
  EXPECT_EQ(map.blocks(), 0u);
}

// A beam that reaches beyond upright hears all of the half-space ahead, and no more.
TEST(FanMapper, HasNoElevationBeyondVertical) {
  const auto heard = [](double height_deg) {
    Look look = fan(9, 20, 0.2, 20, height_deg);
    for (int b = 0; b < 9; ++b) look.decisions.set_hit(b, 15);
    VoxelBlocks map;
    FanMapper(by(Rule::kStamp), 0.25, 0).update(look.ping, look.decisions, {}, map);
    return contents(map);
  };
  EXPECT_GT(heard(180).size(), 2 * heard(60).size());
  EXPECT_EQ(heard(220), heard(180));
  EXPECT_EQ(heard(360), heard(180));
}

}  // namespace
}  // namespace isobath

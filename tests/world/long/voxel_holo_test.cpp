// The map in three dimensions on echoes that nobody here made: an imaging sonar that circles a small boat, 14 degrees
// tall, with exact poses. There is no truth of the hull; so maps of different passes are held against each other, and
// each map against the other's pings: does it say which bins echo?
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <isobath/configuration/configuration.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/world/voxel_model.hpp>
#include <iterator>
#include <set>
#include <tests/support/data.hpp>
#include <tests/support/kept_scans.hpp>

namespace isobath {
namespace {

using Rule = FanMapperConfig::Rule;

constexpr double kVoxel = 0.15, kPrior = 0.05;

struct Kept {
  Ping ping;
  EchoDecisions decisions;
  Pose X_WB;
};

class PingKeeper : public ResultSink {
 public:
  void on_ping(const PosedPing& posed) override {
    kept.push_back({posed.look_ping(), posed.look_decisions(), posed.X_WB});
  }
  void on_scan(const ScanResult&) override {}
  std::vector<Kept> kept;
};

/// Rules are compared on the decisions of samples, many of them faint: method `learnt`.
std::vector<Kept> pings_of(const char* set, std::initializer_list<int> passes, const char* method = "learnt") {
  PingKeeper keeper;
  for (const int pass : passes) {
    const Configuration configuration =
        test::configured({std::string("input.set=") + set, "input.pass=" + std::to_string(pass),
                          std::string("echoes.method=") + method});
    const auto source = open_source(test::shared_data("holo-boat"), configuration.input);
    Pipeline pipeline(configuration, keeper);
    while (auto event = source->next()) pipeline.on_event(std::move(*event));
    pipeline.finish();
  }
  return std::move(keeper.kept);
}

VoxelMap map_of(const std::vector<Kept>& pings, const FanMapperConfig& config, double voxel_m = kVoxel) {
  VoxelMapConfig c = VoxelModelConfig().map;
  c.voxel_m = voxel_m;
  c.prior = kPrior;
  VoxelMap map(c);
  FanMapper mapper(config, voxel_m, std::log(kPrior / (1 - kPrior)));
  for (const Kept& k : pings) mapper.update(k.ping, k.decisions, k.X_WB, map.layer("flat"), 2);
  return map;
}

/// Of the voxels that one map is sure are occupied, where the other has looked too: how many have one that the other is
/// sure of within so many voxels.
double agreement(const VoxelMap& a, const VoxelMap& b, double sure, int within = 1) {
  const int edge = 2 * within + 1;
  int all = 0, met = 0;
  for (const VoxelIndex& corner : a.changed_after(0)) {
    for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
      const VoxelIndex v = corner + VoxelBlocks::place_of(i);
      if (a.probability(v) < sure || !b.is_seen(v)) continue;
      ++all;
      bool near = false;
      for (int n = 0; n < edge * edge * edge && !near; ++n) {
        const VoxelIndex by(n / (edge * edge) - within, n / edge % edge - within, n % edge - within);
        near = b.probability(v + by) >= sure;
      }
      met += near ? 1 : 0;
    }
  }
  return all > 0 ? static_cast<double>(met) / all : 0;
}

/// Mean of -ln P(decision) over the bins all of whose voxels the map has looked at; nats.
double log_loss(const VoxelMap& map, const std::vector<Kept>& pings, int every) {
  FanMapper mapper({}, kVoxel, 0);
  double sum = 0;
  std::int64_t bins = 0;
  for (std::size_t n = 0; n < pings.size(); n += static_cast<std::size_t>(every)) {
    const Kept& k = pings[n];
    const auto forecast = mapper.forecast(k.ping, k.decisions, k.X_WB, map);
    for (int beam = 0; beam < k.decisions.beams(); ++beam) {
      for (int bin = 0; bin < k.decisions.bins(); ++bin) {
        const EchoForecast& f = forecast[static_cast<std::size_t>(beam) * k.decisions.bins() + bin];
        if (!k.decisions.tells(beam, bin) || f.seen < 1) continue;
        const double p = std::clamp<double>(f.p_echo, 1e-4, 1 - 1e-4);
        sum -= std::log(k.decisions.hit(beam, bin) ? p : 1 - p);
        ++bins;
      }
    }
  }
  return sum / static_cast<double>(std::max<std::int64_t>(bins, 1));
}

FanMapperConfig by(Rule rule) {
  FanMapperConfig config;
  config.rule = rule;
  return config;
}

// ledger: S5-31 S5-E14
TEST(VoxelsOfAHull, ForecastTheOtherPassesBestByTheMarginalRule) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const auto one = pings_of("clean", {1, 2}), other = pings_of("clean", {3, 4});
  struct Score {
    double of_other, of_one, met_in_other, met_in_one;
  };
  const auto score = [&](Rule rule) {
    const VoxelMap a = map_of(one, by(rule)), b = map_of(other, by(rule));
    return Score{log_loss(a, other, 5), log_loss(b, one, 5), agreement(a, b, 0.9), agreement(b, a, 0.9)};
  };
  const Score marginal = score(Rule::kMarginal), stamp = score(Rule::kStamp), counted = score(Rule::kHitAndMiss);
  const Score aspects = score(Rule::kAspects);
  for (const auto& [name, s] :
       {std::pair{"aspects", aspects}, {"marginal", marginal}, {"stamp", stamp}, {"hit and miss", counted}}) {
    std::printf("%s: log-loss %.4f and %.4f nats a bin; sure voxels met %.3f and %.3f\n", name, s.of_other, s.of_one,
                s.met_in_other, s.met_in_one);
  }
  EXPECT_LE(aspects.of_other, marginal.of_other);
  EXPECT_LE(aspects.of_one, marginal.of_one);
  EXPECT_LE(marginal.of_other, stamp.of_other);
  EXPECT_LE(marginal.of_one, stamp.of_one);
  EXPECT_LE(marginal.of_other, counted.of_other);
  EXPECT_LE(marginal.of_one, counted.of_one);
  EXPECT_GT(marginal.met_in_other, 0.2);
  EXPECT_GT(marginal.met_in_one, 0.2);
}

/// Share of the sure voxels of a map that lie in the described box of the hull, half a metre larger.
double in_the_hull(const VoxelMap& map, int& sure) {
  int inside = 0;
  sure = 0;
  for (const VoxelIndex& corner : map.changed_after(0)) {
    for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
      const VoxelIndex v = corner + VoxelBlocks::place_of(i);
      if (map.probability(v) < 0.9) continue;
      ++sure;
      const Eigen::Vector3d p = map.centre_of(v);  // north, east, down
      inside +=
          p.y() > -76.7 && p.y() < -62.2 && p.x() > -33.1 && p.x() < -26.9 && p.z() > 27.4 && p.z() < 32.6 ? 1 : 0;
    }
  }
  return sure > 0 ? static_cast<double>(inside) / sure : 0;
}

// ledger: S5-32
TEST(VoxelsOfAHull, StandWhereTheHullIsAlsoInNoise) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  int clean_sure = 0, noisy_sure = 0;
  const double clean = in_the_hull(map_of(pings_of("clean", {1}), by(Rule::kMarginal)), clean_sure);
  const double noisy = in_the_hull(map_of(pings_of("noisy", {1}), by(Rule::kMarginal)), noisy_sure);
  std::printf("clean: %d sure voxels, %.3f in the hull's box; noisy: %d, %.3f\n", clean_sure, clean, noisy_sure, noisy);
  EXPECT_GT(clean_sure, 300);
  EXPECT_GT(clean, 0.97);
  EXPECT_GT(noisy_sure, 50);
  EXPECT_GT(noisy, 0.9);
}

/// Columns of voxels, seen from above, in which a map is sure of an occupied voxel.
std::set<std::pair<int, int>> outline_from_above(const VoxelMap& map) {
  std::set<std::pair<int, int>> columns;
  for (const VoxelIndex& corner : map.changed_after(0)) {
    for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
      const VoxelIndex v = corner + VoxelBlocks::place_of(i);
      if (map.probability(v) >= 0.9) columns.emplace(v.x(), v.y());
    }
  }
  return columns;
}

// Passes through noise, at other heights and tilts than the clean ones, give the same hull, and more of it: the
// thresholds of the clean ones follow their own strongest echoes. ledger: S5-32
TEST(VoxelsOfAHull, OfNoisyPassesHoldTheHullOfTheCleanOnes) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  const VoxelMap clean = map_of(pings_of("clean", {1, 2, 3, 4}), by(Rule::kMarginal));
  const VoxelMap noisy = map_of(pings_of("noisy", {1, 4, 5, 9, 10}), by(Rule::kMarginal));
  int clean_sure = 0, noisy_sure = 0;
  const double clean_inside = in_the_hull(clean, clean_sure), noisy_inside = in_the_hull(noisy, noisy_sure);
  const auto clean_above = outline_from_above(clean), noisy_above = outline_from_above(noisy);
  std::vector<std::pair<int, int>> both;
  std::set_intersection(clean_above.begin(), clean_above.end(), noisy_above.begin(), noisy_above.end(),
                        std::back_inserter(both));
  std::printf("in the hull's box %.4f of %d clean, %.4f of %d noisy; from above %zu and %zu columns, %zu in both\n",
              clean_inside, clean_sure, noisy_inside, noisy_sure, clean_above.size(), noisy_above.size(), both.size());
  for (const int within : {1, 2, 3}) {
    std::printf("within %d: clean in noisy %.3f, noisy in clean %.3f\n", within, agreement(clean, noisy, 0.9, within),
                agreement(noisy, clean, 0.9, within));
  }
  EXPECT_GT(clean_inside, 0.99);
  EXPECT_GT(noisy_inside, 0.99);
  EXPECT_GT(agreement(clean, noisy, 0.9), 0.8);
  EXPECT_GT(agreement(clean, noisy, 0.9, 3), 0.95);
  EXPECT_GT(agreement(noisy, clean, 0.9), 0.4);
  EXPECT_GT(agreement(noisy, clean, 0.9, 3), 0.75);
  EXPECT_GT(static_cast<double>(both.size()), 0.9 * static_cast<double>(clean_above.size()));
}

bool in_the_box(const Eigen::Vector3d& p) {
  return p.y() > -76.7 && p.y() < -62.2 && p.x() > -33.1 && p.x() < -26.9 && p.z() > 27.4 && p.z() < 32.6;
}

/// Of the beams that hear the hull: how many have their first echo in a cell that meets an occupied voxel.
double first_echoes_met(const VoxelMap& map, const std::vector<Kept>& pings, int every, int& heard) {
  heard = 0;
  int met = 0;
  const double step = 0.25 * map.voxel_m();
  for (std::size_t n = 0; n < pings.size(); n += static_cast<std::size_t>(every)) {
    const Kept& k = pings[n];
    const Pose X_WS = k.X_WB * k.ping.X_BS;
    for (int beam = 0; beam < k.decisions.beams(); ++beam) {
      int bin = 0;
      while (bin < k.decisions.bins() && !(k.decisions.tells(beam, bin) && k.decisions.hit(beam, bin))) ++bin;
      if (bin == k.decisions.bins()) continue;
      const double azimuth = k.ping.fan->azimuth[static_cast<std::size_t>(beam)].radians();
      const double range = k.ping.window.centre(bin), half = 0.5 * k.ping.fan->height.radians();
      bool hull = false, occupied = false;
      const double half_width = 0.5 * k.ping.fan->width[static_cast<std::size_t>(beam)].radians();
      for (double e = -half; e <= half; e += step / range) {
        for (int corner = 0; corner < 9; ++corner) {
          const double a = azimuth + (corner / 3 - 1) * half_width,
                       r = range + (corner % 3 - 1) * 0.5 * k.ping.window.bin_m;
          const Eigen::Vector3d p =
              X_WS * (r * Eigen::Vector3d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)));
          hull = hull || in_the_box(p);
          occupied = occupied || map.space(map.voxel_at(p)) == Space::kOccupied;
        }
      }
      heard += hull ? 1 : 0;
      met += hull && occupied ? 1 : 0;
    }
  }
  return static_cast<double>(met) / std::max(heard, 1);
}

// Voxels of 5 cm, each pass alone, as a run of it makes them. ledger: S5-32 S5-33
TEST(VoxelsOfAHull, AreOccupiedWhereTheFirstEchoesOfAPassComeFrom) {
  ISOBATH_NEEDS_DATA(folder, "holo-boat");
  for (const auto& [set, pass] : {std::pair{"clean", 1}, {"noisy", 1}}) {
    const auto pings = pings_of(set, {pass}, "auto");
    for (const Rule rule : {Rule::kAspects, Rule::kMarginal}) {
      const VoxelMap map = map_of(pings, by(rule), 0.05);
      int occupied = 0, inside = 0, heard = 0;
      for_each_seen(map, [&](const VoxelIndex& v) {
        if (map.space(v) != Space::kOccupied) return;
        ++occupied;
        inside += in_the_box(map.centre_of(v)) ? 1 : 0;
      });
      const double met = first_echoes_met(map, pings, 3, heard);
      std::printf("%s %d, %s: %d voxels occupied, %.3f in the hull's box; %.3f of %d first echoes of the hull met\n",
                  set, pass, rule == Rule::kAspects ? "aspects" : "marginal", occupied,
                  1.0 * inside / std::max(occupied, 1), met, heard);
      if (rule != Rule::kAspects) continue;
      EXPECT_GT(met, 0.8);
      EXPECT_GT(1.0 * inside / std::max(occupied, 1), 0.97);
      EXPECT_GT(occupied, 1100);
    }
  }
}

}  // namespace
}  // namespace isobath

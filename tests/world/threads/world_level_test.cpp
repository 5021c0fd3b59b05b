// One level of the world model: its six parts, its start, its missions.
#include <atomic>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/planning/pilot_search.hpp>
#include <isobath/world/map_features.hpp>
#include <limits>
#include <mutex>
#include <tests/support/data.hpp>
#include <tests/world/charted_lake.hpp>
#include <thread>

namespace isobath::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const ChartedLake::World kFlat = with_piles(20, {});

std::vector<DepthPixel> all_pixels(const DepthSnapshot& map) {
  const PixelWindow all = map.trees().extent();
  std::vector<DepthPixel> pixels(static_cast<std::size_t>(all.width) * all.height);
  map.read(all, pixels);
  return pixels;
}

/// Begins the map, and says nothing of it.
void wake(DepthModel& model, double time_s = 0) {
  model.on_range(with_range(looking(90, 6), {}, time_s), {at(0, 0, 3), 0});
}

/// To and fro over ground 12 m deep that the chart has deeper.
void survey_shoal(DepthModel& model) {
  const std::vector<RangeReading> heard = ChartedLake::hear(with_piles(12, {}), at(0, 0, 3));
  for (int i = 0; i < 600; ++i) ChartedLake::give(model, heard, at(-40 + 0.9 * (i % 60), 0, 3), 0.6 * i);
}

// ledger: S1-01
TEST(WorldLevel, OfAConfigurationHasSixPartsThatWork) {
  const fs::path folder = scratch_folder();
  const ChartedLake lake(folder, kFlat);
  DepthModel model(lake.configuration, folder / "map");
  lake.prepare(model);
  WorldLevel& level = model.level();
  ASSERT_TRUE(level.update && level.serve && level.predict && level.learn && level.evaluate && level.store);
  EXPECT_EQ(level.serve(), nullptr) << "no reading, no map";
  EXPECT_FALSE(level.predict(looking(90, 6), at(0, 0, 3)));
  ChartedLake::swim(model, kFlat, at(0, 0, 3), 20);
  model.finish();
  EXPECT_TRUE(level.serve()->at(level.serve()->grid().at({10, 0})).has(kSeenByDepth));
  EXPECT_NEAR(level.predict(looking(90, 6), at(10, 0, 3))->expected_m, 17, 0.02);
  const auto ahead = level.predict(looking(0, 6), at(10, 0, 3));
  EXPECT_GT(ahead->expected_m, ahead->max_range_m) << "17 m / sin 3 deg is far";
  for (const ModuleStatus& part : level.evaluate(Time{} + seconds(13.2), 7)) EXPECT_EQ(part.state, HealthState::kOk);
  ASSERT_EQ(model.sensors().size(), 6U);
  for (const auto& sensor : model.sensors()) {
    EXPECT_EQ(sensor.counts.conflicting, 0U) << aim_of(sensor.X_BS);
    EXPECT_EQ(sensor.counts.confirming, 23U) << aim_of(sensor.X_BS);
  }
  EXPECT_EQ(aim_of(model.sensors().front().X_BS), "30 deg to port");
  EXPECT_EQ(aim_of(model.sensors().back().X_BS), "down");
  level.store({"a test", {}, {}, {}});
  EXPECT_EQ(open_map(folder / "map").facts.visits.front().input, "a test");
}

// ledger: S1-01
TEST(WorldLevel, AnyPartIsReplacedByAStubAndTheOthersRun) {
  const fs::path folder = scratch_folder();
  ChartedLake lake(folder, kFlat);
  lake.configuration.prior.pixel_m = 4;
  constexpr int kCycles = 23;
  const auto way = [](int i) { return at(-10 + 0.9 * i, 0, 3); };
  std::vector<std::vector<RangeReading>> heard;
  for (int i = 0; i < kCycles; ++i) heard.push_back(ChartedLake::hear(with_piles(20, {{30, 0, 1, 0}}), way(i)));
  struct Seen {
    std::vector<DepthPixel> map;
    std::uint64_t confirming = 0, conflicting = 0, irrelevant = 0;
    bool lost = false;
    std::uint64_t generation = 0;
  };
  const auto keeps_a_map = [](const std::string& name) { return name == "whole" || name == "store"; };
  const auto mission = [&](const std::string& name, const std::function<void(WorldLevel&)>& replace) {
    DepthModel model(lake.configuration, keeps_a_map(name) ? folder / name : fs::path());
    lake.prepare(model);
    replace(model.level());
    for (int i = 0; i < kCycles; ++i) ChartedLake::give(model, heard[static_cast<std::size_t>(i)], way(i), 0.6 * i);
    model.finish();
    model.commit(name);
    Seen seen;
    if (const auto map = model.snapshot()) seen.map = all_pixels(*map);
    for (const auto& s : model.sensors()) {
      seen.confirming += s.counts.confirming;
      seen.conflicting += s.counts.conflicting;
      seen.irrelevant += s.counts.irrelevant;
    }
    seen.lost = model.emergencies().snapshot().has(Emergency::kModuleFailure);
    seen.generation = model.facts().generation;
    return seen;
  };
  const Seen whole = mission("whole", [](WorldLevel&) {});
  ASSERT_GT(whole.confirming, 50U);
  ASSERT_GT(whole.conflicting, 0U) << "a pile that the chart has not";
  EXPECT_FALSE(whole.lost);
  EXPECT_EQ(whole.generation, 1U);
  int calls = 0;

  const Seen no_update = mission("update", [&](WorldLevel& l) { l.update = [&](const LevelInput&) { ++calls; }; });
  EXPECT_EQ(calls, kCycles * 7 - 1) << "six readings and one fix a cycle; before the first reading there is no map";
  for (const DepthPixel& pixel : no_update.map) ASSERT_FALSE(pixel.has(kSensed));
  EXPECT_GT(no_update.conflicting, whole.conflicting) << "the map does not learn of the pile";

  const Seen no_server = mission("serve", [](WorldLevel& l) { l.serve = [] { return nullptr; }; });
  EXPECT_TRUE(no_server.map.empty());
  EXPECT_EQ(no_server.confirming, whole.confirming);

  const Seen no_prediction =
      mission("predict", [](WorldLevel& l) { l.predict = [](const auto&, const auto&) { return std::nullopt; }; });
  EXPECT_EQ(no_prediction.confirming + no_prediction.conflicting, 0U);
  EXPECT_EQ(no_prediction.irrelevant, 6U * kCycles);
  EXPECT_EQ(no_prediction.map, whole.map);

  calls = 0;
  const Seen no_learning = mission("learn", [&](WorldLevel& l) {
    l.learn = [&](const auto&, const std::optional<RangePrediction>& expected) { calls += expected.has_value(); };
  });
  EXPECT_EQ(calls, static_cast<int>(whole.confirming + whole.conflicting));
  EXPECT_EQ(no_learning.confirming, 0U);
  EXPECT_EQ(no_learning.map, whole.map);

  calls = 0;
  const Seen no_evaluator = mission("evaluate", [&](WorldLevel& l) {
    l.evaluate = [&](Time, unsigned) {
      ++calls;
      return std::span<const ModuleStatus>();
    };
  });
  EXPECT_EQ(calls, kCycles * 7 - 1);
  EXPECT_EQ(no_evaluator.map, whole.map);

  std::string stored;
  const Seen no_store =
      mission("store", [&](WorldLevel& l) { l.store = [&](const MapVisit& visit) { stored = visit.input; }; });
  EXPECT_EQ(stored, "store");
  EXPECT_EQ(no_store.generation, 0U);
  EXPECT_EQ(no_store.map, whole.map);

  const Seen gone = mission("gone", [](WorldLevel& l) { l.learn = nullptr; });
  EXPECT_TRUE(gone.lost) << "a part that does not beat is missed";
  EXPECT_EQ(gone.map, whole.map);
}

// ledger: S1-81, S1-13
TEST(StartUp, TheFirstLocalMapIsTheChartWhereNothingWasSensed) {
  const auto valley = [](double north, double east) {
    return north > 64 && east > 64 ? kNaN : 20 + 0.05 * north + 0.02 * std::abs(east);
  };
  const fs::path folder = scratch_folder();
  const ChartedLake lake(folder, valley);
  DepthModel model(lake.configuration, folder / "map");
  lake.prepare(model);
  wake(model);
  const auto map = model.snapshot();
  const PixelWindow all = map->trees().extent();
  EXPECT_EQ(map->window().extent(), all) << "256 m, as the area of this test";
  for (int row = 0; row < all.height; ++row) {
    for (int column = 0; column < all.width; ++column) {
      const Eigen::Vector2d p = map->grid().centre({column, row});
      const DepthPixel pixel = map->at({column, row});
      const double charted = valley(p.x(), p.y());
      ASSERT_EQ(pixel.known(), std::isfinite(charted)) << p.transpose();
      ASSERT_EQ(pixel.confidence(), std::isfinite(charted) ? 5 : 0);
      ASSERT_EQ(pixel.flags(), 0U);
      if (pixel.known()) {
        ASSERT_NEAR(pixel.depth_m(), charted, 0.006) << p.transpose();
      }
    }
  }
  // Sensed on the way: elsewhere the chart still stands.
  survey_shoal(model);
  model.finish();
  const std::vector<DepthPixel> before = all_pixels(*map), after = all_pixels(*model.snapshot());
  std::size_t sensed = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    sensed += after[i].has(kSensed);
    if (!after[i].has(kSensed)) {
      ASSERT_EQ(after[i].depth_word, before[i].depth_word);
    }
  }
  EXPECT_GT(sensed, 200U);
  EXPECT_TRUE(map->trees().prior() == model.snapshot()->trees().prior());
}

// ledger: S1-72, S1-46
TEST(StartUp, RoughGroundOfTheChartIsLessSureWhereThatIsAskedForAndSmoothGroundIsNot) {
  // Steps of 4 m in the east, as a chessboard of metres; flat in the west.
  const auto chart = [](double north, double east) {
    const auto odd = static_cast<int>(std::floor(north) + std::floor(east)) & 1;
    return east < 0 ? 20.0 : 20 + 4.0 * odd;
  };
  const fs::path folder = scratch_folder();
  ChartedLake lake(folder, chart);
  lake.configuration.depth.mapper.prefilter = false;
  struct Outcome {
    std::vector<DepthPixel> start;
    std::uint64_t false_in_smooth = 0, false_in_rough = 0;
  };
  const auto run = [&](double rough_m) {
    lake.configuration.prior.rough_m = rough_m;
    Outcome outcome;
    for (const double heading : {-90.0, 90.0}) {
      DepthModel model(lake.configuration, {});
      lake.prepare(model);
      wake(model);
      outcome.start = all_pixels(*model.snapshot());
      Random random(3);
      for (int i = 0; i < 1000; ++i) {  // empty water, 5 % of the echoes are of nothing
        const bool spurious = random.uniform() < 0.05;
        const double range = random.uniform(5, 45);
        model.on_range(with_range(looking(0, 6), spurious ? std::optional(range) : std::nullopt, 0.6 * i),
                       {at(0, 0, 5, heading), 0});
      }
      model.finish();
      (heading < 0 ? outcome.false_in_smooth : outcome.false_in_rough) = model.counts().replaced;
    }
    return outcome;
  };
  const Outcome plain = run(0), doubtful = run(0.5);
  const PixelGrid grid = area_of(lake.configuration.depth_map).grid;
  const int side = 512;
  for (std::size_t i = 0; i < plain.start.size(); ++i) {
    const Eigen::Vector2d p = grid.centre({static_cast<int>(i) % side, static_cast<int>(i) / side});
    ASSERT_EQ(plain.start[i].confidence(), 5);
    ASSERT_GE(doubtful.start[i].confidence(), lake.configuration.depth.rules.threshold);
    if (p.y() < -1) {
      ASSERT_EQ(doubtful.start[i].confidence(), 5) << p.transpose();
    }
    // In the corner of a square of the board, 4 or 5 of 9 half-metre squares are 4 m deeper: var 3.95, 20 / 16.8 = 1.
    if (p.y() > 1 && p.cwiseAbs().maxCoeff() < 127) {
      ASSERT_EQ(doubtful.start[i].confidence(), 2) << p.transpose();
    }
  }
  EXPECT_EQ(doubtful.false_in_smooth, plain.false_in_smooth) << "the same base, the same delay: nothing is won there";
  EXPECT_GT(doubtful.false_in_rough, plain.false_in_rough) << "believed sooner, wrongly too: why it is off";
  EXPECT_EQ(DepthPriorConfig{}.rough_m, 0);
}

// ledger: S1-81, S1-26
TEST(StartUp, WithoutWithAndWithDamagedStoredMaps) {
  const fs::path folder = scratch_folder();
  const ChartedLake lake(folder, kFlat);
  const auto open = [&] {
    auto model = std::make_unique<DepthModel>(lake.configuration, folder / "map");
    model->locate(ChartedLake::kOrigin);
    return model;
  };
  std::vector<DepthPixel> stored;
  {
    DepthModel model(lake.configuration, folder / "map");
    lake.prepare(model);
    EXPECT_FALSE(model.continues());
    survey_shoal(model);
    model.finish();
    model.commit("first");
    stored = all_pixels(*model.snapshot());
  }
  {
    const auto model = open();
    EXPECT_TRUE(model->continues());
    wake(*model, 1000);
    EXPECT_TRUE(model->damages().empty());
    EXPECT_EQ(all_pixels(*model->snapshot()), stored);
  }
  const auto spoil = [&](const char* tree) {
    for (const auto& entry : fs::directory_iterator(folder / "map")) {
      if (entry.path().filename().string().rfind(tree, 0) != 0) continue;
      std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
      const auto size = static_cast<std::streamoff>(fs::file_size(entry.path()));
      for (std::streamoff at = size / 2; at < size / 2 + 16; ++at) {
        file.seekp(at);
        file.put('\x5a');
      }
    }
  };
  spoil("sensed.");
  {
    const auto model = open();
    wake(*model, 1000);
    ASSERT_FALSE(model->damages().empty());
    EXPECT_THAT(to_text(model->damages().front()), HasSubstr("sensed."));
    // What is lost is not known any more, or is charted again; nothing is made up, and nothing else has changed.
    const std::vector<DepthPixel> left = all_pixels(*model->snapshot());
    std::size_t lost = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (left[i] == stored[i]) continue;
      ++lost;
      ASSERT_TRUE(!left[i].known() || left[i].depth_m() == 20 || left[i].depth_word == stored[i].depth_word);
    }
    EXPECT_GT(lost, 0U);
  }
  for (const char* name : {"map.json", "map.json.copy"}) std::ofstream(folder / "map" / name) << "{";
  try {
    open();
    ADD_FAILURE() << "a map without a record was opened";
  } catch (const Error& refusal) {
    EXPECT_THAT(refusal.what(), HasSubstr("map.json"));
  }
}

// ledger: S1-77, S1-18
TEST(Missions, TheReportListsThePlantedObstaclesAsFoundByForwardSonar) {
  const fs::path folder = scratch_folder();
  const ChartedLake lake(folder, kFlat);
  const std::vector<Pile> piles{{0, 0, 1, 0}, {5, 25, 1, 0}};
  DepthModel model(lake.configuration, {});
  lake.prepare(model);
  ChartedLake::swim(model, with_piles(20, piles), at(-55, 0, 3), 40);
  ChartedLake::swim(model, with_piles(20, piles), at(-55, 25, 3), 45, 100);
  model.finish();
  const MapChanges& changes = model.changes();
  ASSERT_EQ(changes.regions.size(), 2U);
  EXPECT_EQ(changes.obstacles(), 2U);
  std::uint64_t pixels = 0;
  for (const Pile& pile : piles) {
    const auto found = std::find_if(changes.regions.begin(), changes.regions.end(), [&](const ChangedRegion& r) {
      return std::abs(r.shoalest_at.y() - pile.east) < 3;
    });
    ASSERT_NE(found, changes.regions.end());
    EXPECT_EQ(found->source(), DepthSource::kObstacleSonar);
    EXPECT_STREQ(kind_of(*found), "obstacle");
    EXPECT_NEAR(found->south_west.x(), pile.north - pile.half_m, 1) << "its face";
    EXPECT_LT(found->south_west.y(), pile.east);
    EXPECT_GT(found->north_east.y(), pile.east);
    EXPECT_LT(found->shoalest_m, 3) << "the beam of a vehicle 3 m deep reaches up to there";
    EXPECT_NEAR(found->charted_m, 20, 0.01);
    EXPECT_GT(found->confidence, lake.configuration.depth.rules.base_sensor);
    EXPECT_NEAR(found->area_m2, 0.25 * static_cast<double>(found->pixels), 1e-9);
    pixels += found->pixels;
  }
  EXPECT_EQ(changes.changed_pixels, pixels);
  // The track is the way that the vehicle went, over to the second leg included, and nothing else.
  const Eigen::Vector2d corners[] = {{-55, 0}, {-55 + 39.6, 0}, {-55, 25}, {-10, 25}};
  const auto off = [&](const Eigen::Vector2d& p) {
    double least = 1e9;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector2d leg = corners[i + 1] - corners[i];
      const double along = std::clamp((p - corners[i]).dot(leg) / leg.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (p - corners[i] - along * leg).norm());
    }
    return least;
  };
  const PixelGrid grid = model.snapshot()->grid();
  const auto marked = [&](Pixel p) {
    return std::any_of(changes.track.begin(), changes.track.end(), [&](const PixelWindow& w) { return w.contains(p); });
  };
  std::uint64_t track = 0;
  for (const PixelWindow& run : changes.track) {
    track += static_cast<std::uint64_t>(run.width);
    for (int c = 0; c < run.width; ++c)
      EXPECT_LE(off(grid.centre({run.column + c, run.row})), 0.36) << "half a diagonal";
  }
  EXPECT_EQ(track, changes.track_pixels);
  for (double north = -53.9; north < -16; north += 0.1) EXPECT_TRUE(marked(grid.at({north, 0.01}))) << north;
  for (double north = -55; north < -11; north += 0.1) EXPECT_TRUE(marked(grid.at({north, 25.01}))) << north;
}

// A brute-force flood fill over the fused pixels. ledger: S1-77
TEST(MapChanges, RegionsAreThoseOfAFloodFill) {
  Random random(5);
  constexpr int kLevels = 7, kSide = 1 << kLevels;
  RegionQuadtree prior(kLevels, 0), sensed(kLevels, 0), state(kLevels, 0);
  prior.fill({0, 0, kSide, 100}, DepthPixel::word_of_depth(10));
  for (int i = 0; i < 3000; ++i) {
    const int column = static_cast<int>(random.index(kSide)), row = static_cast<int>(random.index(kSide));
    const PixelWindow pixel{column, row, 1, 1};
    const double depth = std::vector<double>{9.4, 9.6, 10.4, 10.6}[random.index(4)];
    const std::vector<unsigned> seen{kSeenByDepth, kSeenByObstacle, kSeenByDepth | kSeenByObstacle};
    sensed.fill(pixel, DepthPixel::word_of_depth(depth));
    state.fill(pixel, DepthPixel::word_of_state(6, kSensed | seen[random.index(3)], 7));
  }
  const DepthTrees trees(prior, sensed, state);
  const MapChanges found = find_changes(trees, {{0, 0}, 1}, 0.5);
  std::vector<int> label(kSide * kSide, 0);
  const auto sense = [&](Pixel p) {
    const DepthPixel pixel = trees.at(p);
    if (!trees.extent().contains(p) || !pixel.has(kSensed) || p.row >= 100) return 0;
    return pixel.depth_cm() < 950 ? -1 : pixel.depth_cm() > 1050 ? 1 : 0;
  };
  std::multiset<std::pair<int, std::uint64_t>> expected, got;
  for (int start = 0; start < kSide * kSide; ++start) {
    const Pixel first{start % kSide, start / kSide};
    if (sense(first) == 0 || label[static_cast<std::size_t>(start)] != 0) continue;
    std::vector<Pixel> todo{first};
    label[static_cast<std::size_t>(start)] = 1;
    std::uint64_t size = 0;
    while (!todo.empty()) {
      const Pixel p = todo.back();
      todo.pop_back();
      ++size;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const Pixel q{p.column + dx, p.row + dy};
          if (sense(q) != sense(first)) continue;
          int& mark = label[static_cast<std::size_t>(q.row) * kSide + q.column];
          if (std::exchange(mark, 1) == 0) todo.push_back(q);
        }
      }
    }
    expected.emplace(sense(first), size);
  }
  for (const ChangedRegion& r : found.regions) {
    got.emplace(r.shoaler ? -1 : 1, r.pixels);
    EXPECT_EQ(r.by_both + r.by_depth_sonar + r.by_obstacle_sonar, r.pixels);
    EXPECT_EQ(r.shoalest_m, r.shoaler ? 9.4 : 10.6);
  }
  EXPECT_EQ(got, expected);
  EXPECT_GT(expected.size(), 100U);
  EXPECT_GT(std::prev(expected.end())->second, 1U);
}

/// Least distance of a way from a square pile, m.
double distance(const std::vector<Eigen::Vector3d>& way, const Pile& pile) {
  double least = 1e9;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    for (int k = 0; k <= 100; ++k) {
      const Eigen::Vector3d p = way[i] + (way[i + 1] - way[i]) * k / 100;
      least = std::min(least, std::hypot(std::max(0.0, std::abs(p.x() - pile.north) - pile.half_m),
                                         std::max(0.0, std::abs(p.y() - pile.east) - pile.half_m)));
    }
  }
  return least;
}

// ledger: S1-D01, S1-26, S1-07, S1-06
TEST(Missions, TheSecondKnowsTheObstacleBeforeItsSonarDoesAndTheThirdForgetsIt) {
  const fs::path folder = scratch_folder();
  const ChartedLake lake(folder, kFlat);
  const Pile pile{0, 0, 1, 0};
  const auto with = with_piles(20, {pile});
  PilotSearchConfig pilot;
  pilot.passage = {1, 2};
  const Eigen::Vector3d start(-55, 0, 3), goal(50, 0, 3);
  const auto mission = [&](const ChartedLake::World& world, double start_s, bool lingers = false) {
    DepthModel model(lake.configuration, folder / "map");
    lake.prepare(model);
    wake(model, start_s);
    const auto plan = search_path(*model.snapshot(), start, goal, pilot);
    EXPECT_TRUE(plan);
    ChartedLake::swim(model, world, at(-55, 0, 3), 40, start_s);
    if (lingers) {  // forward sonar lowers it to what its beams clear; only a depth sonar can say that it is not there
      const std::vector<RangeReading> flat = ChartedLake::hear(kFlat, at(0, 0, 3));
      double t = start_s + 100;
      for (int i = 0; i < 800; ++i, t += 0.6) {
        ChartedLake::give(model, flat, at(i < 400 ? -45 : -30, i % 400 < 200 ? -1.5 : 1.5, 3), t);
      }
      for (int i = 0; i < 1600; ++i, t += 0.6) {
        ChartedLake::give(model, flat, at(-6 + i % 20, -4 + i / 20 % 8, 3), t);
      }
    }
    model.finish();
    model.commit("a mission");
    return std::pair(plan->points, model.found());
  };
  const auto [blind, first] = mission(with, 0);
  EXPECT_EQ(distance(blind, pile), 0) << "the chart knows nothing of it";
  EXPECT_EQ(first.met_first, 1U);
  ObjectId id = 0;
  {
    const ObjectStore store(folder / "map" / "objects.sqlite");
    const auto ids = store.with_any(kFoundObject);
    ASSERT_EQ(ids.size(), 1U);
    EXPECT_EQ(store.with_any(kBlocksPassage), ids);
    id = ids.front();
    EXPECT_EQ(store.find(id)->kind, "obstacle");
    EXPECT_NEAR(store.find(id)->p_W.x(), -1, 1.5);
    EXPECT_EQ(store.history(id, "depth").size(), 1U);
    EXPECT_EQ(std::get<std::string>(store.latest(id, "last seen")->value), to_text(Time{}));
    const MapFeatures features = load_features(store, open_map(folder / "map").facts.area);
    EXPECT_EQ(obstacles_near(features, Eigen::AlignedBox2d(Eigen::Vector2d(-5, -5), Eigen::Vector2d(5, 5)), 1).size(),
              1U);
  }
  const auto [seeing, second] = mission(with, 3600);
  EXPECT_GT(distance(seeing, pile), pilot.passage.half_width_m);
  EXPECT_EQ(second.met_first, 0U);
  EXPECT_EQ(second.met_again, 1U) << "the same object, no second one";
  const auto [wary, third] = mission(kFlat, 7200, true);
  EXPECT_GT(distance(wary, pile), pilot.passage.half_width_m);
  EXPECT_EQ(third.gone, 1U);
  const auto [free, fourth] = mission(kFlat, 10800);
  EXPECT_EQ(distance(free, pile), 0);
  EXPECT_EQ(fourth.gone + fourth.met_first + fourth.met_again, 0U);
  const ObjectStore store(folder / "map" / "objects.sqlite");
  EXPECT_EQ(store.with_any(kFoundObject), std::vector<ObjectId>{id});
  EXPECT_TRUE(store.with_any(kBlocksPassage).empty());
  EXPECT_EQ(store.history(id, "depth").size(), 2U);
  EXPECT_EQ(std::get<std::string>(store.latest(id, "label")->value), "vanished");
}

// ledger: S1-70, S1-D04, S1-56, S1-03
TEST(Missions, SixReadingsACycleAreTakenWhileAPlannerAsksAndWindowsShift) {
  const auto world = with_piles(20, {{60, 2, 1, 0}, {130, -4, 1, 0}});
  Configuration configuration;
  configuration.depth_map.area_m = 512;
  configuration.depth_map.window_pixels = 256;
  const auto mission = [&](bool background, const std::function<void(DepthModel&)>& beside) {
    configuration.depth.mapper.background = background;
    DepthModel model(configuration, {});
    int given = 0;
    for (int leg = 0; leg < 20; ++leg) {
      given += ChartedLake::swim(model, world, at(-100 + 9.9 * leg, 10, 3), 9, 6.6 * leg);
      beside(model);
    }
    model.finish();
    const DepthCounts& n = model.counts();
    EXPECT_EQ(given, 20 * 11) << "cycles of six";
    EXPECT_EQ(n.readings, static_cast<std::uint64_t>(6 * given));
    for (const std::uint64_t refused : n.refused) EXPECT_EQ(refused, 0U);
    EXPECT_GE(n.shifts, 4U);
    EXPECT_LT(n.waited, n.shifts) << "how many shifts must wait is up to the disk";
    return std::pair(all_pixels(*model.snapshot()), n);
  };
  const auto [alone, counts] = mission(false, [](DepthModel&) {});
  std::mutex lock;
  std::shared_ptr<const DepthSnapshot> latest;
  std::atomic<bool> over = false;
  std::atomic<int> plans = 0;
  std::thread planner([&] {
    PilotSearchConfig pilot;
    pilot.margin_m = 10;
    while (!over) {
      std::shared_ptr<const DepthSnapshot> map;
      {
        const std::scoped_lock guard(lock);
        map = latest;
      }
      if (map && search_path(*map, {-60, 10, 3}, {-40, 10, 3}, pilot)) ++plans;
      std::this_thread::yield();
    }
  });
  const auto [beside, counts_beside] = mission(true, [&](DepthModel& model) {
    const std::scoped_lock guard(lock);
    latest = model.snapshot();
  });
  over = true;
  planner.join();
  EXPECT_EQ(beside, alone) << "pixel for pixel";
  EXPECT_EQ(counts_beside.applied, counts.applied);
  EXPECT_EQ(counts_beside.replaced, counts.replaced);
}

}  // namespace
}  // namespace isobath::test

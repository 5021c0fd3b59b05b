// What `isobath path` knows of the objects and lines of a map, and how a map's confidence changes, one sounding at a
// time.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <isobath/base/random.hpp>
#include <isobath/geometry/segment.hpp>
#include <isobath/map/features/object_store.hpp>
#include <isobath/world/map_features.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath::map_objects {
namespace {
namespace fs = std::filesystem;
using namespace test;
using Eigen::Vector2d;
using nlohmann::json;

/// The map of scenarios/charted_shoals.asc, with wrecks and pipelines scattered over 400 m.
class MapObjects : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path chart = source_folder() / "scenarios" / "charted_shoals.asc";
    const ProgramResult made = isobath::test::isobath({"convert", chart, map_, "--set", "prior.epsg=4326", "--set",
                                                       "prior.sign=down", "--set", "prior.datum_offset_m=[0]"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    Random random(5);
    Prior& prior = priors_.emplace_back();
    const auto somewhere = [&] { return Vector2d(random.uniform(-200, 200), random.uniform(-200, 200)); };
    for (int i = 0; i < 300; ++i) {
      PriorPoint& wreck = prior.points.emplace_back();
      wreck.kind = PriorPointKind::kWreck;
      wreck.name = fmt::format("wreck {}", i);
      wreck.north_east = somewhere();
      wreck.depth_m = 8;
    }
    for (int i = 0; i < 40; ++i) {
      PriorLine& pipeline = prior.lines.emplace_back();
      pipeline.kind = PriorLineKind::kPipeline;
      pipeline.name = fmt::format("pipeline {}", i);
      const Vector2d a = somewhere();
      pipeline.points = {a, a + Vector2d(random.uniform(-60, 60), random.uniform(-60, 60))};
    }
    ObjectStore store(map_ / "objects.sqlite");
    ASSERT_EQ(store_features(store, priors_, Time{}), 340u);
  }
  json path(std::vector<std::string> words) {
    words.insert(words.begin(), {"path", map_, "--metres", "--json"});
    const ProgramResult result = isobath::test::isobath(words);
    EXPECT_LE(result.exit_code, 1) << result.err;
    return json::parse(result.out);
  }
  [[nodiscard]] const std::vector<PriorPoint>& wrecks() const { return priors_[0].points; }

  const fs::path map_ = scratch_folder() / "map";
  std::vector<Prior> priors_;
};

// ledger: S1-20 S1-21
TEST_F(MapObjects, APathNamesTheNearestAndAllWithinADistanceAsAListOfAllDoes) {
  for (const Vector2d& start : {Vector2d(0, 0), Vector2d(-120.5, 66.25), Vector2d(240, -190)}) {
    std::vector<std::pair<double, std::string>> listed;
    for (const PriorPoint& wreck : wrecks()) listed.emplace_back((wreck.north_east - start).norm(), wreck.name);
    std::sort(listed.begin(), listed.end());
    const json found = path({fmt::format("{},{}", start.x(), start.y()), "--objects-within", "75"});
    EXPECT_EQ(found["nearest_object"]["name"], listed.front().second);
    EXPECT_NEAR(found["nearest_object"]["distance_m"].get<double>(), listed.front().first, 1e-9);
    EXPECT_EQ(found["nearest_object"]["kind"], "wreck");
    EXPECT_EQ(found["nearest_object"]["depth_m"], 8);
    std::vector<std::string> names, expected;
    for (const json& object : found["objects"]) names.push_back(object["name"]);
    for (const auto& [away, name] : listed) {
      if (away <= 75) expected.push_back(name);
    }
    EXPECT_EQ(names, expected);
  }
}

// A wreck gets the reference to a mesh, which another program stores with the map. The wreck is the nearest one in the
// tree of the points; by its id the shape is read. ledger: S1-09 S1-20
TEST_F(MapObjects, APathReachesTheShapeOfTheNearestObject) {
  const ShapeReference hull{"shapes/hull.ply", 412.5, {1, -2, 3.5}, 2};
  std::string name, place;
  {
    ObjectStore store(map_ / "objects.sqlite");
    const MapObject wreck = store.find(store.with_any(kChartedObject)).at(7);
    name = wreck.name;
    store.put(wreck.id, "hull", {Time{}, ShapeReference{"shapes/older.ply", 1, {0, 0, 0}, 0}});
    store.put(wreck.id, "hull", {Time(seconds(1)), hull});
    const Vector2d beside = wreck.p_W.head<2>() + Vector2d(0.01, 0);
    place = fmt::format("{},{}", beside.x(), beside.y());
  }
  const json found = path({place, "--objects-within", "400"});
  EXPECT_EQ(found["nearest_object"]["name"], name);
  const json shape{{"file", hull.file}, {"volume_m3", 412.5}, {"holes", 2}, {"centroid_m", {1, -2, 3.5}}};
  EXPECT_EQ(found["nearest_object"]["shapes"], json::array({shape}));
  for (std::size_t i = 1; i < found["objects"].size(); ++i) EXPECT_TRUE(found["objects"][i]["shapes"].empty());
  const ProgramResult told = isobath::test::isobath({"path", map_, "--metres", place});
  EXPECT_THAT(told.out, testing::HasSubstr("shape: shapes/hull.ply, 412.5 m3, holes: 2\n"));
}

// ledger: S1-23
TEST_F(MapObjects, TheNearestLineIsFollowed) {
  for (const Vector2d& start : {Vector2d(3, 4), Vector2d(-150, 90), Vector2d(120, -160)}) {
    const auto away = [&](const PriorLine& line) {
      return (nearest_on_segment(line.points[0], line.points[1], start) - start).norm();
    };
    const auto& lines = priors_[0].lines;
    const auto nearest =
        std::min_element(lines.begin(), lines.end(), [&](const auto& a, const auto& b) { return away(a) < away(b); });
    const json course = path({fmt::format("{},{}", start.x(), start.y()), "--along", "nearest"});
    ASSERT_GE(course["way"].size(), 2u);
    double start_away = INFINITY;
    for (const json& p : course["way"]) {
      const Vector2d at(p["north_m"], p["east_m"]);
      EXPECT_LT((nearest_on_segment(nearest->points[0], nearest->points[1], at) - at).norm(), 0.01) << nearest->name;
      start_away = std::min(start_away, (at - start).norm());
    }
    EXPECT_NEAR(start_away, away(*nearest), 0.01) << "it begins at the foot point";
  }
}

// ledger: S1-25
TEST_F(MapObjects, APathExaminesTheObjectsNearItAndNoOther) {
  const json checked = path({"-20,-30", "40,10", "--around-objects", "5", "--half-width", "1"});
  const auto near = std::count_if(wrecks().begin(), wrecks().end(), [](const PriorPoint& wreck) {
    const Vector2d& p = wreck.north_east;
    return p.x() >= -26 && p.x() <= 46 && p.y() >= -36 && p.y() <= 16;
  });
  EXPECT_GT(near, 0);
  EXPECT_LT(near, 30) << "of 300";
  EXPECT_EQ(checked["obstacles_examined"], near);
}

// The defaults that stand where the paper gives no number, each of which is a setting; scenes mount sonars as they
// like. ledger: S1-E10
TEST(Defaults, OfConfidenceAndMarginAreThoseOfTheLedgerAndCanBeSet) {
  const ProgramResult told = isobath::test::isobath({"config"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const auto setting = [&](const std::string& section, const std::string& key) {
    const auto begin = told.out.find("\n[" + section + "]\n");
    const auto at = told.out.find("\n" + key + " = ", begin);
    EXPECT_LT(at, told.out.find("\n[", begin + 2)) << section << "." << key;
    return std::stod(told.out.substr(at + key.size() + 4));
  };
  EXPECT_EQ(setting("confidence", "base_prior"), 5);
  EXPECT_EQ(setting("confidence", "base_sensor"), 6);
  EXPECT_EQ(setting("confidence", "threshold"), 2);
  EXPECT_EQ(setting("evidence", "margin_m"), 0.5);
  EXPECT_EQ(setting("evidence", "margin_share"), 0.02);
  EXPECT_EQ(setting("evidence", "depth_weight"), 2) << "10 % of 20";
  EXPECT_EQ(setting("evidence", "obstacle_weight"), 1) << "5 % of 20";
  EXPECT_EQ(setting("evidence", "range_cap_m"), 50);
  EXPECT_EQ(setting("prefilter", "range_m"), 0.5);
  EXPECT_EQ(setting("prefilter", "position_m"), 1);
  EXPECT_EQ(setting("prefilter", "attitude_deg"), 3);
  EXPECT_EQ(setting("prefilter", "max_readings"), 4);
  const ProgramResult set =
      isobath::test::isobath({"config", "--set", "confidence.base_prior=4", "--set", "evidence.margin_m=0.75"});
  EXPECT_THAT(set.out, testing::HasSubstr("base_prior = 4"));
  EXPECT_THAT(set.out, testing::HasSubstr("margin_m = 0.75"));
}

/// A boat that lies at one place of a chart of 5.3 m.
class WrongChart : public testing::Test {
 protected:
  struct Place {
    float depth_m, confidence;
  };
  /// The map after one more sounding: by row and column.
  std::vector<Place> after_sounding(int k, double depth_m) {
    const fs::path log = write(folder_ / fmt::format("boat{}.csv", k),
                               fmt::format("T,Lat,Lon,D\n{},52.34,13,{}\n", 1'700'000'000 + 3600 * k, depth_m));
    const ProgramResult mapped =
        isobath_run(log, folder_ / "out", {"--map", folder_ / "map",
                                           "--set", "input.csv_columns=time=T,latitude=Lat,longitude=Lon,depth=D",
                                           "--set", "input.csv_time=seconds",
                                           "--set", "prior.file=" + (folder_ / "chart.asc").string(),
                                           "--set", "prior.sign=down",
                                           "--set", "prior.datum_offset_m=[0]",
                                           "--set", "prior.sigma_m=0",
                                           "--set", "prior.sigma_share=0",
                                           "--set", "depth.range_weighting=false",
                                           "--set", "depth.quarantine=false"});
    EXPECT_EQ(mapped.exit_code, 0) << mapped.err;
    return exported();
  }
  std::vector<Place> exported() {
    const fs::path tif = folder_ / "map.tif";
    EXPECT_EQ(isobath::test::isobath({"convert", folder_ / "map", tif}).exit_code, 0);
    GDALAllRegister();
    const GDALDatasetUniquePtr data(GDALDataset::Open(tif.c_str()));
    columns_ = data->GetRasterXSize();
    const int rows = data->GetRasterYSize();
    std::vector<float> bands[2];
    for (int b = 0; b < 2; ++b) {
      bands[b].resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows));
      EXPECT_EQ(data->GetRasterBand(b + 1)->RasterIO(GF_Read, 0, 0, columns_, rows, bands[b].data(), columns_, rows,
                                                     GDT_Float32, 0, 0),
                CE_None);
    }
    std::vector<Place> places;
    for (std::size_t i = 0; i < bands[0].size(); ++i) places.push_back({bands[0][i], bands[1][i]});
    return places;
  }
  void SetUp() override {
    std::string chart = "ncols 40\nnrows 40\nxllcorner 12.9996\nyllcorner 52.3396\ncellsize 0.00002\nNODATA_value -9\n";
    for (int i = 0; i < 1600; ++i) chart += i % 40 == 39 ? "5.3\n" : "5.3 ";
    write(folder_ / "chart.asc", chart);
    write(folder_ / "chart.prj",
          R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],)"
          R"(UNIT["degree",0.0174532925199433]])");
  }
  const fs::path folder_ = scratch_folder();
  int columns_ = 0;
};

// The chart's confidence of 5 units falls by the 2 of a depth sonar, once; below the threshold of 2 the depth is
// replaced and the confidence is the sensor's base of 6. Only a square of pixels changes. ledger: S1-D03 S1-49 S1-54
TEST_F(WrongChart, FallsInConfidenceUntilTheSoundingReplacesItOverASquare) {
  constexpr float kUnit = 0.05F, kCharted = 5.3F, kSounded = 3;
  struct Step {
    float depth_m;
    int confidence;
  };
  int k = 0;
  for (const Step& step : {Step{kCharted, 3}, Step{kSounded, 6}, Step{kSounded, 8}}) {
    const std::vector<Place> map = after_sounding(k++, kSounded);
    int changed = 0, first_row = 1 << 20, last_row = -1, first_column = 1 << 20, last_column = -1;
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (std::isnan(map[i].depth_m)) continue;
      if (map[i].depth_m == kCharted && std::abs(map[i].confidence - 5 * kUnit) < 1e-6) continue;
      ++changed;
      const int row = static_cast<int>(i) / columns_, column = static_cast<int>(i) % columns_;
      first_row = std::min(first_row, row), last_row = std::max(last_row, row);
      first_column = std::min(first_column, column), last_column = std::max(last_column, column);
      ASSERT_FLOAT_EQ(map[i].depth_m, step.depth_m) << "sounding " << k;
      ASSERT_NEAR(map[i].confidence, static_cast<float>(step.confidence) * kUnit, 1e-6) << "sounding " << k;
    }
    const int side = last_row - first_row + 1;
    EXPECT_GE(side, 3) << "not one pixel alone";
    EXPECT_EQ(side, last_column - first_column + 1) << "a square";
    EXPECT_EQ(side % 2, 1) << "round the pixel below the boat";
    EXPECT_EQ(changed, side * side) << "all of the square";
  }
}

// One boat's line north over 9 m, with a sounding every half metre, onto a shelf of 4 m; up to 10 m before the shelf
// one sounding in twenty is false. Soundings that disagree with their neighbours wait for support. Fewer false shoals
// stand, and the shelf begins at the same row; it waits for its third sounding. ledger: S1-72
TEST_F(WrongChart, AgreementWithNeighboursLeavesFewerFalseShoalsAndTheSameShelf) {
  Random random(11);
  std::string text = "T,Lat,Lon,D\n";
  for (int i = 0; i < 400; ++i) {
    const double depth = random.uniform(0, 1) < 0.05 && i < 300 ? random.uniform(1, 7) : i < 320 ? 9 : 4;
    text += fmt::format("{},{:.8f},13,{:.3f}\n", 1'700'000'000 + i, 52.34 + 0.0000045 * i, depth);
  }
  const fs::path log = write(folder_ / "line.csv", text);
  int false_rows[2] = {0, 0}, shelf_rows[2] = {0, 0};
  for (const bool held : {false, true}) {
    fs::remove_all(folder_ / "map");
    const ProgramResult mapped = isobath_run(
        log, folder_ / "out",
        {"--map", folder_ / "map", "--set", "input.csv_columns=time=T,latitude=Lat,longitude=Lon,depth=D", "--set",
         "input.csv_time=seconds", "--set", held ? "depth.quarantine=true" : "depth.quarantine=false"});
    ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
    const std::vector<Place> map = exported();
    const int rows = static_cast<int>(map.size()) / columns_;
    const auto shallow = [&](int row) {
      const auto first = map.begin() + static_cast<std::ptrdiff_t>(row) * columns_;
      return std::any_of(first, first + columns_, [](const Place& p) { return p.depth_m < 7.5F; });
    };
    int row = 0;  // from the north: first the shelf
    for (; row < rows && shallow(row); ++row) ++shelf_rows[held];
    for (; row < rows; ++row) false_rows[held] += shallow(row) ? 1 : 0;
  }
  EXPECT_GT(false_rows[false], 10);
  EXPECT_LT(false_rows[true], false_rows[false] / 5);
  EXPECT_GT(shelf_rows[false], 70) << "80 soundings 0.5 m apart";
  EXPECT_EQ(shelf_rows[true], shelf_rows[false]);
}

}  // namespace
}  // namespace isobath::map_objects

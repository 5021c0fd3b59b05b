// What a run writes, as other programs and people read it.
#include <gdal_priv.h>
#include <isobath/geometry/geodesy.hpp>
#include <numeric>
#include <ogr_spatialref.h>
#include <tests/app/logs.hpp>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
namespace fs = std::filesystem;
using namespace test;
using testing::HasSubstr, testing::Not;

constexpr double kHeading = 30;  // of the vehicle in these runs, degrees
constexpr GeoPoint kPlace{47.5, 8.5};

struct Run {
  fs::path folder;
  ProgramResult result;
  nlohmann::json printed;
  [[nodiscard]] fs::path operator/(const std::string& name) const { return folder / "out" / name; }
};

/// A run on the wall with a pose track, once for all tests: they only read.
const Run& posed_run() {
  static const Run kRun = [] {
    Run run{fs::current_path() / "scratch" / ("Outputs-" + std::to_string(getpid())), {}, {}};
    fs::create_directories(run.folder);
    const fs::path log = write(run.folder / "wall.csv", wall_csv(200));
    const fs::path poses = write(run.folder / "poses.csv", pose_csv(25, kHeading));
    run.result = isobath_run(log, run.folder / "out", {"--set", "input.navigation=" + poses.string()});
    run.printed = nlohmann::json::parse(run.result.out, nullptr, false);
    return run;
  }();
  return kRun;
}

struct RemoveTheRun : testing::Environment {
  void TearDown() override { fs::remove_all(fs::current_path() / "scratch" / ("Outputs-" + std::to_string(getpid()))); }
};
const auto* const kRemoval = testing::AddGlobalTestEnvironment(new RemoveTheRun);

TEST(Outputs, JsonIsOneObjectAndEveryFileThatItNamesIsThere) {
  EXPECT_EQ(posed_run().result.exit_code, 0);
  EXPECT_EQ(posed_run().result.err, "") << "no progress in a pipe";
  const auto& json = posed_run().printed;
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["counts"]["pings"], 200);
  EXPECT_EQ(json["counts"]["navigation"], 25);
  EXPECT_EQ(json["counts"]["scans"], 4);
  EXPECT_TRUE(json["rejected"].empty());
  EXPECT_GT(json["rates"]["pings_per_s"], 0);
  EXPECT_NEAR(json["rates"]["log_s"], 24, 1e-9);
  std::set<std::string> named;
  for (const std::string file : json["files"]) {
    EXPECT_TRUE(fs::is_regular_file(file) && fs::file_size(file) > 0) << file;
    named.insert(fs::path(file).filename().string());
  }
  std::set<std::string> there;
  for (const auto& [name, bytes] : files_of(posed_run().folder / "out")) there.insert(name);
  EXPECT_EQ(named, there);
  EXPECT_THAT(there, testing::IsSupersetOf({"obstacles.json", "scans.json", "obstacles.geojson", "occupancy.tif",
                                            "occupancy.png", "sonar.png", "detections.png", "configuration.toml",
                                            "report.html", "manifest.json"}));
}

/// Width and height in the header of a PNG.
std::string size_of_png(const std::string& bytes) { return bytes.substr(16, 8); }

// The raw scan, the grid and the obstacles lie side by side at one scale.
// ledger: S6-61
TEST(Outputs, ShowTheScanTheGridAndTheObstaclesSideBySide) {
  const std::string scan = content_of(posed_run() / "sonar.png"), grid = content_of(posed_run() / "occupancy.png"),
                    obstacles = content_of(posed_run() / "detections.png");
  EXPECT_EQ(size_of_png(scan), size_of_png(grid));
  EXPECT_EQ(size_of_png(scan), size_of_png(obstacles));
  const std::string page = content_of(posed_run() / "report.html");
  const std::size_t row = page.find("<div class=\"row\">");
  ASSERT_NE(row, std::string::npos);
  const std::string panels = page.substr(row, page.find("</div>", row) - row);
  for (const char* caption : {"The echoes of the last scan", "Occupancy of the water", "Obstacles over"}) {
    EXPECT_THAT(panels, HasSubstr(caption));
  }
}

TEST(Outputs, WithoutJsonAFewLinesForAPerson) {
  const fs::path folder = scratch_folder();
  const auto result =
      isobath::test::isobath({"run", write(folder / "wall.csv", wall_csv(150)), "--out", folder / "out"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, testing::ContainsRegex("^1 obstacle at the end of 3 scans\n"))
      << "the outcome first; a wall all round is one obstacle";
  EXPECT_THAT(result.out, HasSubstr("  extended  "));
  EXPECT_THAT(result.out, HasSubstr("received 150 pings in"));
  EXPECT_THAT(result.out, HasSubstr("report.html"));
  EXPECT_THAT(result.out, testing::Not(HasSubstr("of work"))) << "times only where they are asked for";
}

// ledger: S6-28 S6-29
TEST(Outputs, ObstaclesSayWhereHowFarAndHowSure) {
  const auto json = json_of(posed_run() / "obstacles.json");
  EXPECT_THAT(json["frame"].get<std::string>(), testing::AllOf(HasSubstr("x forward"), HasSubstr("y starboard")));
  EXPECT_NEAR(json["heading_deg"], kHeading, 1e-6);
  ASSERT_GT(json["obstacles"].size(), 5u) << "a wall all round";
  for (const auto& o : json["obstacles"]) {
    EXPECT_EQ(o["number"], json["obstacles"][0]["number"]) << "pieces of one wall";
    EXPECT_EQ(o["kind"], "extended");
    EXPECT_NEAR(o["extent_m"].get<double>(), 2 * kWall, 2) << "across";
    const double bearing = o["bearing_deg"], range = o["range_m"], existence = o["existence"];
    EXPECT_GE(bearing, 0);
    EXPECT_LT(bearing, 360);
    EXPECT_NEAR(range, kWall, 0.3);
    EXPECT_GT(existence, 0.5);
    EXPECT_LE(existence, 1);
    EXPECT_TRUE(o["behind"].is_boolean());
    ASSERT_GE(o["outline_m"].size(), 3u);
    double nearest = 1e9;
    for (const auto& corner : o["outline_m"]) {
      ASSERT_EQ(corner.size(), 2u);
      nearest = std::min(nearest, std::hypot(corner[0].get<double>(), corner[1].get<double>()));
    }
    EXPECT_LE(range, nearest + 1e-6) << "no corner is nearer than the nearest point";
  }
}

TEST(Outputs, LastScanIsWhatTheObstaclesAre) {
  const auto scans = json_of(posed_run() / "scans.json")["scans"];
  ASSERT_EQ(scans.size(), 4u);
  for (std::size_t i = 0; i < scans.size(); ++i) EXPECT_EQ(scans[i]["scan"], i + 1);
  EXPECT_EQ(scans.back()["obstacles"], json_of(posed_run() / "obstacles.json")["obstacles"]);
}

TEST(Outputs, ManifestSaysWhatWasRun) {
  const auto manifest = json_of(posed_run() / "manifest.json");
  EXPECT_EQ(manifest["format"], "scan CSV");
  EXPECT_EQ(manifest["bytes"], wall_csv(200).size());
  EXPECT_EQ(manifest["counts"]["bytes_skipped"], 0);
  EXPECT_EQ(manifest["problem"], "");
  EXPECT_EQ(manifest["counts"]["pings"], 200);
  EXPECT_THAT(isobath::test::isobath({"--version"}).out, HasSubstr(manifest["version"].get<std::string>()));
}

TEST(Outputs, ConfigurationInForceReadsBackUnchanged) {
  const fs::path file = posed_run() / "configuration.toml";
  const auto again = isobath::test::isobath({"config", "--config", file});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, content_of(file));
}

// The wall is north, east, south and west of the vehicle; the raster lies turned with its heading.
TEST(Outputs, OccupancyIsARasterWhereTheWallStands) {
  GDALAllRegister();
  const auto data = GDALDatasetUniquePtr(GDALDataset::Open((posed_run() / "occupancy.tif").c_str()));
  ASSERT_TRUE(data);
  double t[6];
  ASSERT_EQ(data->GetGeoTransform(t), CE_None);
  const double cell = std::hypot(t[1], t[4]);
  EXPECT_NEAR(cell * data->GetRasterXSize(), 2 * 1.05 * kBins * kBin, 4 * cell) << "the sonar's range on all sides";
  ASSERT_TRUE(data->GetSpatialRef());
  EXPECT_NEAR(data->GetSpatialRef()->GetProjParm("latitude_of_center", -1), kPlace.latitude_deg, 1e-9);

  std::vector<float> p(static_cast<std::size_t>(data->GetRasterXSize()) * data->GetRasterYSize());
  ASSERT_EQ(
      data->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, data->GetRasterXSize(), data->GetRasterYSize(), p.data(),
                                       data->GetRasterXSize(), data->GetRasterYSize(), GDT_Float32, 0, 0, nullptr),
      CE_None);
  double inverse[6];
  ASSERT_TRUE(GDALInvGeoTransform(t, inverse));
  const auto at = [&](double east, double north) {
    const auto column = static_cast<int>(inverse[0] + inverse[1] * east + inverse[2] * north);
    const auto row = static_cast<int>(inverse[3] + inverse[4] * east + inverse[5] * north);
    return p[static_cast<std::size_t>(row) * data->GetRasterXSize() + column];
  };
  for (int i = 0; i < kTurn; ++i) {  // along the beams
    const double direction = (kHeading + i * 360.0 / kTurn) * M_PI / 180;
    float most = 0;
    for (double r = kWall - 0.15; r < kWall + 0.2; r += 0.03) {
      const float value = at(r * std::sin(direction), r * std::cos(direction));
      if (value > most) most = value;
    }
    EXPECT_GT(most, 0.3) << "beam " << i;
    EXPECT_LT(at(1.5 * std::sin(direction), 1.5 * std::cos(direction)), 0.01) << "water, beam " << i;
  }
  EXPECT_TRUE(std::isnan(p[0])) << "nobody looked into the corner";
}

TEST(Outputs, PositionsOnTheGlobeGiveGeoJson) {
  const auto json = json_of(posed_run() / "obstacles.geojson");
  EXPECT_EQ(json["type"], "FeatureCollection");
  EXPECT_EQ(json["features"].size(), json_of(posed_run() / "obstacles.json")["obstacles"].size());
  for (const auto& feature : json["features"]) {
    const auto& ring = feature["geometry"]["coordinates"][0];
    EXPECT_EQ(ring.front(), ring.back());
    for (const auto& corner : ring) {
      const Eigen::Vector2d p = LocalPlane(kPlace).to_plane({corner[1], corner[0]});
      EXPECT_NEAR(p.norm(), kWall, 0.5) << "longitude before latitude";
    }
  }
}

TEST(Outputs, WithoutPositionsThereIsNoGeoJsonNotEvenOfAnEarlierRun) {
  const fs::path folder = scratch_folder();
  write(folder / "obstacles.geojson", "of an earlier run");
  EXPECT_EQ(isobath_run(write(folder / "wall.csv", wall_csv(100)), folder).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder / "obstacles.geojson"));
  EXPECT_TRUE(fs::exists(folder / "wall.csv")) << "other files in the folder are left alone";
}

TEST(Outputs, ReportStandsAlone) {
  std::string page = content_of(posed_run() / "report.html");
  // What the page in it asks for, a browser says (tests/page/report.test.mjs).
  const std::string inside = " srcdoc=\"";
  if (const std::size_t begin = page.find(inside); begin != std::string::npos) {
    page.erase(begin, page.find('"', begin + inside.size()) + 1 - begin);
  }
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<link")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  const std::string pictures = "src=\"data:image/png;base64,";
  int inline_pictures = 0;
  for (std::size_t at = page.find("src="); at != std::string::npos; at = page.find("src=", at + 1)) {
    EXPECT_EQ(page.substr(at, pictures.size()), pictures);
    ++inline_pictures;
  }
  EXPECT_EQ(inline_pictures, 6) << "obstacles, occupancy, echoes, track, spherical grid from above and aside";
  EXPECT_THAT(page, Not(HasSubstr("href=")));
}

TEST(Outputs, ReportNamesEveryReasonOfRejectionWithItsCount) {
  const fs::path folder = scratch_folder();
  auto lines = wall_csv_lines(200);
  std::swap(lines[100], lines[105]);  // five pings go back in time
  std::string poses = pose_csv(25);
  poses.replace(poses.find("\n3,47.5"), 7, "\n3,nan");
  const ProgramResult result =
      isobath_run(write(folder / "wrong.csv", joined(lines)), folder / "out",
                  {"--set", "input.navigation=" + write(folder / "poses.csv", poses).string()});
  const auto rejected = nlohmann::json::parse(result.out)["rejected"];
  EXPECT_GE(rejected.size(), 2u);
  const std::string page = content_of(folder / "out" / "report.html");
  for (const auto& [reason, count] : rejected.items()) {
    EXPECT_THAT(page, HasSubstr("<td>" + reason + "</td><td>" + std::to_string(count.get<int>()) + "</td>"));
  }
  EXPECT_EQ(rejected, json_of(folder / "out" / "manifest.json")["rejected"]);
}

}  // namespace
}  // namespace isobath

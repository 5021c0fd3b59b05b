// Priors: surveys, charts and soundings as pixels of the map, and what is refused.
#include <cmath>
#include <cpl_conv.h>
#include <fstream>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/charts/read_prior.hpp>
#include <isobath/io/gdal/geotiff.hpp>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>
#include <tests/support/data.hpp>

namespace isobath::read_prior_test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using testing::HasSubstr;

const GeoOrigin kOrigin{52.339, 12.9955};

/// Depths of a file are those of the map, and grow down.
PriorConfig plain() {
  PriorConfig config;
  config.sign = PriorSign::kDown;
  config.datum_offset_m = {0};
  return config;
}

PriorWindow window(double north, double west, double pixel_m, int columns, int rows) {
  return {{{north, west}, pixel_m}, columns, rows};
}

/// What the error says; empty where there is none.
std::string refusal(const fs::path& file, const PriorConfig& config, const PriorWindow& wanted,
                    const GeoOrigin& origin = kOrigin) {
  try {
    (void)read_prior(file, config, LocalPlane(origin), wanted);
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << "one line";
    EXPECT_THAT(e.what(), HasSubstr(file.filename().string()));
    return e.what();
  }
  return {};
}

struct RasterFile {
  int columns = 40, rows = 30, epsg = 32633;
  double transform[6] = {363200, 10, 0, 5800785, 0, -10};
  std::vector<float> values;
  std::vector<float> sigma;  ///< a second band, if any
  std::optional<double> no_data;
  std::string driver = "GTiff";

  template <class Depth>
  void fill(const Depth& depth) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        const double x = transform[0] + (c + 0.5) * transform[1] + (r + 0.5) * transform[2];
        const double y = transform[3] + (c + 0.5) * transform[4] + (r + 0.5) * transform[5];
        values.push_back(static_cast<float>(depth(x, y)));
      }
    }
  }
  void write(const fs::path& file) const {
    GDALAllRegister();
    GDALDataset* made = GetGDALDriverManager()->GetDriverByName("MEM")->Create("", columns, rows, sigma.empty() ? 1 : 2,
                                                                               GDT_Float32, nullptr);
    double t[6];
    std::copy(transform, transform + 6, t);
    made->SetGeoTransform(t);
    OGRSpatialReference system;
    if (epsg > 0) {
      system.importFromEPSG(epsg);
      system.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      made->SetSpatialRef(&system);
    }
    const auto put = [&](int band, const std::vector<float>& cells, const char* name) {
      GDALRasterBand* b = made->GetRasterBand(band);
      b->SetDescription(name);
      if (no_data) b->SetNoDataValue(*no_data);
      ASSERT_EQ(b->RasterIO(GF_Write, 0, 0, columns, rows, const_cast<float*>(cells.data()), columns, rows, GDT_Float32,
                            0, 0, nullptr),
                CE_None);
    };
    put(1, values, "depth");
    if (!sigma.empty()) put(2, sigma, "uncertainty");
    GDALClose(GetGDALDriverManager()
                  ->GetDriverByName(driver.c_str())
                  ->CreateCopy(file.c_str(), made, 0, nullptr, nullptr, nullptr));
    GDALClose(made);
  }
};

/// The same way to the coordinates of the file, by another library's axes.
Vector2d coordinates(int epsg, const GeoOrigin& origin, const Vector2d& north_east) {
  OGRSpatialReference globe, system;
  globe.SetWellKnownGeogCS("WGS84");
  system.importFromEPSG(epsg);
  globe.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  system.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const GeoPoint p = LocalPlane(origin).to_geo(north_east);
  double x = p.longitude_deg, y = p.latitude_deg;
  OGRCoordinateTransformation* way = OGRCreateCoordinateTransformation(&globe, &system);
  EXPECT_TRUE(way->Transform(1, &x, &y));
  OGRCoordinateTransformation::DestroyCT(way);
  return {x, y};
}

const auto sloping = [](double x, double y) { return 20 + 0.02 * (x - 363400) - 0.03 * (y - 5800635); };

/// A plane in the file's coordinates comes back where it belongs.
void expect_sloping(const Prior& prior, const GeoOrigin& origin, int epsg, double tolerance) {
  int known = 0;
  const PriorWindow& w = prior.raster.window;
  for (int row = 0; row < w.rows; row += 3) {
    for (int column = 0; column < w.columns; column += 3) {
      const auto depth = static_cast<double>(prior.raster.depth_m[prior.raster.index({column, row})]);
      if (!std::isfinite(depth)) continue;
      const Vector2d at = coordinates(epsg, origin, w.grid.centre({column, row}));
      ASSERT_NEAR(depth, sloping(at.x(), at.y()), tolerance);
      ++known;
    }
  }
  EXPECT_GT(known, 100);
}

// Bilinear interpolation reproduces a plane, so any error of place would show: 1 m of it is 3 cm of depth.
// ledger: S1-13
TEST(Prior, PutsARasterWhereItBelongs) {
  RasterFile raster;
  raster.fill(sloping);
  const fs::path file = test::scratch_folder() / "utm.tif";
  raster.write(file);
  const Prior prior = read_prior(file, plain(), LocalPlane(kOrigin), window(100, -100, 3, 90, 80));
  EXPECT_EQ(prior.format, "GeoTIFF");
  EXPECT_GT(prior.read.at("cells"), 300u);
  // at the edge half a cell has no neighbour to interpolate to: 5 m each way along slopes of 2 and 3 %
  expect_sloping(prior, kOrigin, 32633, 0.26);
  const Prior inner = read_prior(file, plain(), LocalPlane(kOrigin), window(60, -60, 3, 40, 40));
  expect_sloping(inner, kOrigin, 32633, 2e-4);
  const Prior whole = read_prior(file, plain(), LocalPlane(kOrigin), window(0, 0, 5, 0, 0));
  EXPECT_EQ(whole.read.at("cells"), 1200u);
  EXPECT_NEAR(whole.raster.window.columns * whole.raster.window.rows * 25.0, 400 * 300, 12000);
}

TEST(Prior, FollowsARotatedRaster) {
  RasterFile raster;
  const double c = 10 * std::cos(0.5), s = 10 * std::sin(0.5);
  const double turned[] = {363300, c, s, 5800835, s, -c};
  std::copy(turned, turned + 6, raster.transform);
  raster.fill(sloping);
  const fs::path file = test::scratch_folder() / "turned.tif";
  raster.write(file);
  const Vector2d middle = [&] {  // the plane's place of a cell in the middle
    OGRSpatialReference globe, system;
    globe.SetWellKnownGeogCS("WGS84");
    system.importFromEPSG(32633);
    globe.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    system.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    double x = 363300 + 20 * c + 15 * s, y = 5800835 + 20 * s - 15 * c;
    OGRCoordinateTransformation* way = OGRCreateCoordinateTransformation(&system, &globe);
    EXPECT_TRUE(way->Transform(1, &x, &y));
    OGRCoordinateTransformation::DestroyCT(way);
    return LocalPlane(kOrigin).to_plane({y, x});
  }();
  const Prior prior =
      read_prior(file, plain(), LocalPlane(kOrigin), window(middle.x() + 60, middle.y() - 60, 3, 40, 40));
  EXPECT_THAT(prior.raster.depth_m, testing::Each(testing::Truly([](float d) { return std::isfinite(d); })));
  expect_sloping(prior, kOrigin, 32633, 2e-4);
}

// Longitudes from 0 to 360, heights in feet above the datum, east of the antimeridian.
TEST(Prior, ReadsDegreesAndFeetAndHeights) {
  const GeoOrigin origin{-36, -179.95};
  RasterFile raster;
  raster.epsg = 4326;
  const double degrees[] = {180.0, 0.0025, 0, -35.9625, 0, -0.0025};
  std::copy(degrees, degrees + 6, raster.transform);
  const auto depth = [](double lon, double lat) { return 100 + 300 * (lon - 180.05) - 200 * (lat + 36); };
  raster.fill([&](double x, double y) { return -depth(x, y) / 0.3048; });
  const fs::path file = test::scratch_folder() / "degrees.tif";
  raster.write(file);
  PriorConfig config = plain();
  config.sign = PriorSign::kUp;
  config.unit_m = 0.3048;
  const Prior prior = read_prior(file, config, LocalPlane(origin), window(2000, -2000, 100, 40, 40));
  for (int i = 0; i < 40; ++i) {
    const GeoPoint p = LocalPlane(origin).to_geo(prior.raster.window.grid.centre({i, 39 - i}));
    const auto found = static_cast<double>(prior.raster.depth_m[prior.raster.index({i, 39 - i})]);
    ASSERT_NEAR(found, depth(p.longitude_deg + 360, p.latitude_deg), 2e-3);
  }
}

// In W's own plane the cells that lie in a pixel can be told by hand.
TEST(Prior, TakesMeanOrShoalestOfTheCellsInAPixel) {
  const fs::path file = test::scratch_folder() / "fine.tif";
  Random random(3);
  std::vector<float> depth, sigma;
  for (int i = 0; i < 40 * 40; ++i) {
    depth.push_back(static_cast<float>(random.uniform(5, 15)));
    sigma.push_back(static_cast<float>(random.uniform(0.1, 0.3)));
  }
  depth[0] = NAN;
  const RasterBand bands[] = {{{"depth", "m"}, depth}, {{"sigma", "m"}, sigma}};
  write_geotiff(file, {40, 40, 0.25, {0, 0}, {}, {}}, bands);
  for (const Merge how : {Merge::kMean, Merge::kShoalest}) {
    PriorConfig config = plain();
    config.pixels = how;
    const Prior prior = read_prior(file, config, LocalPlane(kOrigin), window(0, 0, 1, 10, 10));
    for (int row = 0; row < 10; ++row) {
      for (int column = 0; column < 10; ++column) {
        double sum = 0, squares = 0, variance = 0, n = 0, least = 1e9, sigma_of_least = 0;
        for (int k = 0; k < 16; ++k) {
          const std::size_t i = static_cast<std::size_t>((row * 4 + k / 4) * 40 + column * 4 + k % 4);
          const auto d = static_cast<double>(depth[i]), s = static_cast<double>(sigma[i]);
          if (std::isnan(d)) continue;
          ++n;
          sum += d;
          squares += d * d;
          variance += s * s;
          if (d < least) {
            least = d;
            sigma_of_least = s;
          }
        }
        const double mean = sum / n;
        const std::size_t i = prior.raster.index({column, row});
        const auto d = static_cast<double>(prior.raster.depth_m[i]), s = static_cast<double>(prior.raster.sigma_m[i]);
        ASSERT_NEAR(d, how == Merge::kMean ? mean : least, 1e-5);
        ASSERT_NEAR(s, how == Merge::kMean ? std::sqrt(variance / n + squares / n - mean * mean) : sigma_of_least,
                    1e-4);
      }
    }
    EXPECT_EQ(prior.read.at("cells"), 1599u);
    EXPECT_EQ(prior.left_out.at("cells without data"), 1u);
  }
}

TEST(Prior, TakesTheShoalestOfFourWhereCellsAreCoarse) {
  const fs::path file = test::scratch_folder() / "coarse.tif";
  const std::vector<float> heights = {-10, -12, -11, -5};
  write_geotiff(file, {2, 2, 10, {0, 0}, {}, {}}, {"height", "m"}, heights);
  PriorConfig config = plain();
  config.sign = PriorSign::kUp;
  config.pixels = Merge::kShoalest;
  const Prior shoal = read_prior(file, config, LocalPlane(kOrigin), window(-8, 8, 1, 4, 4));
  EXPECT_THAT(shoal.raster.depth_m, testing::Each(5.0f));
  config.pixels = Merge::kMean;
  const Prior mean = read_prior(file, config, LocalPlane(kOrigin), window(-9.5, 9.5, 1, 1, 1));
  EXPECT_FLOAT_EQ(mean.raster.depth_m[0], 9.5f);  // the middle of the four
  EXPECT_FLOAT_EQ(mean.raster.sigma_m[0], static_cast<float>(0.5 + 0.01 * 9.5)) << "the file says none";
}

TEST(Prior, LeavesOutWhatMeansNothing) {
  RasterFile raster;
  raster.fill(sloping);
  const float marks[] = {-9999, -32767, 1e6f, 1e30f, 9.96921e36f, NAN, 0, 77, 9000};
  for (std::size_t i = 0; i < std::size(marks); ++i) raster.values[100 + i] = marks[i];
  const fs::path file = test::scratch_folder() / "holes.tif";
  raster.write(file);
  PriorConfig config = plain();
  config.no_data = {77};
  config.max_depth_m = 100;
  const Prior prior = read_prior(file, config, LocalPlane(kOrigin), window(0, 0, 10, 0, 0));
  EXPECT_EQ(prior.left_out.at("cells without data"), 7u);
  EXPECT_EQ(prior.read.at("cells"), 1193u) << "0 is a depth unless it is said to be none";
  EXPECT_GT(prior.left_out.at("pixels of no plausible depth"), 0u);
  for (const float d : prior.raster.depth_m) ASSERT_FALSE(d > 40) << d;
  config.no_data = {77, 0};
  EXPECT_EQ(read_prior(file, config, LocalPlane(kOrigin), window(0, 0, 10, 0, 0)).left_out.at("cells without data"),
            8u);
}

TEST(Prior, ReadsTheSameFromEveryRasterFormat) {
  RasterFile raster;
  raster.no_data = -5000;
  raster.fill(sloping);
  raster.values[700] = -5000;
  const fs::path folder = test::scratch_folder();
  const PriorWindow wanted = window(60, -60, 4, 30, 30);
  std::vector<float> first;
  for (const auto& [driver, name] :
       {std::pair{"GTiff", "a.tif"}, {"AAIGrid", "a.asc"}, {"netCDF", "a.nc"}, {"GSBG", "a.grd"}, {"XYZ", "a.xyz"}}) {
    raster.driver = driver;
    raster.write(folder / name);
    PriorConfig config = plain();
    config.no_data = {-5000};
    config.epsg = 32633;
    const Prior prior = read_prior(folder / name, config, LocalPlane(kOrigin), wanted);
    if (first.empty()) first = prior.raster.depth_m;
    ASSERT_EQ(prior.raster.depth_m.size(), first.size());
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (std::isnan(first[i])) {
        ASSERT_TRUE(std::isnan(prior.raster.depth_m[i])) << name;
      } else {
        ASSERT_NEAR(prior.raster.depth_m[i], first[i], 1e-3) << name;
      }
    }
  }
}

TEST(Prior, ComesBackFromItsOwnExport) {
  const fs::path file = test::scratch_folder() / "prior.tif";
  Random random(5);
  std::vector<float> depth, sigma;
  for (int i = 0; i < 50 * 20; ++i) {
    depth.push_back(i % 7 ? static_cast<float>(random.uniform(1, 30)) : NAN);
    sigma.push_back(i % 7 ? static_cast<float>(random.uniform(0.1, 2)) : NAN);
  }
  const RasterBand bands[] = {{{"depth", "m"}, depth}, {{"sigma of depth", "m"}, sigma}};
  write_geotiff(file, {50, 20, 0.5, {30, -10}, {}, kOrigin}, bands);
  const Prior prior = read_prior(file, plain(), LocalPlane(kOrigin), window(30, -10, 0.5, 50, 20));
  for (std::size_t i = 0; i < depth.size(); ++i) {
    ASSERT_EQ(std::isnan(prior.raster.depth_m[i]), std::isnan(depth[i]));
    if (std::isnan(depth[i])) continue;
    // the projection and the plane part by less than a micrometre here; neighbours differ by up to 30 m in 0.5 m
    ASSERT_NEAR(prior.raster.depth_m[i], depth[i], 1e-3);
    ASSERT_NEAR(prior.raster.sigma_m[i], sigma[i], 1e-3);
  }
}

TEST(Prior, AddsTheOffsetOfTheDatumAndItsSigma) {
  RasterFile raster;
  raster.fill([](double, double) { return 12.0; });
  raster.sigma.assign(raster.values.size(), 0.3f);
  const fs::path file = test::scratch_folder() / "flat.tif";
  raster.write(file);
  PriorConfig config = plain();
  config.datum_offset_m = {1.5};
  config.datum_offset_sigma_m = 0.4;
  const Prior prior = read_prior(file, config, LocalPlane(kOrigin), window(60, -60, 4, 30, 30));
  EXPECT_FLOAT_EQ(prior.raster.depth_m[100], 13.5f);
  EXPECT_FLOAT_EQ(prior.raster.sigma_m[100], 0.5f);
}

TEST(Prior, NeverMixesDatums) {
  RasterFile raster;
  raster.fill(sloping);
  const fs::path file = test::scratch_folder() / "a.tif";
  raster.write(file);
  const PriorWindow wanted = window(60, -60, 4, 30, 30);
  PriorConfig config = plain();
  config.datum_offset_m = {};
  EXPECT_THAT(refusal(file, config, wanted), HasSubstr("datum of the depths is unknown"));
  config.datum = "LAT";
  EXPECT_THAT(refusal(file, config, wanted),
              HasSubstr("depths are below LAT, those of the map are below the water surface"));
  config.map_datum = "MSL";
  EXPECT_THAT(refusal(file, config, wanted), HasSubstr("depths are below LAT, those of the map are below MSL"));
  config.map_datum = "lat";
  EXPECT_EQ(refusal(file, config, wanted), "");
}

TEST(Prior, RefusesTheWrongSign) {
  RasterFile raster;
  raster.fill([](double x, double y) { return -sloping(x, y); });
  const fs::path file = test::scratch_folder() / "heights.tif";
  raster.write(file);
  const PriorWindow wanted = window(60, -60, 4, 30, 30);
  PriorConfig config = plain();
  EXPECT_THAT(refusal(file, config, wanted), HasSubstr("the numbers are not positive down"));
  config.sign = PriorSign::kAutomatic;
  EXPECT_THAT(refusal(file, config, wanted), HasSubstr("it is unknown whether the numbers are depths or heights"));
  config.sign = PriorSign::kUp;
  EXPECT_EQ(refusal(file, config, wanted), "");
}

TEST(Prior, RefusesRastersThatDoNotSayWhereTheyLie) {
  const fs::path folder = test::scratch_folder();
  const PriorWindow wanted = window(60, -60, 4, 30, 30);
  RasterFile nowhere;
  nowhere.epsg = 0;
  nowhere.fill(sloping);
  nowhere.write(folder / "nowhere.tif");
  EXPECT_THAT(refusal(folder / "nowhere.tif", plain(), wanted), HasSubstr("the coordinate system is unknown"));
  PriorConfig told = plain();
  told.epsg = 32633;
  EXPECT_EQ(refusal(folder / "nowhere.tif", told, wanted), "");
  told.epsg = 999998;
  EXPECT_THAT(refusal(folder / "nowhere.tif", told, wanted), HasSubstr("no coordinate system EPSG:999998"));

  RasterFile metres;  // that call themselves degrees
  metres.epsg = 4326;
  metres.fill(sloping);
  metres.write(folder / "metres.tif");
  EXPECT_THAT(refusal(folder / "metres.tif", plain(), wanted),
              HasSubstr("declares degrees, but its coordinates are out of range"));

  RasterFile degrees;  // that call themselves metres
  const double t[] = {12.99, 0.0002, 0, 52.342, 0, -0.0002};
  std::copy(t, t + 6, degrees.transform);
  degrees.fill([](double, double) { return 8.0; });
  degrees.write(folder / "degrees.tif");
  EXPECT_THAT(refusal(folder / "degrees.tif", plain(), wanted),
              HasSubstr("declares metres, but its coordinates look like degrees"));
  told.epsg = 4326;
  EXPECT_EQ(refusal(folder / "degrees.tif", told, wanted), "");

  RasterFile elsewhere;
  elsewhere.fill(sloping);
  elsewhere.write(folder / "elsewhere.tif");
  EXPECT_THAT(refusal(folder / "elsewhere.tif", plain(), wanted, {10, 100}), HasSubstr("does not reach the window"));
  EXPECT_THAT(refusal(folder / "elsewhere.tif", plain(), window(0, 0, 4, 0, 0), {10, 100}),
              HasSubstr("larger than a local plane"));
}

TEST(Prior, RefusesWhatIsTooMuch) {
  RasterFile raster;
  raster.fill(sloping);
  const fs::path file = test::scratch_folder() / "a.tif";
  raster.write(file);
  PriorConfig config = plain();
  config.max_cells = 500;
  EXPECT_THAT(refusal(file, config, window(200, -200, 20, 30, 30)), HasSubstr("the maximum is"));
  EXPECT_THAT(refusal(file, plain(), window(0, 0, 0.001, 0, 0)), HasSubstr("too many"));
}

// Cut anywhere, a file is refused or says what it lacks; a byte of zeros never passes for a depth.
TEST(Prior, RefusesFilesThatWereCutOff) {
  const fs::path folder = test::scratch_folder();
  RasterFile raster;
  raster.columns = raster.rows = 100;
  Random random(9);
  for (int i = 0; i < 100 * 100; ++i) raster.values.push_back(static_cast<float>(random.uniform(10, 20)));
  for (const auto& [driver, name] :
       {std::pair{"GTiff", "a.tif"}, {"AAIGrid", "a.asc"}, {"netCDF", "a.nc"}, {"GSBG", "a.grd"}}) {
    raster.driver = driver;
    raster.write(folder / name);
    PriorConfig config = plain();
    config.epsg = 32633;
    const auto bytes = read_whole_file(folder / name, 1 << 22);
    for (const double share : {0.0, 0.01, 0.3, 0.9, 0.995}) {
      const fs::path cut = folder / (std::string("cut_") + name);
      const auto left = static_cast<std::size_t>(share * static_cast<double>(bytes.size()));
      write_whole_file(cut, std::span(bytes).first(left));
      try {
        const Prior prior = read_prior(cut, config, LocalPlane(kOrigin), window(0, 0, 10, 0, 0));
        for (const float d : prior.raster.depth_m) ASSERT_FALSE(d < 10 || d > 20) << name << " " << share;
        ADD_FAILURE() << name << " cut to " << share << " was read without a word";
      } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      }
    }
  }
}

TEST(Prior, RefusesWhatIsNoPrior) {
  const fs::path folder = test::scratch_folder();
  write_whole_file(folder / "noise.tif", std::string_view("II*\0garbage", 11));
  write_whole_file(folder / "empty.000", std::string_view());
  const PriorWindow wanted = window(60, -60, 4, 30, 30);
  EXPECT_THAT(refusal(folder / "noise.tif", plain(), wanted), HasSubstr("not a readable survey, chart or outline"));
  EXPECT_THAT(refusal(folder / "empty.000", plain(), wanted), HasSubstr("not a readable survey, chart or outline"));
  EXPECT_THAT(refusal(folder / "absent.tif", plain(), wanted), HasSubstr("no such file"));
}

std::pair<double, double> depths(const PriorRaster& raster) {
  double low = 1e9, high = -1e9;
  for (const float d : raster.depth_m) {
    if (std::isnan(d)) continue;
    low = std::min(low, static_cast<double>(d));
    high = std::max(high, static_cast<double>(d));
  }
  return {low, high};
}

// Published: elevations -68.4 .. -36.2 m, uncertainty 0.06 .. 1.9 m, 179 x 179 cells.
TEST(Prior, ReadsASurveyOfNoaa) {
  ISOBATH_NEEDS_DATA(folder, "bag-noaa");
  PriorConfig config;
  const LocalPlane plane({48.15, -122.67});
  const fs::path file = folder / "F00788_SR_8m.bag";
  EXPECT_THAT(refusal(file, config, window(0, 0, 8, 0, 0), plane.origin()),
              HasSubstr("datum of the depths is unknown"));
  config.datum_offset_m = {0};
  const Prior prior = read_prior(file, config, plane, window(0, 0, 8, 0, 0));
  EXPECT_EQ(prior.format, "BAG");
  EXPECT_EQ(prior.read.at("cells") + prior.left_out.at("cells without data"), 179u * 179u);
  EXPECT_EQ(prior.details.at("depths"), "36.18 .. 68.44 m");
  EXPECT_NEAR(depths(prior.raster).first, 36.2, 0.05);
  EXPECT_NEAR(depths(prior.raster).second, 68.4, 0.05);
  for (const float s : prior.raster.sigma_m) ASSERT_FALSE(s < 0.06f || s > 1.95f);
  config.sign = PriorSign::kDown;
  EXPECT_THAT(refusal(file, config, window(0, 0, 8, 0, 0), plane.origin()), HasSubstr("are not positive down"));
}

// Published: elevations -52.96 .. -50.99 m, uncertainty 0.27 .. 0.66 m, 1707 x 1478 cells of 2 m.
TEST(Prior, ReadsALargeSurvey) {
  ISOBATH_NEEDS_DATA(folder, "bag-noaa");
  PriorConfig config;
  config.datum_offset_m = {0};
  const LocalPlane plane({65.3, -168.4});
  const fs::path file = folder / "JD211_public_Release_1-4_UTM.bag";
  const Prior whole = read_prior(file, config, plane, window(0, 0, 20, 0, 0));
  EXPECT_EQ(whole.read.at("cells") + whole.left_out.at("cells without data"), 1707u * 1478u);
  EXPECT_EQ(whole.details.at("depths"), "50.99 .. 52.96 m");
}

TEST(Prior, ReadsOnlyWhatLiesUnderTheWindow) {
  ISOBATH_NEEDS_DATA(folder, "bag-noaa");
  PriorConfig config;
  config.datum_offset_m = {0};
  const LocalPlane plane({65.3, -168.4});
  const fs::path file = folder / "JD211_public_Release_1-4_UTM.bag";
  const Vector2d middle = plane.to_plane({65.3063, -168.3925});  // within the survey
  const Prior part = read_prior(file, config, plane, window(middle.x() + 64, middle.y() - 64, 0.5, 256, 256));
  EXPECT_LT(part.read.at("cells"), 12000u);
  EXPECT_GT(part.read.at("cells"), 3000u);
  for (const float s : part.raster.sigma_m) ASSERT_FALSE(s < 0.26f || s > 0.67f);
}

const GeoOrigin kErie{41.6, -82.8};

PriorConfig of_chart() {
  PriorConfig config;
  config.datum_offset_m = {0};
  return config;
}

std::size_t count(const Prior& prior, PriorPointKind kind) {
  return static_cast<std::size_t>(
      std::count_if(prior.points.begin(), prior.points.end(), [kind](const auto& p) { return p.kind == kind; }));
}

// The counts are those that ogrinfo lists.
// ledger: S1-07 S1-22
TEST(Prior, ReadsAChartOfALake) {
  ISOBATH_NEEDS_DATA(folder, "enc-lake-erie");
  const fs::path file = folder / "US5OH10M.000";
  const Prior chart = read_prior(file, of_chart(), LocalPlane(kErie), window(0, 0, 1000, 0, 0));
  EXPECT_EQ(chart.datum, "MLLW");
  EXPECT_EQ(chart.details.at("scale"), "1:40000");
  EXPECT_EQ(chart.soundings.size(), 2298u);
  const std::map<std::string, std::uint64_t> listed = {{"DEPARE", 197}, {"DEPCNT", 201}, {"OBSTRN", 58}, {"UWTROC", 76},
                                                       {"WRECKS", 7},   {"SLCONS", 336}, {"PIPSOL", 3},  {"LNDARE", 66},
                                                       {"COALNE", 174}, {"DRGARE", 2},   {"PILPNT", 2},  {"SOUNDG", 9}};
  for (const auto& [type, number] : listed) EXPECT_EQ(chart.read.at(type), number) << type;
  EXPECT_TRUE(chart.left_out.empty()) << chart.left_out.begin()->first;
  EXPECT_EQ(count(chart, PriorPointKind::kWreck), 7u);
  EXPECT_EQ(count(chart, PriorPointKind::kRock), 76u);
  EXPECT_EQ(count(chart, PriorPointKind::kPile), 2u);
  // the wreck with a known top, at 82.9019336 W 41.4834254 N, least depth 0.1 m
  const Vector2d place = LocalPlane(kErie).to_plane({41.4834254, -82.9019336});
  const auto wreck = std::find_if(chart.points.begin(), chart.points.end(), [&](const PriorPoint& p) {
    return p.kind == PriorPointKind::kWreck && (p.north_east - place).norm() < 0.01;
  });
  ASSERT_NE(wreck, chart.points.end());
  EXPECT_DOUBLE_EQ(wreck->depth_m.value(), 0.1);
  EXPECT_EQ(wreck->attributes.at("WATLEV"), "3");
  int tops_unknown = 0;
  for (const PriorPoint& p : chart.points) tops_unknown += !p.depth_m && !p.clear_to_m;
  EXPECT_GT(tops_unknown, 0) << "a wreck whose depth nobody knows has none";
}

// Soundings that lie in a depth area of their own range come back near themselves, and every pixel within its area.
// ledger: S1-14
TEST(Prior, DrawsTheBottomOfAChart) {
  ISOBATH_NEEDS_DATA(folder, "enc-lake-erie");
  PriorConfig config = of_chart();
  config.datum_offset_m = {0.5};
  const LocalPlane plane(kErie);
  const Prior chart = read_prior(folder / "US5OH10M.000", config, plane, window(25000, 4000, 100, 100, 100));
  int near = 0, all = 0;
  for (const SurveyPoint& s : chart.soundings) {
    const Pixel p = chart.raster.window.grid.at(s.north_east);
    if (!PixelWindow{0, 0, 100, 100}.contains(p)) continue;
    const std::size_t i = chart.raster.index(p);
    const auto d = static_cast<double>(chart.raster.depth_m[i]), sigma = static_cast<double>(chart.raster.sigma_m[i]);
    ++all;
    near += std::abs(d - s.depth_m) < sigma;
  }
  EXPECT_GT(all, 100);
  EXPECT_GT(near, 0.9 * all);
  int land = 0, water = 0;
  for (std::size_t i = 0; i < chart.raster.depth_m.size(); ++i) {
    if (chart.raster.depth_m[i] == 0) ++land;
    if (chart.raster.depth_m[i] > 0) ++water;
    if (std::isfinite(chart.raster.depth_m[i])) {
      ASSERT_GT(chart.raster.sigma_m[i], 0);
    }
  }
  EXPECT_GT(land, 250) << "Kelleys Island and its neighbours";
  EXPECT_GT(water, 2500);
  EXPECT_LT(depths(chart.raster).second, 15.5);
}

/// Where each record of an ISO 8211 file starts: five digits say how long it is.
std::vector<std::size_t> records_of(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::size_t> starts;
  std::size_t at = 0;
  while (at + 5 < bytes.size()) {
    starts.push_back(at);
    at += std::stoul(std::string(bytes.begin() + static_cast<long>(at), bytes.begin() + static_cast<long>(at) + 5));
  }
  return starts;
}

// The objects of a chart stand at its end, one a record.
TEST(Prior, CountsTheObjectsThatAChartLacks) {
  ISOBATH_NEEDS_DATA(folder, "enc-lake-erie");
  auto bytes = read_whole_file(folder / "US5OH10M.000", 1 << 20);
  const auto records = records_of(bytes);
  bytes.resize(records[records.size() - 250]);
  const fs::path file = test::scratch_folder() / "LACKING.000";
  write_whole_file(file, bytes);
  const Prior chart = read_prior(file, of_chart(), LocalPlane(kErie), window(20000, 4000, 500, 20, 20));
  EXPECT_EQ(chart.left_out.at("objects that the chart header counts but that could not be read"), 250u);
}

TEST(Prior, ReadsADamagedChartInPartOrRefusesIt) {
  ISOBATH_NEEDS_DATA(folder, "enc-lake-erie");
  const fs::path scratch = test::scratch_folder();
  const auto bytes = read_whole_file(folder / "US5OH10M.000", 1 << 20);
  Random random(11);
  int refused = 0, in_part = 0, unnoticed = 0;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  for (const int flips : {1, 2, 4, 8, 64, 20000, 0}) {
    auto damaged = bytes;
    if (flips == 0) damaged.resize(damaged.size() / 2);
    for (int i = 0; i < flips; ++i) {
      damaged[random.index(damaged.size())] = static_cast<std::uint8_t>(random.index(256));
    }
    const fs::path file = scratch / "DAMAGED.000";
    write_whole_file(file, damaged);
    try {
      const Prior chart = read_prior(file, of_chart(), LocalPlane(kErie), window(20000, 4000, 1000, 10, 10));
      (chart.left_out.empty() ? unnoticed : in_part) += 1;  // a digit of a name tells nobody that it changed
      for (const float d : chart.raster.depth_m) ASSERT_FALSE(d < -20 || d > 12000);
    } catch (const Error& e) {
      const std::string says = e.what();
      EXPECT_TRUE(std::all_of(says.begin(), says.end(), [](char c) { return c >= ' ' && c <= '~'; })) << says;
      ++refused;
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
  EXPECT_GE(refused, 2);
  EXPECT_GE(in_part, 1);
  EXPECT_LE(unnoticed, 4);
}

TEST(Prior, ReadsTheGridOfAHarbour) {
  ISOBATH_NEEDS_DATA(folder, "harbour-leixoes");
  PriorConfig config;
  config.datum_offset_m = {0};
  const GeoOrigin origin{0.71881377 * 180 / M_PI, -0.15193827 * 180 / M_PI};
  const fs::path file = folder / "carte_mbp_3.txt";
  const Prior prior = read_prior(file, config, LocalPlane(origin), window(0, 0, 4, 0, 0));
  EXPECT_EQ(prior.read.at("soundings"), 37221u);
  EXPECT_TRUE(prior.left_out.empty());
  // the first line of cells: -39.773, -145.018, 6.172
  EXPECT_LT((prior.soundings[0].north_east - Vector2d(-39.773, -145.018)).norm(), 1e-6);
  EXPECT_DOUBLE_EQ(prior.soundings[0].depth_m, 6.172);
  // seen from an origin 100 m north the cells lie 100 m south
  const GeoOrigin north = LocalPlane(origin).to_geo({100, 0});
  const Prior moved = read_prior(file, config, LocalPlane(north), window(-100, -200, 5, 20, 20));
  EXPECT_LT((moved.soundings[0].north_east - Vector2d(-139.773, -145.018)).norm(), 0.01);
  // each cell lies within three sigma of the surface at its pixel, nearly always
  int near = 0;
  for (const SurveyPoint& s : prior.soundings) {
    const std::size_t i = prior.raster.index(prior.raster.window.grid.at(s.north_east));
    const double miss = std::abs(static_cast<double>(prior.raster.depth_m[i]) - s.depth_m);
    near += miss < 3 * static_cast<double>(prior.raster.sigma_m[i]) + 0.4;
  }
  EXPECT_GT(near, 0.95 * 37221);
}

TEST(Prior, ReadsShorePointsAndTheOutlineOfALake) {
  ISOBATH_NEEDS_DATA(folder, "lake-caputh-m9");
  PriorConfig config;
  config.datum_offset_m = {0};
  const fs::path points = folder / "all_edgepoints.csv";
  EXPECT_THAT(refusal(points, config, window(0, 0, 10, 0, 0)), HasSubstr("which are not degrees"));
  config.epsg = 32633;
  const Prior shore = read_prior(points, config, LocalPlane(kOrigin), window(0, 0, 10, 0, 0));
  const Vector2d first = coordinates(32633, kOrigin, shore.soundings[0].north_east);
  EXPECT_LT((first - Vector2d(363421.2578, 5801136.079)).norm(), 1e-3);
  EXPECT_DOUBLE_EQ(shore.soundings[0].depth_m, 0.52) << "of Depth, not of Z";
  config.epsg = 0;
  config.datum_offset_m = {};  // a shore is the water's own
  const Prior outline = read_prior(folder / "waterbody.shp", config, LocalPlane(kOrigin), window(0, 0, 5, 0, 0));
  ASSERT_EQ(outline.areas.size(), 1u);
  EXPECT_EQ(outline.areas[0].kind, PriorAreaKind::kWater);
  std::size_t water = 0;
  for (const float d : outline.raster.depth_m) water += std::isnan(d);
  EXPECT_NEAR(static_cast<double>(water) * 25, std::abs(area(outline.areas[0].rings[0])), 2500);
  int dry = 0;  // shore points lie on the outline: 20 m farther from the middle of the lake all is land
  for (const SurveyPoint& s : shore.soundings) {
    const Vector2d p = s.north_east * (1 + 40 / s.north_east.norm());
    const Pixel at = outline.raster.window.grid.at(p);
    const PriorWindow& w = outline.raster.window;
    dry += !PixelWindow{0, 0, w.columns, w.rows}.contains(at) || outline.raster.depth_m[outline.raster.index(at)] == 0;
  }
  EXPECT_GT(dry, 0.7 * static_cast<double>(shore.soundings.size()));
}

TEST(Prior, ReadsTextInAnyOrderOfColumns) {
  const fs::path folder = test::scratch_folder();
  Random random(13);
  const LocalPlane plane(kOrigin);
  std::string named, degrees;
  named = "run;Depth (m);North [m];East [m]\n";
  for (int i = 0; i < 400; ++i) {
    const Vector2d p(random.uniform(-50, 50), random.uniform(-50, 50));
    const double depth = 10 + 0.05 * p.x() - 0.02 * p.y();
    char line[120];
    std::snprintf(line, sizeof line, "%d;%.5f;%.5f;%.5f\r\n", i / 100, depth, p.x(), p.y());
    named += line;
    const GeoPoint g = plane.to_geo(p);
    std::snprintf(line, sizeof line, "  %.10f  %.10f  %.5f\n", g.longitude_deg, g.latitude_deg, -depth);
    degrees += line;
  }
  write_whole_file(folder / "named.csv", named + "9;bad;1;2\n");
  write_whole_file(folder / "degrees.xyz", degrees);
  PriorConfig config;
  config.datum_offset_m = {0};
  config.run_column = "run";
  const PriorWindow wanted = window(40, -40, 2, 40, 40);
  const Prior a = read_prior(folder / "named.csv", config, plane, wanted);
  EXPECT_EQ(a.left_out.at("lines that are not numbers in columns"), 1u);
  EXPECT_EQ(a.soundings.back().run, 3);
  PriorConfig up;
  up.datum_offset_m = {0};
  up.sign = PriorSign::kUp;
  up.epsg = 4326;
  const Prior b = read_prior(folder / "degrees.xyz", up, plane, wanted);
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) {
      const Vector2d p = a.raster.window.grid.centre({column, row});
      const double truth = 10 + 0.05 * p.x() - 0.02 * p.y();
      ASSERT_NEAR(a.raster.depth_m[a.raster.index({column, row})], truth, 1e-4);
      ASSERT_NEAR(b.raster.depth_m[b.raster.index({column, row})], truth, 1e-4);
    }
  }
}

TEST(Prior, RefusesTextThatIsNotSoundings) {
  const fs::path folder = test::scratch_folder();
  const PriorWindow wanted = window(60, -60, 4, 30, 30);
  const auto says = [&](const char* text, const PriorConfig& config) {
    write_whole_file(folder / "a.txt", std::string_view(text));
    return refusal(folder / "a.txt", config, wanted);
  };
  EXPECT_THAT(says("", plain()), HasSubstr("not numbers in columns"));
  EXPECT_THAT(says("12,5 13,5 4,2\n12,6 13,6 4,3\n", plain()), HasSubstr("decimal points"));
  EXPECT_THAT(says("1 2 3\n4 5 6\n7 9 9\n", plain()), HasSubstr("the coordinate system is unknown"));
  EXPECT_THAT(says("east,north,colour\n1,2,3\n", plain()), HasSubstr("columns of east, north and depth are unknown"));
  PriorConfig config = plain();
  config.z_column = "deep";
  EXPECT_THAT(says("east,north,depth\n1,2,3\n", config), HasSubstr("no column \"deep\""));
  EXPECT_THAT(says("east,north,depth\n1,2,-3\n3,4,-5\n", plain()), HasSubstr("are not positive down"));
  EXPECT_THAT(says("#LLH Offset: 52.3, 12.9, 0\n1, 2, 3\n", plain()), HasSubstr("not a valid position"));
  // soundings on a line make no surface, but stay soundings
  write_whole_file(folder / "line.txt", std::string_view("east,north,depth\n1,2,3\n3,4,5\n5,6,7\n"));
  const Prior line = read_prior(folder / "line.txt", plain(), LocalPlane(kOrigin), wanted);
  EXPECT_EQ(line.soundings.size(), 3u);
  EXPECT_EQ(line.details.count("surface"), 1u);
}

// 1.6 square kilometres from 6500 soundings, on fewer than 512 x 512 pixels.
// ledger: S1-13 S1-14 S1-D07
TEST(Prior, MakesAGridOfAWholeSurvey) {
  const fs::path file = test::scratch_folder() / "survey.csv";
  Random random(17);
  std::string text = "east,north,depth\n";
  const auto bottom = [](const Vector2d& p) { return 12 + 4 * std::sin(p.x() / 150) * std::cos(p.y() / 120); };
  for (int line = 0; line < 26; ++line) {  // survey lines 50 m apart over 1.25 x 1.25 km
    for (int i = 0; i < 250; ++i) {
      const Vector2d p(line * 50.0 + random.uniform(-2, 2), i * 5.0);
      char row[80];
      std::snprintf(row, sizeof row, "%.2f,%.2f,%.2f\n", p.y(), p.x(), bottom(p));
      text += row;
    }
  }
  write_whole_file(file, text);
  const Prior prior = read_prior(file, plain(), LocalPlane(kOrigin), window(0, 0, 5, 0, 0));
  const PriorWindow& w = prior.raster.window;
  EXPECT_LT(w.columns, 512);
  EXPECT_LT(w.rows, 512);
  double squares = 0, within = 0, n = 0;
  for (int row = 4; row + 4 < w.rows; ++row) {
    for (int column = 4; column + 4 < w.columns; ++column) {
      const std::size_t i = prior.raster.index({column, row});
      const auto d = static_cast<double>(prior.raster.depth_m[i]);
      ASSERT_TRUE(std::isfinite(d));
      const double miss = d - bottom(w.grid.centre({column, row}));
      squares += miss * miss;
      within += std::abs(miss) < 2 * static_cast<double>(prior.raster.sigma_m[i]);
      ++n;
    }
  }
  EXPECT_LT(std::sqrt(squares / n), 0.05);
  EXPECT_GT(within / n, 0.95);
}

TEST(PriorConfig, ReadsWhatItWrites) {
  PriorConfig config;
  config.datum_offset_m = {1.25};
  config.sign = PriorSign::kUp;
  config.pixels = Merge::kShoalest;
  std::vector<Section> out = {{"prior", "", fields(config)}};
  PriorConfig back;
  std::vector<Section> in = {{"prior", "", fields(back)}};
  read_toml(write_toml(out, true), "prior.toml", in);
  EXPECT_EQ(back.datum_offset_m, config.datum_offset_m);
  EXPECT_EQ(back.sign, PriorSign::kUp);
  EXPECT_EQ(back.pixels, Merge::kShoalest);
}

}  // namespace
}  // namespace isobath::read_prior_test

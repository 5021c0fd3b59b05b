// What goes out to geographic information systems, and the local plane that ties metres to the globe.
#include <cmath>
#include <cpl_conv.h>
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/bytes/whole_file.hpp>
#include <isobath/io/exports/geojson.hpp>
#include <isobath/io/gdal/geotiff.hpp>
#include <nlohmann/json.hpp>
#include <ogr_spatialref.h>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

// Lengths of a degree on WGS 84 at 60 degrees north: 111412 m of latitude, 55800 m of longitude (published tables).
TEST(Geodesy, AgreesWithTheLengthOfADegree) {
  const LocalPlane plane({60, 10});
  const Vector2d north = plane.to_plane({60.001, 10}), east = plane.to_plane({60, 10.001});
  EXPECT_NEAR(north.x(), 111.412, 0.002);
  EXPECT_NEAR(north.y(), 0, 1e-9);
  EXPECT_NEAR(east.y(), 55.800, 0.002);
  EXPECT_NEAR(plane.to_plane({60, 10}).norm(), 0, 1e-9);
}

TEST(Geodesy, IsInverseWithinAHundredKilometres) {
  for (const GeoOrigin origin : {GeoOrigin{60, 10}, {-33.5, 179.9}, {0, 0}, {89.9, -120}}) {
    const LocalPlane plane(origin);
    for (const Vector2d& p : {Vector2d(1, 2), {-5000, 700}, {70000, -70000}}) {
      const GeoPoint point = plane.to_geo(p);
      EXPECT_LT((plane.to_plane(point) - p).norm(), 1e-6);
      if (std::abs(origin.latitude_deg) < 80) {
        const GeoOrigin back = origin_from(point, p);
        EXPECT_NEAR(back.latitude_deg, origin.latitude_deg, 1e-10);
        EXPECT_NEAR(std::remainder(back.longitude_deg - origin.longitude_deg, 360), 0, 1e-10);
      }
    }
  }
}

struct Opened {
  explicit Opened(const std::filesystem::path& file) {
    GDALAllRegister();
    data = GDALDataset::FromHandle(GDALOpen(file.c_str(), GA_ReadOnly));
  }
  ~Opened() { GDALClose(data); }
  /// Longitude and latitude of a corner of a pixel.
  GeoPoint corner(double column, double row) const {
    double t[6];
    EXPECT_EQ(data->GetGeoTransform(t), CE_None);
    double x = t[0] + column * t[1] + row * t[2], y = t[3] + column * t[4] + row * t[5];
    OGRSpatialReference globe;
    globe.SetWellKnownGeogCS("WGS84");
    globe.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    OGRCoordinateTransformation* way = OGRCreateCoordinateTransformation(data->GetSpatialRef(), &globe);
    EXPECT_TRUE(way->Transform(1, &x, &y));
    OGRCoordinateTransformation::DestroyCT(way);
    return {y, x};
  }
  GDALDataset* data = nullptr;
};

TEST(GeoTiff, LiesWhereTheMapLies) {
  const auto folder = test::scratch_folder();
  RasterFrame frame{3, 2, 50, {400, -300}, Angle::degrees(30), GeoOrigin{41.5, -8.7}};
  const std::vector<float> cells = {0.1f, 0.2f, NAN, 0.4f, 0.5f, 0.6f};
  write_geotiff(folder / "map.tif", frame, {"occupancy", "1"}, cells);
  const Opened tif(folder / "map.tif");
  ASSERT_TRUE(tif.data);
  // the corner itself, and two cells to the right and one down: 100 m towards 120 degrees, 50 m towards 210 degrees
  const LocalPlane plane(*frame.origin);
  const Angle right = Angle::degrees(120), down = Angle::degrees(210);
  const Vector2d inner = frame.corner_m + 100 * Vector2d(cos(right), sin(right)) + 50 * Vector2d(cos(down), sin(down));
  EXPECT_LT((plane.to_plane(tif.corner(0, 0)) - frame.corner_m).norm(), 1e-4);
  EXPECT_LT((plane.to_plane(tif.corner(2, 1)) - inner).norm(), 1e-4);
  std::vector<float> read(6);
  GDALRasterBand* band = tif.data->GetRasterBand(1);
  ASSERT_EQ(band->RasterIO(GF_Read, 0, 0, 3, 2, read.data(), 3, 2, GDT_Float32, 0, 0, nullptr), CE_None);
  EXPECT_EQ(read[1], 0.2f);
  EXPECT_TRUE(std::isnan(read[2]));
  EXPECT_TRUE(std::isnan(band->GetNoDataValue()));
  EXPECT_STREQ(band->GetDescription(), "occupancy");
}

TEST(GeoTiff, WithoutOriginIsALocalPlane) {
  const auto folder = test::scratch_folder();
  const RasterFrame frame{2, 2, 0.1, {1, -1}, {}, {}};
  const std::vector<std::uint8_t> cells = {1, 2, 255, 4};
  write_geotiff(folder / "a.tif", frame, {"class", ""}, cells, 255);
  write_geotiff(folder / "b.tif", frame, {"class", ""}, cells, 255);
  EXPECT_EQ(read_whole_file(folder / "a.tif", 1 << 20), read_whole_file(folder / "b.tif", 1 << 20));
  const Opened tif(folder / "a.tif");
  ASSERT_TRUE(tif.data);
  double t[6];
  ASSERT_EQ(tif.data->GetGeoTransform(t), CE_None);
  EXPECT_THAT(t, testing::ElementsAre(-1, 0.1, 0, 1, 0, -0.1));
  EXPECT_EQ(tif.data->GetRasterBand(1)->GetNoDataValue(), 255);
  ASSERT_TRUE(tif.data->GetSpatialRef());
  EXPECT_TRUE(tif.data->GetSpatialRef()->IsLocal());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 2) << "no side files";
}

TEST(GeoTiff, HoldsSeveralBandsWithNamesAndUnits) {
  const auto folder = test::scratch_folder();
  const std::vector<float> depth = {10, 11, NAN, 13}, confidence = {5, 6, NAN, 20};
  const RasterBand bands[] = {{{"depth", "m"}, depth}, {{"confidence", ""}, confidence}};
  write_geotiff(folder / "map.tif", RasterFrame{2, 2, 0.5, {8, 4}, {}, GeoOrigin{41.5, -8.7}}, bands);
  const Opened tif(folder / "map.tif");
  ASSERT_TRUE(tif.data);
  ASSERT_EQ(tif.data->GetRasterCount(), 2);
  EXPECT_STREQ(tif.data->GetRasterBand(1)->GetDescription(), "depth");
  EXPECT_STREQ(tif.data->GetRasterBand(1)->GetUnitType(), "m");
  EXPECT_STREQ(tif.data->GetRasterBand(2)->GetDescription(), "confidence");
  for (int band = 1; band <= 2; ++band) {
    std::vector<float> read(4);
    GDALRasterBand* b = tif.data->GetRasterBand(band);
    ASSERT_EQ(b->RasterIO(GF_Read, 0, 0, 2, 2, read.data(), 2, 2, GDT_Float32, 0, 0, nullptr), CE_None);
    EXPECT_TRUE(std::isnan(b->GetNoDataValue()));
    EXPECT_EQ(read[3], band == 1 ? 13 : 20);
    EXPECT_TRUE(std::isnan(read[2]));
  }
}

TEST(GeoTiff, SaysWhenItCannotBeWritten) {
  const std::vector<std::uint8_t> cells = {1};
  EXPECT_THROW(write_geotiff("/nowhere/at/all.tif", RasterFrame{1, 1, 1, {0, 0}, {}, {}}, {"x", ""}, cells, {}), Error);
}

TEST(GeoJson, TurnsOutlinesCounterClockwiseAndClosesThem) {
  GeoFeature clockwise;  // seen from above: north, then east
  clockwise.outline = {{0, 0}, {10, 0}, {10, 20}, {0, 20}};
  clockwise.properties = {
      {"existence", 0.75}, {"id", std::int64_t{3}}, {"name", "wall \xff"}, {"bad", NAN}, {"behind", false}};
  const GeoOrigin origin{41.5, -8.7};
  const std::string text = geojson_text(std::vector{clockwise}, origin);
  EXPECT_EQ(text, geojson_text(std::vector{clockwise}, origin));
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["type"], "FeatureCollection");
  const auto& feature = json["features"][0];
  EXPECT_EQ(feature["properties"]["id"], 3);
  EXPECT_TRUE(feature["properties"]["bad"].is_null());
  const auto ring = feature["geometry"]["coordinates"][0].get<std::vector<std::array<double, 2>>>();
  ASSERT_EQ(ring.size(), 5u);
  EXPECT_EQ(ring.front(), ring.back());
  double area = 0;
  for (std::size_t i = 0; i + 1 < ring.size(); ++i) area += ring[i][0] * ring[i + 1][1] - ring[i + 1][0] * ring[i][1];
  EXPECT_GT(area, 0);
  const LocalPlane plane(origin);
  std::vector<Vector2d> back;
  for (std::size_t i = 0; i < 4; ++i) back.push_back(plane.to_plane({ring[i][1], ring[i][0]}));
  for (const Vector2d& corner : clockwise.outline) {
    EXPECT_TRUE(std::any_of(back.begin(), back.end(), [&](const auto& b) { return (b - corner).norm() < 2e-4; }));
  }
  EXPECT_EQ(nlohmann::json::parse(geojson_text({}, origin))["features"].size(), 0u);
}

TEST(GeoJson, WritesLinesAndPoints) {
  GeoFeature line{{{0, 0}, {100, 0}, {100, 50}}, {{"depth_m", 5.0}}, GeoShape::kLine};
  GeoFeature point{{{10, 20}}, {}, GeoShape::kPoint}, points{{{10, 20}, {30, 40}}, {}, GeoShape::kPoint};
  const GeoOrigin origin{41.5, -8.7};
  const auto json = nlohmann::json::parse(geojson_text(std::vector{line, point, points}, origin));
  const auto& features = json["features"];
  EXPECT_EQ(features[0]["geometry"]["type"], "LineString");
  ASSERT_EQ(features[0]["geometry"]["coordinates"].size(), 3u) << "neither closed nor turned";
  EXPECT_EQ(features[1]["geometry"]["type"], "Point");
  EXPECT_EQ(features[2]["geometry"]["type"], "MultiPoint");
  const auto at = features[1]["geometry"]["coordinates"].get<std::array<double, 2>>();
  EXPECT_LT((LocalPlane(origin).to_plane({at[1], at[0]}) - Vector2d(10, 20)).norm(), 2e-4);
  EXPECT_EQ(features[0]["geometry"]["coordinates"][0][1], 41.5);
}

}  // namespace
}  // namespace isobath

// Areas of threat: polygons with probabilities, and what is refused.
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/charts/threat_areas.hpp>

namespace isobath::threat_areas_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const GeoOrigin kOrigin{52.339, 12.9955};
constexpr const char* kSquare =
    "[[[12.9955,52.339],[12.9985,52.339],[12.9985,52.341],[12.9955,52.341],[12.9955,52.339]]]";

std::string collection(const std::vector<std::pair<std::string, std::string>>& areas) {
  std::string text = R"({"type":"FeatureCollection","features":[)";
  for (const auto& [properties, coordinates] : areas) {
    text += fmt::format(R"({}{{"type":"Feature","properties":{},"geometry":{{"type":"Polygon","coordinates":{}}}}})",
                        text.back() == '[' ? "" : ",", properties, coordinates);
  }
  return text + "]}";
}

std::vector<ThreatArea> read(const std::string& text) {
  const fs::path file = fs::path(testing::TempDir()) / "threats.geojson";
  write_whole_file(file, text);
  return read_threat_areas(file, LocalPlane(kOrigin));
}

/// What the error says; empty where there is none.
std::string refusal(const std::string& text) {
  try {
    (void)read(text);
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << "one line";
    return e.what();
  }
  return {};
}

// ledger: S1-37
TEST(ThreatAreas, AreReadWithTheirProbabilities) {
  const auto areas = read(collection({{R"({"name":"patrol","detection":0.5,"over_m":400})", kSquare},
                                      {R"({"destruction":0.02,"detection":null})", kSquare}}));
  ASSERT_EQ(areas.size(), 2u);
  EXPECT_EQ(areas[0].name, "patrol");
  EXPECT_EQ(areas[0].detection, 0.5);
  EXPECT_EQ(areas[0].destruction, 0);
  EXPECT_EQ(areas[0].over_m, 400);
  EXPECT_EQ(areas[1].destruction, 0.02);
  EXPECT_EQ(areas[1].over_m, 1000);
  ASSERT_EQ(areas[0].rings.size(), 1u);
  ASSERT_EQ(areas[0].rings[0].size(), 4u);
  EXPECT_LT(areas[0].rings[0][0].norm(), 0.01) << "the origin";
  EXPECT_NEAR(areas[0].rings[0][2].x(), 222.6, 0.5);  // 0.002 degrees of latitude
}

// ledger: S1-37
TEST(ThreatAreas, ThatCannotBeUsedAreRefused) {
  const auto with = [](const std::string& properties) { return refusal(collection({{properties, kSquare}})); };
  EXPECT_THAT(with("{}"), HasSubstr("neither \"detection\" nor \"destruction\""));
  for (const char* probability : {"1", "-0.1", "7", "1e999", "\"likely\""}) {
    EXPECT_THAT(with(fmt::format(R"({{"detection":{}}})", probability)), HasSubstr("detection")) << probability;
  }
  EXPECT_THAT(with(R"({"detection":0.1,"over_m":0})"), HasSubstr("over_m is 0"));
  EXPECT_THAT(refusal(collection({})), HasSubstr("no area"));
  EXPECT_THAT(refusal(collection({{R"({"detection":0.1})", "[[[120,10],[121,10],[121,11],[120,10]]]"}})),
              HasSubstr("no polygon within reach"));
  EXPECT_THAT(refusal("{\"type\":\"FeatureColl"), HasSubstr("not a readable file of areas"));
  EXPECT_THAT(refusal(R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"detection":0.1},)"
                      R"("geometry":{"type":"Point","coordinates":[12.9955,52.339]}}]})"),
              HasSubstr("no polygon"));
}

}  // namespace
}  // namespace isobath::threat_areas_test

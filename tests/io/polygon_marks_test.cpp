// Polygons drawn round objects, filled: against a ray cast from every pixel the other way round.
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/frames/frame_folder.hpp>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/io/frames/polygon_marks.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

using Marks = std::vector<std::uint8_t>;
using Outline = std::vector<std::array<double, 2>>;

std::string shape(const Outline& points, const std::string& type = "polygon") {
  std::string list;
  for (const auto& p : points) list += fmt::format("{}[{}, {}]", list.empty() ? "" : ", ", p[0], p[1]);
  return fmt::format(R"({{"label": "hull", "points": [{}], "shape_type": "{}"}})", list, type);
}
std::string json_of(const std::string& shapes, const std::string& more = "") {
  return "{\"version\": \"5.0\", \"flags\": {}, " + more + "\"shapes\": [" + shapes + "], \"imageData\": null}";
}
std::string xml_of(const Outline& points, bool deleted = false) {
  std::string list;
  for (const auto& p : points) list += fmt::format("<pt>\n<x>{}</x><y> {} </y></pt>", p[0], p[1]);
  return fmt::format(
      "<object><name>hull</name><deleted>{}</deleted><polygon><username>a</username>{}</polygon></object>",
      deleted ? 1 : 0, list);
}

/// Even-odd by a ray upwards from the centre of each pixel.
Marks by_rays(const std::vector<Outline>& outlines, int width, int height) {
  Marks marks;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const double x = column + 0.5, y = row + 0.5;
      bool any = false;
      for (const Outline& outline : outlines) {
        bool inside = false;
        for (std::size_t i = 0; i < outline.size(); ++i) {
          const auto &a = outline[i], &b = outline[(i + 1) % outline.size()];
          if ((a[0] < x) == (b[0] < x)) continue;
          if (a[1] + (x - a[0]) / (b[0] - a[0]) * (b[1] - a[1]) < y) inside = !inside;
        }
        any = any || inside;
      }
      marks.push_back(any ? 1 : 0);
    }
  }
  return marks;
}

Outline random_outline(Random& random) {
  Outline outline;
  const std::size_t points = 3 + random.index(8);
  for (std::size_t i = 0; i < points; ++i) {
    const double x = random.uniform(-6, 30);
    const double y = random.uniform(-6, 22);
    outline.push_back({x, y});
  }
  return outline;
}

// ledger: S5-24
TEST(PolygonMarks, FilledAreThePixelsWhoseCentresLieInside) {
  Random random(9);
  for (int round = 0; round < 300; ++round) {
    const Outline outline = random_outline(random);
    const Marks expected = by_rays({outline}, 24, 16);
    EXPECT_EQ(parse_polygon_marks(json_of(shape(outline)), 24, 16, "a.json"), expected);
    EXPECT_EQ(parse_polygon_marks("<annotation>" + xml_of(outline) + "</annotation>", 24, 16, "a.xml"), expected);
  }
}

// ledger: S5-24
TEST(PolygonMarks, OverlappingPolygonsCountOnce) {
  const Outline left{{2, 2}, {12, 2}, {12, 10}, {2, 10}}, right{{8, 4}, {20, 4}, {20, 12}, {8, 12}};
  const Marks marks = parse_polygon_marks(json_of(shape(left) + "," + shape(right)), 24, 16, "a.json");
  EXPECT_EQ(std::count(marks.begin(), marks.end(), 1), 80 + 96 - 24);
  EXPECT_EQ(marks, by_rays({left, right}, 24, 16));
  EXPECT_EQ(parse_polygon_marks(json_of(shape({{2, 2}, {12, 10}}, "rectangle")), 24, 16, "a.json"),
            by_rays({left}, 24, 16));
}

TEST(PolygonMarks, DeletedObjectsOfTheWebToolAreLeftOut) {
  const Outline box{{2, 2}, {12, 2}, {12, 10}, {2, 10}};
  const std::string xml = "<annotation>" + xml_of(box, true) + "</annotation>";
  ASSERT_TRUE(looks_like_polygon_marks(xml));
  EXPECT_EQ(parse_polygon_marks(xml, 24, 16, "a.xml"), Marks(24 * 16, 0));
}

TEST(PolygonMarks, WhatIsNoAnnotationIsRefused) {
  const Outline box{{2, 2}, {12, 2}, {12, 10}, {2, 10}};
  for (const std::string& bad :
       {std::string("{}"), std::string("{\"shapes\": 3}"), std::string("{\"shapes\": [{}]}"), std::string("[1]"),
        json_of(shape(box, "circle")), json_of(shape({{1, 1}, {2, 2}})), json_of(shape({{1, 1}, {2, 2}, {1e9, 3}})),
        json_of(R"({"points": [["1", 2], [2, 3], [4, 5]]})"), json_of(R"({"points": [[1], [2, 3], [4, 5]]})"),
        json_of(shape(box), "\"imageWidth\": 25, "), json_of(shape(box), "\"imageHeight\": \"16\", "),
        std::string("<annotation><object><polygon><pt><x>a</x><y>1</y></pt></polygon></object></annotation>"),
        std::string("<annotation><object><polygon></polygon></object></annotation>")}) {
    EXPECT_THROW(parse_polygon_marks(bad, 24, 16, "bad"), Error) << bad;
  }
  EXPECT_NO_THROW(
      parse_polygon_marks(json_of(shape(box), "\"imageWidth\": 24, \"imageHeight\": 16, "), 24, 16, "good"));
  EXPECT_FALSE(looks_like_polygon_marks(R"({"beams": 24, "bins": 16})"));
}

// ledger: S5-24
TEST(MarkedFrames, TakesPolygonsBesideTheFrames) {
  const std::filesystem::path folder = test::scratch_folder();
  std::ofstream(folder / "geometry.json")
      << R"({"beams": 24, "bins": 16, "range_min_m": 1, "range_max_m": 9, "fov_deg": 24, "height_deg": 10,
             "first_column": "starboard", "near_row": "bottom"})";
  GrayImage image{24, 16, 1, {}};
  for (int i = 0; i < 24 * 16; ++i) image.samples.push_back(static_cast<std::uint8_t>(i % 251));
  for (const char* name : {"1000_raw.png", "2000.png", "3000.png"}) write_gray_png(folder / name, image);
  const Outline outline{{2.2, 1}, {9, 3}, {5, 8}};
  std::ofstream(folder / "1000.json") << json_of(shape(outline));
  std::ofstream(folder / "2000.xml") << "<annotation>" << xml_of(outline) << "</annotation>";
  const auto frames = read_marked_frames(folder, {});
  ASSERT_EQ(frames.size(), 3u);
  const Marks expected = by_rays({outline}, 24, 16);
  for (const int i : {0, 1}) {
    ASSERT_FALSE(frames[static_cast<std::size_t>(i)].background);
    for (int beam = 0; beam < 24; ++beam) {
      for (int bin = 0; bin < 16; ++bin) {  // columns run from starboard, rows from far
        EXPECT_EQ(frames[static_cast<std::size_t>(i)].marked[static_cast<std::size_t>(beam * 16 + bin)],
                  expected[static_cast<std::size_t>((15 - bin) * 24 + 23 - beam)]);
      }
    }
  }
  EXPECT_TRUE(frames[2].background);
}

}  // namespace
}  // namespace isobath

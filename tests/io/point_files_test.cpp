// Points without times: PCD files in their three kinds of data, and text grids, as soundings tile by tile.
#include <bit>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/io/formats/point_files.hpp>
#include <isobath/io/open_source.hpp>
#include <tests/io/bytes_by_hand.hpp>
#include <tests/support/data.hpp>

namespace isobath::point_files {
namespace {

using test::drain;
using testing::HasSubstr;

/// The header of a cloud with an intensity between y and z.
std::string pcd_header(int points, const std::string& data) {
  const std::string count = std::to_string(points);
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y intensity z\nSIZE 4 4 1 4\nTYPE F F U F\n"
         "COUNT 1 1 1 1\nWIDTH " +
         count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA " + data + "\n";
}
std::string real(float value) { return test::little(std::bit_cast<std::uint32_t>(value)); }

/// North, east and depth of every sounding, in the order of the source.
std::vector<Eigen::Vector3d> points_in(Source& source) {
  std::vector<Eigen::Vector3d> points;
  Pose X_WB;
  for (const Event& event : drain(source)) {
    if (const auto* fix = std::get_if<Navigation>(&event)) X_WB = fix->X_WB;
    const auto* swath = std::get_if<Swath>(&event);
    for (std::size_t i = 0; swath && i < swath->soundings.size(); ++i) {
      points.push_back(X_WB * swath->soundings[i].point.cast<double>());
    }
  }
  return points;
}

// Two points: 3 m east, 4 m north, 10 m deep; and 20 m east, in the next tile.
const std::string kAscii = pcd_header(2, "ascii") + "3 4 9 -10\n20 4 9 -12\n";
const std::string kBinary =
    pcd_header(2, "binary") + real(3) + real(4) + "\x09" + real(-10) + real(20) + real(4) + "\x09" + real(-12);

std::string compressed(const std::string& packed, std::uint32_t size) {
  return pcd_header(2, "binary_compressed") + test::little(static_cast<std::uint32_t>(packed.size())) +
         test::little(size) + packed;
}
// All x, all y, ...; 26 bytes as they are, in one run of LZF.
const std::string kColumns = real(3) + real(20) + real(4) + real(4) + "\x09\x09" + real(-10) + real(-12);
const std::string kCompressed = compressed(std::string(1, '\x19') + kColumns, 26);

TEST(PointFiles, EachKindOfPcdGivesTheSamePointsInOurAxes) {
  for (const std::string& file : {kAscii, kBinary, kCompressed}) {
    const auto source = points_of_pcd(bytes_of(file), "cloud.pcd", {});
    const auto points = points_in(*source);
    ASSERT_EQ(points.size(), 2u) << source->report().format;
    EXPECT_TRUE(points[0].isApprox(Eigen::Vector3d(4, 3, 10), 1e-6)) << points[0].transpose();
    EXPECT_TRUE(points[1].isApprox(Eigen::Vector3d(4, 20, 12), 1e-6)) << points[1].transpose();
    EXPECT_TRUE(source->report().rejected.empty());
  }
}

// LZF: "abc" as it is, then a copy of 9 bytes from 3 bytes before.
TEST(PointFiles, CopiesOfLzfAreUnpacked) {
  const std::string repeated = real(4) + real(4);
  const std::string packed = std::string("\x07", 1) + real(3) + real(20) + std::string("\x03", 1) + real(4) +
                             std::string("\x40\x03", 2) + std::string("\x09", 1) + "\x09\x09" + real(-10) + real(-12);
  const auto source = points_of_pcd(bytes_of(compressed(packed, 26)), "cloud.pcd", {});
  EXPECT_EQ(points_in(*source).size(), 2u);
}

TEST(PointFiles, NedAxesAreThoseOfTheSetting) {
  InputConfig ned;
  ned.axes = LogAxes::kNed;
  const std::string file = pcd_header(1, "ascii") + "3 4 9 10\n";
  EXPECT_TRUE(points_in(*points_of_pcd(bytes_of(file), "cloud.pcd", ned)).at(0).isApprox(Eigen::Vector3d(3, 4, 10)));
}

TEST(PointFiles, WhatIsNoSoundingIsCounted) {
  const std::string file = pcd_header(5, "ascii") + "1 1 0 -5\n1 1 0 2\nnan nan 0 nan\nx\n1 2 0 -6\n";
  const auto source = points_of_pcd(bytes_of(file), "cloud.pcd", {});
  EXPECT_EQ(points_in(*source).size(), 2u);
  EXPECT_EQ(source->report().rejected.at("point above the water"), 1u);
  EXPECT_EQ(source->report().rejected.at("line without three numbers"), 2u);
}

TEST(PointFiles, HeaderThatClaimsMoreThanItsFileGivesWhatIsThere) {
  for (std::size_t cut = kBinary.size() - 26; cut < kBinary.size(); ++cut) {
    const std::string part = kBinary.substr(0, cut);
    const auto source = points_of_pcd(bytes_of(part), "cloud.pcd", {});
    EXPECT_LT(points_in(*source).size(), 2u);
    EXPECT_EQ(source->report().rejected.size(), 1u);
  }
  for (std::size_t cut = pcd_header(2, "binary_compressed").size(); cut < kCompressed.size(); ++cut) {
    EXPECT_TRUE(points_in(*points_of_pcd(bytes_of(kCompressed.substr(0, cut)), "cloud.pcd", {})).empty());
  }
  const std::string bomb = compressed("\x01", 0xF0000000U);
  EXPECT_TRUE(points_in(*points_of_pcd(bytes_of(bomb), "cloud.pcd", {})).empty());
}

TEST(PointFiles, HeadersThatCannotBeReadAreRefusedInOneLine) {
  for (const auto& [text, problem] :
       {std::pair("VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nDATA ascii\n", "without x, y and z"),
        std::pair("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 9\n", "wrong size"),
        std::pair("VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE I I I\nCOUNT 1 1 1\nDATA binary\n", "not real numbers"),
        std::pair("VERSION 0.7\nFIELDS x y z\n", "does not end")}) {
    try {
      (void)points_of_pcd(bytes_of(text), "cloud.pcd", {});
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(problem));
    }
  }
}

TEST(PointFiles, FileIsRecognisedByItsContent) {
  const auto folder = test::scratch_folder();
  std::ofstream(folder / "cloud", std::ios::binary) << kBinary;
  std::ofstream(folder / "grid") << "# x y depth\n10 20 5.5\n11;20;5.6\n12\t20\t-1\n13,20,5.8\n";
  EXPECT_THAT(open_source(folder / "cloud", {})->report().format, HasSubstr("PCD, binary"));
  const auto grid = open_source(folder / "grid", {});
  EXPECT_THAT(grid->report().format, HasSubstr("grid of x, y and depth"));
  EXPECT_EQ(points_in(*grid).size(), 3u);
  EXPECT_EQ(grid->report().rejected.at("point above the water"), 1u);
}

// Points 1 m apart along the central meridian of a zone, where the scale is 0.9996.
TEST(PointFiles, PlaceOnTheGlobeComesFromTheZone) {
  InputConfig config;
  config.survey.csv_position = "utm 33N";
  config.survey.csv_depth_sign = DepthSign::kUp;
  const std::string text = "500004 6650000 -5\n500004 6650001 -6\n500004 6650002 -7\n";
  const auto source = points_of_xyz(bytes_of(text), "grid", config);
  const auto points = points_in(*source);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[2].x() - points[0].x(), 2 / 0.9996, 1e-5);
  EXPECT_NEAR(points[2].z(), 7, 1e-6);
  ASSERT_TRUE(source->report().origin.has_value());
  EXPECT_NEAR(source->report().origin->longitude_deg, 15, 1e-4);
}

TEST(PointFiles, FarLocalPositionsCountFromTheFirst) {
  const std::string text = "500000 6650000 5\n500001 6650000 6\n500002 6650003 7\n";
  const auto source = points_of_xyz(bytes_of(text), "grid", {});
  EXPECT_TRUE(points_in(*source).at(2).isApprox(Eigen::Vector3d(3, 2, 7), 1e-6));
  EXPECT_THAT(source->report().details.at("place"), HasSubstr("x 500000, y 6650000"));
}

}  // namespace
}  // namespace isobath::point_files

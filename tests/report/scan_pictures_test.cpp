// Pictures frame what there is, the report opens with what its run is about.
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <isobath/report/map_chart.hpp>
#include <isobath/report/report_sections.hpp>
#include <isobath/report/scan_pictures.hpp>
#include <numbers>
#include <tests/support/echoes.hpp>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

/// A scan of one ping of a fan that looks ahead, `beams` of 0.5 degrees, out to 20 m.
ScanPing ahead(int beams) {
  const Angle first = Angle::degrees(-0.25 * (beams - 1));
  const auto value = [](int beam, int bin) { return beam == 0 && bin == 5 ? 200 : 10; };
  return {test::ping_of<std::uint8_t>(test::fan_of(beams, first, Angle::degrees(0.5)), {0, 0.5, 40}, value), Pose{}};
}

/// Pixels across and down of a PNG.
std::pair<int, int> size_of(const std::string& png) {
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = 256 * value + static_cast<std::uint8_t>(png.at(i));
    return value;
  };
  return {number(16), number(20)};
}

double height_of(const PlanExtent& e) { return e.x_max - e.x_min; }
double width_of(const PlanExtent& e) { return e.y_max - e.y_min; }

TEST(FrameAround, HasAnEvenMarginOnAllSides) {
  Eigen::AlignedBox2d box(Vector2d(10, -5), Vector2d(110, 45));
  const PlanExtent e = frame_around(box);
  EXPECT_NEAR(e.x_min, 10 - 4, 1e-9);
  EXPECT_NEAR(e.x_max, 110 + 4, 1e-9);
  EXPECT_NEAR(e.y_min, -5 - 4, 1e-9);
  EXPECT_NEAR(e.y_max, 45 + 4, 1e-9);
}

TEST(FrameAround, GivesALineSomeWidth) {
  const PlanExtent e = frame_around(Eigen::AlignedBox2d(Vector2d(0, 3), Vector2d(100, 3)));
  EXPECT_NEAR(width_of(e), 15 + 8, 1e-9);
  EXPECT_NEAR((e.y_min + e.y_max) / 2, 3, 1e-9);
}

TEST(ScanPictures, OfANarrowFanAreNarrow) {
  const std::vector<ScanPing> pings = {ahead(29)};  // 14.5 degrees, as an ARIS has it
  const ScanView view{pings, {}, {}, {}};
  const PlanExtent e = scan_extent(view);
  EXPECT_NEAR(e.x_max, 20 * 1.04, 0.1) << "the farthest water and the margin";
  EXPECT_NEAR(e.x_min, -20 * 0.04, 0.1) << "the vehicle and the margin";
  const double across = 2 * 20 * std::sin(Angle::degrees(7.25).radians());
  EXPECT_NEAR(width_of(e), across + 2 * 0.8, 0.1) << "not a square round the vehicle";
  const auto [width, height] = size_of(echo_picture(view));
  EXPECT_LT(width, height) << "the legend included";
}

TEST(ScanPictures, OfAWholeTurnHaveTheVehicleInTheMiddle) {
  const auto value = [](int, int) { return 10; };
  std::vector<ScanPing> pings;
  for (int i = 0; i < 90; ++i) {
    pings.push_back({test::ping_of<std::uint8_t>(test::fan_of(1, Angle::degrees(4 * i)), {0, 0.5, 40}, value), Pose{}});
  }
  const PlanExtent e = scan_extent({pings, {}, {}, {}});
  for (const double side : {e.x_max, -e.x_min, e.y_max, -e.y_min}) EXPECT_NEAR(side, 20 + 1.6, 0.1);
}

TEST(ScanPictures, HoldObstaclesThatNoBeamOfTheLastScanReaches) {
  const std::vector<ScanPing> pings = {ahead(29)};
  Obstacle behind;
  behind.outline = {{-12, -9}, {-10, -9}, {-10, -7}};
  behind.nearest = {-10, -7};
  behind.number = 3;
  const std::vector<Obstacle> obstacles = {behind};
  const ScanView view{pings, obstacles, {}, {"survey.log", "2025-01-17, 10:00 UTC"}};
  const PlanExtent e = scan_extent(view);
  EXPECT_LT(e.x_min, -12);
  EXPECT_LT(e.y_min, -9);
  EXPECT_GT(obstacle_picture(view).size(), 1000u);
  EXPECT_EQ(obstacle_picture(view), obstacle_picture(view)) << "the same input, the same bytes";
  EXPECT_EQ(size_of(obstacle_picture(view)), size_of(echo_picture(view))) << "the pictures of a scan are of one size";
}

TEST(ScanPictures, WithoutAPingAreStillDrawn) {
  const ScanView view;
  EXPECT_GT(height_of(scan_extent(view)), 0.1);
  EXPECT_GT(echo_picture(view).size(), 1000u);
}

TEST(DepthMargin, WidensTheWindowAndMovesNoDepth) {
  DepthChart chart;
  chart.grid = {{100, 50}, 0.5};
  chart.window = {4, 6, 3, 2};
  chart.depth_m = {1, 2, 3, 4, 5, 6};
  chart.confidence = {1, 2, 3, 4, 5, 6};
  add_margin(chart, 2);
  EXPECT_EQ(chart.window, (PixelWindow{2, 4, 7, 6}));
  ASSERT_EQ(chart.depth_m.size(), 42u);
  EXPECT_TRUE(std::isnan(chart.depth_m[0]));
  EXPECT_EQ(chart.depth_m[2 * 7 + 2], 1) << "pixel (4, 6) of the grid";
  EXPECT_EQ(chart.depth_m[3 * 7 + 4], 6);
  EXPECT_EQ(chart.confidence[3 * 7 + 4], 6);
  EXPECT_EQ(chart.confidence[3 * 7 + 5], 255);
  EXPECT_TRUE(chart.flags.empty()) << "as it was";
}

TEST(ReportSections, OpenWithWhatTheRunIsAbout) {
  using enum ReportSection;
  using Order = std::vector<ReportSection>;
  RunOutcome sonar;
  sonar.counts.pings = 100;
  EXPECT_EQ(report_sections(sonar), (Order{kScan, kReplay}));
  sonar.voxels.emplace();
  sonar.depth.emplace();  // an altimeter beside the sonar
  EXPECT_EQ(report_sections(sonar), (Order{kScan, kReplay, kVoxels, kDepth}));
  RunOutcome survey;
  survey.depth.emplace();
  EXPECT_EQ(report_sections(survey), (Order{kDepth, kReplay}));
  survey.voxels.emplace();  // of its water column
  EXPECT_EQ(report_sections(survey), (Order{kDepth, kReplay, kVoxels}));
  RunOutcome mission = sonar;
  mission.mission.emplace();
  EXPECT_EQ(report_sections(mission), (Order{kMission, kReplay, kScan, kVoxels, kDepth}));
  RunOutcome soundings;
  soundings.voxels.emplace();
  EXPECT_EQ(report_sections(soundings), (Order{kVoxels, kReplay, kScan}));
}

TEST(DateText, NamesTheDaysOfTheDataWhereTheLogHasADate) {
  const Time day = Time(seconds(1737108000.0));  // 2025-01-17 10:00
  EXPECT_EQ(date_text(day, day + seconds(600)), "2025-01-17, 10:00 UTC");
  EXPECT_EQ(date_text(day, day + seconds(13 * 86400.0)), "2025-01-17 to 2025-01-30, UTC");
  EXPECT_EQ(date_text(Time(seconds(0.0)), Time(seconds(160.0))), "") << "seconds since the start of a log";
}

}  // namespace
}  // namespace isobath

// The demonstration of Oskard 1990 and Herman et al. 1988 on the lake: a vehicle with six range sonars runs lanes on
// the depth map that it makes. Its chart lacks the rock C, has a shoal F that does not exist, and is 2 m too deep on
// the third lane (scripts/scenario-charts).
#include <algorithm>
#include <gtest/gtest.h>
#include <isobath/world/depth_model.hpp>
#include <limits>
#include <tests/support/mission_runs.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using test::find_decision;

const Vector2d kC(40, -20), kF(40, -80), kTooDeep(50, 40);
constexpr double kRadiusOfC = 4, kVehicleDepth = 3;
constexpr double kLookEvery_s = 0.3;   // the log asks the map so often
constexpr double kAcceptedRange = 50;  // S1-56
constexpr double kDrift = 9;           // of the position between two fixes of the transponders

/// Pixels within `reach_m` of a place.
std::vector<DepthPixel> pixels_about(const DepthField& map, const Vector2d& place, double reach_m) {
  const Pixel middle = map.grid().at(place);
  const auto reach = static_cast<std::int32_t>(reach_m / map.grid().pixel_m);
  const PixelWindow window{middle.column - reach, middle.row - reach, 2 * reach + 1, 2 * reach + 1};
  std::vector<DepthPixel> pixels(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height));
  map.read(window, pixels);
  return pixels;
}

/// Whether a sonar has found something at the vehicle's depth.
bool stands(const DepthPixel& p) { return p.known() && p.has(kSeenByObstacle) && p.depth_m() < kVehicleDepth + 1; }
bool charted_shallow(const DepthPixel& p) { return p.known() && !p.has(kSensed) && p.depth_m() < kVehicleDepth + 1; }
std::size_t count(const std::vector<DepthPixel>& pixels, bool (*which)(const DepthPixel&)) {
  return static_cast<std::size_t>(std::count_if(pixels.begin(), pixels.end(), which));
}

/// When C is first heard and first in the map; the map at the start and at the end.
class LakeLog : public OnboardObserver {
 public:
  double first_echo_s = -1, in_map_s = -1;
  std::shared_ptr<const DepthSnapshot> first, last;

  void on_event(const Event& event) override {
    if (const auto* fix = std::get_if<Navigation>(&event)) X_WB_ = fix->X_WB;
    const auto* reading = std::get_if<RangeReading>(&event);
    if (!reading || !reading->range_m || *reading->range_m > kAcceptedRange || first_echo_s >= 0) return;
    const Eigen::Vector3d end = X_WB_ * (reading->X_BS * Eigen::Vector3d(*reading->range_m, 0, 0));
    if ((end.head<2>() - kC).norm() < kRadiusOfC + kDrift) first_echo_s = to_seconds(reading->time);
  }
  void on_mapped(Time time, const Pipeline&, const DepthModel& depths, const VoxelModel&) override {
    if (to_seconds(time) < next_s_) return;
    next_s_ = to_seconds(time) + kLookEvery_s;
    last = depths.snapshot();
    if (!first) first = last;
    if (!last || in_map_s >= 0 || first_echo_s < 0) return;
    if (count(pixels_about(*last, kC, kRadiusOfC + kDrift), stands) > 0) in_map_s = to_seconds(time);
  }

 private:
  Pose X_WB_;
  double next_s_ = 0;
};

class LakeRaster : public testing::TestWithParam<int> {};

// ledger: S1-D01 S1-D02 S1-D03 S1-D04 S1-03 S1-41 S1-56 S2-D02
TEST_P(LakeRaster, IsSailedOnTheMapThatTheVehicleMakes) {
  LakeLog log;
  LoopRequest request;
  request.configuration.simulation.seed = GetParam();
  request.configuration.depth_map.area_m = 512;
  request.observers.push_back(&log);
  const test::Sailed sailed = test::sail(test::scenario_of("winnipesaukee"), request);
  const MissionReport& report = sailed.result.report;
  EXPECT_EQ(report.phase, MissionPhase::kFinished) << sailed.all();
  EXPECT_EQ(report.reached, 5u) << sailed.all();
  ASSERT_TRUE(log.first && log.last);
  const auto ranges = std::count_if(sailed.events.begin(), sailed.events.end(), [](const Event& e) {
    const auto* reading = std::get_if<RangeReading>(&e);
    return reading && to_seconds(reading->time) > 9.9 && to_seconds(reading->time) < 21.8;
  });
  EXPECT_EQ(ranges, 6 * 20) << "six ranges in 0.6 s";

  // C appears in the map after 3 to 4 readings 0.6 s apart, and the vehicle goes round it.
  ASSERT_GT(log.first_echo_s, 0);
  ASSERT_GT(log.in_map_s, 0) << sailed.all();
  EXPECT_LE(log.in_map_s - log.first_echo_s, 3.0);
  RecordProperty("seconds_from_echo_to_map", std::to_string(log.in_map_s - log.first_echo_s));
  double nearest = std::numeric_limits<double>::infinity();
  for (const TrueMotion& m : sailed.result.track) {
    nearest = std::min(nearest, (m.state.X_WB.translation.head<2>() - kC).norm() - kRadiusOfC);
  }
  EXPECT_GT(nearest, 2.0);
  const auto replan =
      std::find_if(sailed.result.decisions.begin(), sailed.result.decisions.end(), [](const Decision& d) {
        return d.agent == "navigator" && d.obstacle && d.reason.find("obstacle of the depth map") != std::string::npos;
      });
  ASSERT_NE(replan, sailed.result.decisions.end()) << sailed.all();
  EXPECT_LT((*replan->obstacle - kC).norm(), kRadiusOfC + 12);
  EXPECT_GE(to_seconds(replan->time), log.in_map_s - kLookEvery_s);

  EXPECT_GT(count(pixels_about(*log.last, kC, kRadiusOfC + kDrift), stands), 0u) << "C is in the map at the end";

  // F was charted, the first way led round it, and beams without an echo have removed it.
  const std::size_t plan = find_decision(sailed.result.decisions, "navigator", "plan");
  ASSERT_LT(plan, sailed.result.decisions.size()) << sailed.all();
  EXPECT_NE(sailed.result.decisions[plan].reason.find("a charted obstacle"), std::string::npos);
  EXPECT_GT(count(pixels_about(*log.first, kF, 5), charted_shallow), 200u);
  EXPECT_LT(count(pixels_about(*log.last, kF, 5), charted_shallow), 20u);

  // The depth sonar has corrected the chart.
  const double charted_m = log.first->at(log.first->grid().at(kTooDeep)).depth_m();
  std::size_t corrected = 0;
  for (const DepthPixel& p : pixels_about(*log.last, kTooDeep, 4)) {
    if (p.has(kSeenByDepth) && charted_m - p.depth_m() > 1) ++corrected;
  }
  EXPECT_GT(corrected, 10u);
}

INSTANTIATE_TEST_SUITE_P(Seeds, LakeRaster, testing::Values(1, 8));

}  // namespace
}  // namespace isobath

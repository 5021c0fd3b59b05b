// The loop of scene, pipeline and helm: who is asked when, and what is said of the truth, held against closed forms.
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isobath/run/closed_loop.hpp>
#include <tests/support/straight_helm.hpp>

namespace isobath {
namespace {

using test::StraightHelm;

constexpr const char* kOpenWater = R"(
[scene]
duration_s = 30
[vehicle]
start = [0, 0, 5]
speed = 2
[navigation]
kind = "truth"
)";

Scenario with(const std::string& more) { return parse_scenario(std::string(kOpenWater) + more, "loop.toml"); }

LoopResult run(const Scenario& scenario, StraightHelm& helm, const LoopRequest& request = {}) {
  return run_closed_loop(scenario, helm, request);
}

double hull_of(const Scenario& scenario) { return Simulator(scenario.scene, {}).hull_radius(); }

// ledger: S6-57
TEST(ClosedLoop, TheVehicleGoesWhereTheHelmSteersNotWhereTheSceneSays) {
  const Scenario scenario = with("[[waypoint]]\nnorth = 100\n");
  StraightHelm helm({Angle::degrees(90), 5, 2});
  const LoopResult result = run(scenario, helm);
  const Eigen::Vector3d end = result.track.back().state.X_WB.translation;
  EXPECT_GT(end.y(), 50);
  EXPECT_LT(std::abs(end.x()), 5);
  EXPECT_NEAR(result.duration_s, 30, 0.05);
  EXPECT_NEAR(result.length_m, 60, 2);
  EXPECT_EQ(result.track.size(), result.clearance_m.size());
  EXPECT_NEAR(static_cast<double>(result.track.size()), 300, 2) << "ten a second";
}

TEST(ClosedLoop, ContactIsWhenTheHullReachesTheBody) {
  const Scenario scenario = with("[[sphere]]\nname = \"mine\"\ncentre = [40, 0, 5]\nradius = 1\n");
  StraightHelm helm({Angle{}, 5, 2});
  const LoopResult result = run(scenario, helm);
  EXPECT_NEAR(result.contact_s, (40 - 1 - hull_of(scenario)) / 2, 0.11);
  EXPECT_EQ(result.contact_with, "mine");
  EXPECT_EQ(result.nearest_body, "mine");
  EXPECT_LT(result.min_clearance_m, 0);
}

TEST(ClosedLoop, ClearanceIsFromTheHullToTheNearestBody) {
  const Scenario scenario = with(
      "[[cylinder]]\nname = \"near\"\ncentre = [20, 6, 5]\nradius = 1\nlength = 10\n"
      "[[box]]\nname = \"far\"\ncentre = [30, -9, 5]\nsize = [2, 2, 2]\n");
  StraightHelm helm({Angle{}, 5, 2});
  const LoopResult result = run(scenario, helm);
  EXPECT_NEAR(result.min_clearance_m, 6 - 1 - hull_of(scenario), 1e-3);
  EXPECT_EQ(result.nearest_body, "near");
  EXPECT_EQ(result.contact_s, -1);
  // Abeam of the box, the box is the nearest.
  const auto abeam = static_cast<std::size_t>(30 / 2 * 10);
  EXPECT_NEAR(result.clearance_m[abeam], 8 - hull_of(scenario), 0.1);
}

TEST(ClosedLoop, WithoutBodiesThereIsNothingToBeNearTo) {
  StraightHelm helm({Angle{}, 5, 2});
  const LoopResult result = run(with(""), helm);
  EXPECT_TRUE(std::isinf(result.min_clearance_m));
  EXPECT_EQ(result.nearest_body, "");
}

// The body and the vehicle meet where neither stands at the start; no ping moves the world in between.
TEST(ClosedLoop, MovingBodiesAreMetWhereTheyAre) {
  const Scenario scenario = with(
      "[[sphere]]\nname = \"tow\"\ncentre = [40, 20, 5]\nradius = 0.5\n"
      "path = [[0, 40, 20, 5], [40, 40, -20, 5]]\n");
  StraightHelm helm({Angle{}, 5, 2});
  const LoopResult result = run(scenario, helm);
  // At t s the vehicle is at (2 t, 0), the tow at (40, 20 - t): they meet in 20 s.
  EXPECT_NEAR(result.contact_s, 20 - (0.5 + hull_of(scenario)) / std::sqrt(5.0), 0.11);
}

TEST(ClosedLoop, TheBottomIsTouchedByTheKeel) {
  const Scenario scenario = with("[bottom]\nkind = \"flat\"\ndepth = 10\n");
  StraightHelm helm({Angle{}, 20, 2});
  const LoopResult result = run(scenario, helm);
  EXPECT_GT(result.contact_s, 1);
  EXPECT_EQ(result.contact_with, "the bottom");
  EXPECT_LE(result.min_altitude_m, 0);
  EXPECT_TRUE(std::isinf(result.min_clearance_m)) << "the bottom is no body";
}

TEST(ClosedLoop, EndsSomeSecondsAfterTheMissionHas) {
  StraightHelm helm({Angle{}, 5, 2}, 12);
  const LoopResult result = run(with(""), helm);
  EXPECT_NEAR(result.duration_s, 12 + kWatchAfterEnd_s, 0.2);
  EXPECT_EQ(result.report.phase, MissionPhase::kFinished);
  StraightHelm again({Angle{}, 5, 2}, 12);
  LoopRequest to_the_end;
  to_the_end.stop_when_done = false;
  EXPECT_NEAR(run(with(""), again, to_the_end).duration_s, 30, 0.05);
}

class EventsFirst : public OnboardObserver {
 public:
  explicit EventsFirst(const StraightHelm& helm) : helm_(helm) {}
  void on_event(const Event& event) override {
    EXPECT_EQ(seen.size(), helm_.heard.size());
    seen.emplace_back(event.index(), time_of(event));
  }
  std::vector<std::pair<std::size_t, Time>> seen;

 private:
  const StraightHelm& helm_;
};

TEST(ClosedLoop, ObserversSeeEveryEventBeforeTheHelm) {
  const Scenario scenario = with("[[sonar]]\npreset = \"micron\"\n");
  StraightHelm helm({Angle{}, 5, 2});
  EventsFirst observer(helm);
  LoopRequest request;
  request.observers.push_back(&observer);
  const LoopResult result = run(scenario, helm, request);
  EXPECT_EQ(observer.seen, helm.heard);
  EXPECT_GT(helm.scans, 5);
  EXPECT_EQ(static_cast<std::uint64_t>(helm.scans), result.counts.scans);
}

// ledger: S6-57
TEST(ClosedLoop, IsTheSameBitForBitOnAnyNumberOfThreads) {
  const Scenario scenario = with("[[sonar]]\npreset = \"micron\"\n[[sphere]]\ncentre = [40, 5, 5]\nradius = 1\n");
  const auto track_on = [&](int threads) {
    StraightHelm helm({Angle::degrees(3), 5, 2});
    LoopRequest request;
    request.threads = threads;
    return run(scenario, helm, request);
  };
  const LoopResult one = track_on(1), two = track_on(2);
  ASSERT_EQ(one.track.size(), two.track.size());
  for (std::size_t i = 0; i < one.track.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(one.track[i].state.X_WB.translation[k]),
                std::bit_cast<std::uint64_t>(two.track[i].state.X_WB.translation[k]));
    }
  }
  EXPECT_EQ(one.counts.hits, two.counts.hits);
}

}  // namespace
}  // namespace isobath

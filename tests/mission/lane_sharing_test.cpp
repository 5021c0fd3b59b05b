// The lanes of an area, and their division among vehicles, beside all divisions tried one by one.
#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <isobath/base/random.hpp>
#include <isobath/mission/plan/lane_sharing.hpp>
#include <limits>
#include <numeric>

namespace isobath {
namespace {

using Eigen::Vector2d;

SearchArea area_of(double length_m, double breadth_m, double spacing_m, double heading_deg = 0, double station_m = 30) {
  SearchArea area;
  area.corner = {10, -5};
  area.heading = Angle::degrees(heading_deg);
  area.length_m = length_m;
  area.breadth_m = breadth_m;
  area.spacing_m = spacing_m;
  area.station_m = station_m;
  area.run_out_m = 0;
  return area;
}

// ledger: S2-48
TEST(SearchArea, HasLanesAcrossItsBreadthThatLeadBackAndForth) {
  const std::vector<Lane> lanes = lanes_of(area_of(100, 50, 20, 90));
  ASSERT_EQ(lanes.size(), 3u) << "at most 20 m apart";
  // Heading east: starboard is south.
  EXPECT_NEAR(lanes[0].from_W.x(), 10 - 50.0 / 6, 1e-9);
  EXPECT_NEAR(lanes[0].from_W.y(), -5, 1e-9);
  EXPECT_NEAR(lanes[0].to_W.y(), 95, 1e-9);
  EXPECT_NEAR(lanes[1].from_W.y(), 95, 1e-9) << "the way back";
  EXPECT_NEAR(lanes[2].to_W.x(), 10 - 250.0 / 6, 1e-9);
  EXPECT_EQ(area_of(100, 50, 10).lanes(), 5u);
  EXPECT_EQ(area_of(100, 50, 10).stations(), 5u) << "25 m apart, at most 30";
  EXPECT_TRUE(lanes_of(SearchArea{}).empty());
}

// The vehicle turns beyond the area: the stations at its sides are not the ends of the lane. ledger: S2-48
TEST(SearchArea, HasLanesThatRunOutBeyondItsSides) {
  SearchArea area = area_of(100, 50, 10);
  area.run_out_m = 8;
  const Lane lane = lanes_of(area)[0];
  EXPECT_EQ(area.stations(), 7u);
  std::vector<double> north;
  for (std::size_t i = 0; i < area.stations(); ++i) north.push_back(lane.at(area.share_of_station(i)).x() - 10);
  EXPECT_THAT(north, testing::Pointwise(testing::DoubleNear(1e-9), {-8, 0, 25, 50, 75, 100, 108}));
  EXPECT_NEAR(lanes_of(area)[1].from_W.x() - 10, 108, 1e-9) << "the way back";
}

/// The earliest end by trying every vehicle for every row of every division.
double least_last_s(const std::vector<Lane>& lanes, const std::vector<std::size_t>& open,
                    const std::vector<LaneSailor>& sailors, const SailingRules& rules) {
  double least = std::numeric_limits<double>::infinity();
  for (const bool ascending : {true, false}) {
    std::vector<std::size_t> row = open, order(sailors.size());
    if (!ascending) std::ranges::reverse(row);
    std::iota(order.begin(), order.end(), std::size_t{0});
    do {
      const auto divide = [&](const auto& self, std::size_t i, std::size_t begin, double last_s) -> void {
        if (i + 1 == order.size()) {
          last_s = std::max(last_s, sailing_s(lanes, std::span(row).subspan(begin), sailors[order[i]], rules));
          least = std::min(least, last_s);
          return;
        }
        for (std::size_t end = begin; end <= row.size(); ++end) {
          const auto own = std::span(row).subspan(begin, end - begin);
          self(self, i + 1, end, std::max(last_s, sailing_s(lanes, own, sailors[order[i]], rules)));
        }
      };
      divide(divide, 0, 0, 0);
    } while (std::next_permutation(order.begin(), order.end()));
  }
  return least;
}

// ledger: S2-10 S2-50
TEST(LaneSharing, IsAsGoodAsTheBestOfAllDivisions) {
  Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Lane> lanes =
        lanes_of(area_of(random.uniform(20, 200), random.uniform(20, 100), 10, random.uniform(0, 360)));
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < lanes.size(); ++k) {
      if (random.uniform() < 0.8) open.push_back(k);
    }
    std::vector<LaneSailor> sailors;
    for (std::size_t v = 0; v < 1 + random.index(3); ++v) {
      sailors.push_back({{random.uniform(-100, 200), random.uniform(-100, 200)}, random.uniform(0, 60)});
    }
    const SailingRules rules{1.5, 10};
    const LaneShares shares = share_lanes(lanes, open, sailors, rules);
    if (open.empty()) continue;
    double last_s = 0;
    std::vector<std::size_t> given;
    for (std::size_t v = 0; v < sailors.size(); ++v) {
      last_s = std::max(last_s, sailing_s(lanes, shares.lanes[v], sailors[v], rules));
      given.insert(given.end(), shares.lanes[v].begin(), shares.lanes[v].end());
      const bool sorted = shares.ascending ? std::ranges::is_sorted(shares.lanes[v])
                                           : std::ranges::is_sorted(shares.lanes[v], std::greater<>());
      EXPECT_TRUE(sorted);
    }
    std::ranges::sort(given);
    EXPECT_EQ(given, open) << "each lane once";
    EXPECT_NEAR(shares.last_s, last_s, 1e-9);
    EXPECT_NEAR(shares.last_s, least_last_s(lanes, open, sailors, rules), 1e-9);
  }
}

// ledger: S2-10
TEST(LaneSharing, GivesTwoVehiclesThatStartAlikeHalfOfTheLanesEach) {
  const std::vector<Lane> lanes = lanes_of(area_of(120, 80, 10));
  std::vector<std::size_t> open(8);
  std::iota(open.begin(), open.end(), std::size_t{0});
  const std::vector<LaneSailor> sailors = {{{-5, 15}, 0}, {{-5, 55}, 0}};
  const LaneShares shares = share_lanes(lanes, open, sailors, {1.5, 10});
  EXPECT_EQ(shares.lanes[0].size(), 4u);
  EXPECT_EQ(shares.lanes[1].size(), 4u);
  EXPECT_TRUE(share_lanes(lanes, open, {}, {1.5, 10}).lanes.empty()) << "nobody";
  const std::vector<LaneVisit> visits = visits_of(lanes, shares.lanes[0], sailors[0].place_W);
  EXPECT_EQ(stations_of(visits, area_of(120, 40, 10, 0, 120)), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7}))
      << "back and forth";
  const std::vector<LaneVisit> back = {{2, true}};
  EXPECT_EQ(stations_of(back, area_of(120, 40, 10, 0, 60)), (std::vector<std::size_t>{8, 7, 6}));
}

// ledger: S2-10
TEST(LaneSharing, DividesManyLanesAmongManyVehiclesInTheirOrder) {
  const std::vector<Lane> lanes = lanes_of(area_of(200, 640, 10));
  std::vector<std::size_t> open(64);
  std::iota(open.begin(), open.end(), std::size_t{0});
  std::vector<LaneSailor> sailors;
  for (int v = 0; v < 8; ++v) sailors.push_back({{0, 80.0 * (7 - v)}, 0});
  const LaneShares shares = share_lanes(lanes, open, sailors, {1.5, 10});
  for (const auto& own : shares.lanes) EXPECT_EQ(own.size(), 8u);
}

}  // namespace
}  // namespace isobath

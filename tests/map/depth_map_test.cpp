// The depth map: trees, the local window over them, shifts, blocks, snapshots.
#include <gtest/gtest.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/map/depth/mission_map.hpp>
#include <map>
#include <rapidcheck/gtest.h>
#include <tests/support/count_allocations.hpp>
#include <type_traits>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector2d;

DepthMapConfig small() {
  DepthMapConfig config;
  config.window_pixels = 128;
  config.area_m = 256;  // 512 pixels a side
  return config;
}

DepthMap fresh(const DepthMapConfig& config, const Vector2d& start = {0, 0}) {
  const DepthArea area = area_of(config);
  return DepthMap(config, area, DepthTrees(area.levels), start);
}

DepthPixel sensed(double depth_m, int confidence) {
  return {DepthPixel::word_of_depth(depth_m), DepthPixel::word_of_state(confidence, kSensed | kSeenByDepth, 1)};
}

void shift_to(DepthMap& map, const Vector2d& place) {
  if (const auto target = map.wanted(place)) {
    const auto shift = map.begin_shift(*target);
    shift->run();
    map.finish_shift(*shift);
  }
}

// ledger: S1-27, S1-E02
TEST(DepthMap, the_window_is_256_m_of_half_metre_pixels_and_blocks_are_4_m) {
  const DepthMap map = fresh({});
  EXPECT_EQ(map.window().pixels(), 512);
  EXPECT_DOUBLE_EQ(map.window().pixels() * map.grid().pixel_m, 256);
  EXPECT_DOUBLE_EQ(DepthBlock::kPixels * map.grid().pixel_m, 4);
}

// ledger: S1-28
RC_GTEST_PROP(PixelGridProperty, points_and_pixels_convert_both_ways_and_floor, ()) {
  const PixelGrid grid{{100.25, -40.5}, 0.5};
  const Pixel pixel{*rc::gen::inRange(-100000, 100000), *rc::gen::inRange(-100000, 100000)};
  RC_ASSERT(grid.at(grid.centre(pixel)) == pixel);
  const Vector2d inside = grid.centre(pixel) + Vector2d{-0.2499, 0.2499};
  RC_ASSERT(grid.at(inside) == pixel);
}

// ledger: S1-29
TEST(DepthMap, a_straight_run_shifts_every_64_m_and_swinging_about_the_line_does_not) {
  DepthMapConfig config;
  config.area_m = 2048;
  DepthMap map = fresh(config);
  std::vector<double> shifts_at;
  for (double north = 0; north < 300; north += 0.9) {  // 0.6 s at 1.5 m/s
    if (map.wanted({north, 0})) {
      shift_to(map, {north, 0});
      shifts_at.push_back(north);
    }
  }
  ASSERT_EQ(shifts_at.size(), 4U);  // 64, 128, 192, 256 m
  for (std::size_t i = 0; i < shifts_at.size(); ++i) EXPECT_NEAR(shifts_at[i], 64.0 * double(i + 1), 16.9);
  DepthMap other = fresh(config);
  int shifts = 0;
  for (int i = 0; i < 100; ++i) {
    const Vector2d place{63.5 + (i % 2), 0};
    shifts += other.wanted(place) ? 1 : 0;
    shift_to(other, place);
  }
  EXPECT_EQ(shifts, 1);
}

// ledger: S1-19, S1-30, S1-34, S1-35
// Random pixels written while the window wanders, against a plain array of the whole area.
RC_GTEST_PROP(DepthMapProperty, what_was_written_is_there_wherever_the_window_went, ()) {
  const DepthMapConfig config = small();
  DepthMap map = fresh(config);
  std::map<std::pair<int, int>, DepthPixel> plain;
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  Vector2d place{0, 0};
  for (int leg = 0; leg < 12; ++leg) {
    place = {random.uniform(-100, 100), random.uniform(-100, 100)};
    shift_to(map, place);
    const PixelWindow window = map.window().extent();
    for (int i = 0; i < 50; ++i) {
      const Pixel p{window.column + int(random.index(128)), window.row + int(random.index(128))};
      const DepthPixel pixel = sensed(0.01 * double(random.index(3000)), int(random.index(21)));
      map.window().set(p, pixel);
      plain[{p.column, p.row}] = pixel;
    }
  }
  map.flush();
  const auto snapshot = map.snapshot();
  for (const auto& [p, pixel] : plain) {
    RC_ASSERT(snapshot->at({p.first, p.second}) == pixel);
    RC_ASSERT(map.trees().at({p.first, p.second}) == pixel);
  }
  std::vector<DepthPixel> all(std::size_t{512} * 512);
  snapshot->read({0, 0, 512, 512}, all);
  std::size_t known = 0;
  for (const DepthPixel& pixel : all) known += pixel.known() ? 1 : 0;
  RC_ASSERT(known == plain.size());
}

// ledger: S1-38, S1-40
RC_GTEST_PROP(DepthMapProperty, blocks_are_the_least_and_greatest_of_their_pixels_after_any_updates, ()) {
  DepthMap map = fresh(small());
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  const PixelWindow window = map.window().extent();
  for (int i = 0; i < 4000; ++i) {
    const Pixel p{window.column + int(random.index(24)), window.row + int(random.index(24))};
    map.window().set(p, random.uniform() < 0.02 ? DepthPixel{} : sensed(0.01 * double(random.index(40)), 6));
  }
  const auto snapshot = map.snapshot();
  const PixelWindow blocks{window.column / 8 - 1, window.row / 8 - 1, 6, 6};  // reaches into what lies outside
  std::vector<DepthBlock> found(36);
  snapshot->read_blocks(blocks, found);
  for (int b = 0; b < 36; ++b) {
    DepthBlock expected;
    expected.unknown = 0;
    for (int k = 0; k < 64; ++k) {
      const DepthPixel pixel = snapshot->at({(blocks.column + b % 6) * 8 + k % 8, (blocks.row + b / 6) * 8 + k / 8});
      if (!pixel.known()) {
        ++expected.unknown;
        continue;
      }
      expected.min_cm = std::min(expected.min_cm, pixel.depth_cm());
      expected.max_cm = std::max(expected.max_cm, pixel.depth_cm());
    }
    RC_ASSERT(found[std::size_t(b)] == expected);
  }
}

// What a planner asks of it changes nothing. ledger: S1-03, S1-31, S2-03
TEST(DepthMap, a_snapshot_stays_what_it_was) {
  DepthMap map = fresh(small());
  const Pixel p = map.grid().at({3, 4});
  map.window().set(p, sensed(5, 6));
  const auto before = map.snapshot();
  map.window().set(p, sensed(7, 8));
  shift_to(map, {0, 100});
  const auto after = map.snapshot();
  EXPECT_EQ(before->at(p), sensed(5, 6));
  EXPECT_EQ(after->at(p), sensed(7, 8));
  EXPECT_LT(before->version(), after->version());
}

// ledger: S1-31
TEST(DepthMap, writing_during_a_shift_does_not_disturb_it_and_the_old_window_answers_until_the_swap) {
  DepthMap map = fresh(small());
  const Pixel leaving = map.grid().at({0, -30}), staying = map.grid().at({0, 10});
  map.window().set(leaving, sensed(5, 6));
  map.window().set(staying, sensed(6, 6));
  const auto shift = map.begin_shift(*map.wanted({0, 33}));
  map.window().set(leaving, sensed(1, 1));  // after the moment of the shift: for the old window only
  map.window().set(staying, sensed(2, 2));
  shift->run();
  EXPECT_EQ(map.window().at(leaving), sensed(1, 1));
  EXPECT_EQ(shift->window().at(staying), sensed(6, 6));
  map.finish_shift(*shift);
  EXPECT_EQ(map.window().at(staying), sensed(6, 6));
  EXPECT_EQ(map.snapshot()->at(leaving), sensed(5, 6));
}

// ledger: S1-16, S1-17
TEST(DepthTrees, unexplored_water_costs_one_node_and_reads_as_the_base) {
  const DepthTrees trees(14);
  EXPECT_EQ(trees.sensed().statistics().words, 1U);
  EXPECT_EQ(trees.state().statistics().words, 1U);
  EXPECT_FALSE(trees.at({5000, 5000}).known());
  const std::uint32_t base = DepthPixel::word_of_state(5, 0, 0);
  std::vector<std::uint32_t> prior(256, DepthPixel::word_of_depth(12)), state(256, base);
  const DepthTrees charted(RegionQuadtree::from_raster(14, prior, 16, 16, 0),
                           RegionQuadtree::from_raster(14, state, 16, 16, 0));
  EXPECT_EQ(charted.at({3, 3}).confidence(), 5);
  EXPECT_DOUBLE_EQ(charted.at({3, 3}).depth_m(), 12);
  EXPECT_EQ(charted.at({100, 3}).confidence(), 0);
}

TEST(DepthMap, what_lies_outside_the_area_is_counted_not_kept) {
  DepthMap map = fresh(small(), {127, 0});
  const Pixel beyond = map.grid().at({140, 0});
  ASSERT_TRUE(map.window().contains(beyond));
  map.window().set(beyond, sensed(5, 6));
  map.flush();
  EXPECT_EQ(map.pixels_lost(), 1U);
  EXPECT_FALSE(map.trees().at(beyond).known());
}

TEST(DepthMap, impossible_areas_are_refused) {
  DepthMapConfig config;
  config.window_pixels = 500;
  EXPECT_THROW(area_of(config), Error);
  config.window_pixels = 512;
  config.area_m = 500000;
  config.pixel_m = 0.05;
  EXPECT_THROW(area_of(config), Error);
}

TEST(DepthMap, steady_writing_and_snapshots_allocate_no_tiles_for_ever) {
  DepthMap map = fresh(small());
  const Pixel p = map.grid().at({0, 0});
  map.window().set(p, sensed(1, 1));
  const std::uint64_t before = test::allocations();
  for (int i = 0; i < 1000; ++i) map.window().set(p, sensed(0.01 * i, 3));
  EXPECT_EQ(test::allocations(), before);
}

// ledger: S1-E05
TEST(DepthMap, a_sensed_depth_is_remembered_across_a_shift_however_unsure_it_has_become) {
  DepthMap map = fresh(small());
  const Pixel p = map.grid().at({0, -30});
  const DepthPixel doubtful = sensed(3, 2);  // below the base of charted depths
  map.window().set(p, doubtful);
  shift_to(map, {0, 100});
  ASSERT_FALSE(map.window().contains(p));
  EXPECT_EQ(map.snapshot()->at(p), doubtful);
}

// ledger: S1-36, S1-39
TEST(DepthMap, only_the_finest_map_is_written_to_and_the_others_follow_it) {
  static_assert(std::is_const_v<std::remove_reference_t<decltype(std::declval<DepthSnapshot&>().trees())>>);
  static_assert(std::is_const_v<std::remove_reference_t<decltype(std::declval<DepthSnapshot&>().window())>>);
  static_assert(std::is_const_v<std::remove_reference_t<decltype(std::declval<DepthMap&>().trees())>>);
  DepthMap map = fresh(small());
  const Pixel p = map.grid().at({5, 5});
  map.window().set(p, sensed(4, 6));
  EXPECT_FALSE(map.trees().at(p).known()) << "the trees learn of it when the window is flushed";
  std::vector<DepthBlock> block(1);
  map.snapshot()->read_blocks({p.column / 8, p.row / 8, 1, 1}, block);
  EXPECT_EQ(block[0].min_cm, 400) << "the blocks at once";
  const Pixel cell{p.column / MissionCell::kPixels, p.row / MissionCell::kPixels};
  EXPECT_GT(MissionMap(*map.snapshot()).at(cell).known, 0) << "the mission level when it is made";
  map.flush();
  EXPECT_EQ(map.trees().at(p), sensed(4, 6));
}

// ledger: S1-37, S1-E11
TEST(MissionMap, cells_hold_the_mean_of_the_known_depths_of_the_finest_map) {
  DepthMap map = fresh(small());
  const Pixel corner = map.grid().at({10, 10});
  const Pixel cell{corner.column / MissionCell::kPixels, corner.row / MissionCell::kPixels};
  EXPECT_EQ(MissionMap(*map.snapshot()).at(cell).known, 0);
  double sum = 0;
  for (int i = 0; i < 9; ++i) {
    map.window().set({corner.column + i % 3, corner.row + i / 3}, sensed(4 + i, 6));
    sum += 4 + i;
  }
  const MissionMap mission(*map.snapshot());
  EXPECT_DOUBLE_EQ(mission.grid().pixel_m, 64);
  EXPECT_NEAR(1609.344 / mission.grid().pixel_m, 25, 0.2);  // about 25 a mile
  EXPECT_NEAR(mission.at(cell).mean_depth_m, sum / 9, 1e-9);
  EXPECT_NEAR(mission.at(cell).known, 9.0 / (128 * 128), 1e-12);
}

// Against the area of the polygon, and its hole. ledger: S1-37
TEST(MissionMap, a_threat_fills_the_cells_by_the_share_that_it_covers) {
  const DepthMap map = fresh(small());
  MissionMap mission(*map.snapshot());
  const std::vector<Polygon> rings = {{{-70, -90}, {60, -90}, {100, 40}, {-70, 110}},
                                      {{0, 0}, {20, 0}, {20, 24}, {0, 24}}};
  mission.add_threat(rings, 0.001, 0.002);
  double detection = 0;
  for (int row = 0; row < mission.extent().height; ++row) {
    for (int column = 0; column < mission.extent().width; ++column) {
      const MissionCell& cell = mission.at({column, row});
      EXPECT_DOUBLE_EQ(cell.destruction_per_m, 2 * cell.detection_per_m);
      EXPECT_LE(cell.detection_per_m, 0.001 + 1e-12);
      detection += cell.detection_per_m * 64 * 64;
    }
  }
  const double covered = std::abs(area(rings[0])) - std::abs(area(rings[1]));
  EXPECT_NEAR(detection / 0.001, covered, 0.02 * covered);
  EXPECT_DOUBLE_EQ(mission.at(mission.grid().at({-10, -40})).detection_per_m, 0.001);
  EXPECT_EQ(mission.at(mission.grid().at({120, -120})).detection_per_m, 0);
}

}  // namespace
}  // namespace isobath

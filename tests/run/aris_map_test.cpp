// A map of six frames of a real imaging sonar, shorter than any warm-up, with the default configuration: what a person
// sees in the frames is in the map, and the water before it is free.
//
// Seen by eye: no target before 14 m; two bright lines that come nearer to starboard and a third that turns back, from
// 15.5 to 18.5 m; and single bright spots behind them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>
#include <isobath/io/open_source.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/run/run_source.hpp>
#include <isobath/world/voxel_model.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {

class ArisVoxels : public ResultSink {
 public:
  void on_ping(const PosedPing& posed) override {
    model.update(posed);
    for (int b = 0; b < posed.decisions.beams(); ++b) {
      for (int k = 0; k < posed.decisions.bins(); ++k) decided += posed.decisions.usable(k);
    }
  }
  void on_scan(const ScanResult&) override {}
  VoxelModel model{VoxelModelConfig{}};
  std::int64_t decided = 0;
};

/// Mean of the six frames over boxes of `kTall` samples by `kWide` beams, less the median level of the boxes of that
/// range and of those of that beam: where it is brightest, somebody who looks at the frames sees something.
struct BrightBox {
  double range_m, azimuth, excess;
};
std::vector<BrightBox> boxes_of(const std::vector<Ping>& frames) {
  constexpr int kTall = 20, kWide = 3;
  const int rows = frames[0].window.bins / kTall, columns = frames[0].fan->beams() / kWide;
  std::vector<std::vector<double>> mean(static_cast<std::size_t>(rows), std::vector<double>(columns, 0));
  for (const Ping& frame : frames) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        for (int i = 0; i < kTall * kWide; ++i) {
          mean[r][c] += static_cast<double>(frame.intensity(c * kWide + i % kWide, r * kTall + i / kWide)) /
                        (kTall * kWide * static_cast<double>(frames.size()));
        }
      }
    }
  }
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
  };
  for (auto& row : mean) {
    const double level = median(row);
    for (double& v : row) v -= level;
  }
  std::vector<BrightBox> boxes;
  for (int c = 0; c < columns; ++c) {
    std::vector<double> column;
    for (const auto& row : mean) column.push_back(row[c]);
    const double level = median(column);
    for (int r = 0; r < rows; ++r) {
      boxes.push_back({frames[0].window.centre(r * kTall + kTall / 2),
                       frames[0].fan->azimuth[static_cast<std::size_t>(c * kWide + kWide / 2)].radians(),
                       mean[r][c] - level});
    }
  }
  std::sort(boxes.begin(), boxes.end(), [](const BrightBox& a, const BrightBox& b) { return a.excess > b.excess; });
  return boxes;
}

/// Likeliest voxel within one of a place at the sonar's depth.
double likeliest_about(const VoxelMap& map, const Eigen::Vector3d& p) {
  const VoxelIndex at = map.voxel_at(p);
  double most = 0;
  for (int n = 0; n < 27; ++n) {
    const VoxelIndex v = at + VoxelIndex(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
    if (map.is_seen(v)) most = std::max(most, map.probability(v));
  }
  return most;
}

// ledger: S5-31 S6-70
TEST(ArisMap, OfSixFramesHoldsWhatAPersonSeesInThem) {
  ISOBATH_NEEDS_DATA(folder, "aris-sample");
  InputConfig whole;
  whole.max_bins = 0;
  std::vector<Ping> frames;
  const auto raw = open_source(folder / "sample.aris", whole);
  while (const auto event = raw->next()) frames.push_back(std::get<Ping>(*event));
  ASSERT_EQ(frames.size(), 6u);

  ArisVoxels sink;
  Pipeline pipeline({}, sink);
  const auto source = open_run_source(folder / "sample.aris", {});
  for (Event& event : listen_ahead(*source, pipeline)) pipeline.on_event(std::move(event));
  while (auto event = source->next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  EXPECT_EQ(pipeline.undecided(), "");
  EXPECT_EQ(sink.decided, 6 * 48 * 1000) << "all bins of all frames, two samples each";
  const VoxelMap& map = *sink.model.map();
  EXPECT_EQ(map.voxel_m(), 0.25);

  const auto boxes = boxes_of(frames);
  constexpr std::size_t kBrightest = 30;
  std::size_t sure = 0, suspected = 0;
  for (std::size_t i = 0; i < kBrightest; ++i) {
    const Eigen::Vector3d p =
        boxes[i].range_m * Eigen::Vector3d(std::cos(boxes[i].azimuth), std::sin(boxes[i].azimuth), 0);
    EXPECT_GT(boxes[i].range_m, 15) << "the brightest are the lines and what is behind them";
    const double most = likeliest_about(map, p);
    sure += most >= map.config().occupied ? 1 : 0;
    suspected += most > 2 * map.config().prior ? 1 : 0;
  }
  std::int64_t water = 0, free = 0, wrong = 0;
  for_each_seen(map, [&](const VoxelIndex& v) {
    const Eigen::Vector3d p = map.centre_of(v);
    if (p.norm() > 14) return;
    ++water;
    free += map.space(v) == Space::kFree ? 1 : 0;
    wrong += map.space(v) == Space::kOccupied ? 1 : 0;
  });
  std::printf(
      "of the %zu brightest places %zu occupied, %zu suspected or occupied; of %lld voxels of water before 14 m "
      "%lld free, %lld occupied\n",
      kBrightest, sure, suspected, static_cast<long long>(water), static_cast<long long>(free),
      static_cast<long long>(wrong));
  EXPECT_GE(suspected, kBrightest - 3);
  EXPECT_GE(sure, kBrightest * 2 / 3);
  EXPECT_GT(static_cast<double>(free), 0.95 * static_cast<double>(water));
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace isobath

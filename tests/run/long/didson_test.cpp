// Obstacles in frames of a real imaging sonar (DIDSON), with the default configuration and nothing calibrated: in water
// without targets there are none, and a real target that stands in the same water is one.
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/run/run_source.hpp>
#include <tests/support/data.hpp>
#include <tests/support/kept_scans.hpp>

namespace isobath {
namespace {

std::vector<Ping> background_of(const std::filesystem::path& folder) {
  std::vector<Ping> pings;
  const auto source = open_source(folder, {});
  while (const auto event = source->next()) pings.push_back(std::get<Ping>(*event));
  return pings;
}

/// As the program runs a log: it listens to the first frames before it decides any.
test::ScanKeeper run_as_log(const std::filesystem::path& folder, const Configuration& configuration) {
  test::ScanKeeper keeper;
  Pipeline pipeline(configuration, keeper);
  const auto source = open_run_source(folder, configuration);
  for (Event& event : listen_ahead(*source, pipeline)) pipeline.on_event(std::move(event));
  while (auto event = source->next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  return keeper;
}

/// As on a vehicle: each frame is decided by what was heard before it.
test::ScanKeeper run_live(const std::vector<Ping>& pings, const Configuration& configuration) {
  test::ScanKeeper keeper;
  Pipeline pipeline(configuration, keeper);
  for (const Ping& ping : pings) pipeline.on_event(ping);
  pipeline.finish();
  return keeper;
}

std::size_t obstacles_of(const test::ScanKeeper& keeper) {
  std::size_t count = 0;
  for (const auto& scan : keeper.scans) count += scan.obstacles.size();
  return count;
}

// 87 frames of water without targets, 12.6 s. The thresholds of before made an obstacle of the loud water ahead in each
// scan. ledger: S6-06 S6-30
TEST(DidsonObstacles, WaterWithoutTargetsRaisesFewerThanFive) {
  ISOBATH_NEEDS_DATA(folder, "didson-hull");
  const std::vector<Ping> pings = background_of(folder);
  ASSERT_EQ(pings.size(), 87u);
  const test::ScanKeeper log = run_as_log(folder, test::configured());
  const test::ScanKeeper live = run_live(pings, test::configured({"map.fan_scan_s=0"}));
  std::printf("as a log: %zu false obstacles in %zu scans; live, each frame a scan: %zu in %zu\n", obstacles_of(log),
              log.scans.size(), obstacles_of(live), live.scans.size());
  EXPECT_EQ(log.pings, 87);
  EXPECT_EQ(live.scans.size(), 87u);
  EXPECT_LT(obstacles_of(log), 5u);
  EXPECT_LT(obstacles_of(live), 5u);
}

/// A frame of water with the marked echoes of another frame in it, and what is within three bins or one beam of them.
Ping with_target(const Ping& water, const MarkedFrame& frame) {
  const int beams = water.fan->beams(), bins = water.window.bins;
  auto samples = std::make_shared<std::vector<std::uint8_t>>(static_cast<std::size_t>(beams) * bins);
  const auto at = [&](int b, int k) { return static_cast<std::size_t>(b) * bins + static_cast<std::size_t>(k); };
  for (int b = 0; b < beams; ++b) {
    for (int k = 0; k < bins; ++k) (*samples)[at(b, k)] = static_cast<std::uint8_t>(water.intensity(b, k));
  }
  for (int b = 0; b < beams; ++b) {
    for (int k = 0; k < bins; ++k) {
      if (!frame.marked[at(b, k)]) continue;
      for (int i = std::max(0, b - 1); i <= std::min(beams - 1, b + 1); ++i) {
        for (int j = std::max(0, k - 3); j <= std::min(bins - 1, k + 3); ++j) {
          const auto echo = static_cast<std::uint8_t>(frame.ping.intensity(i, j));
          (*samples)[at(i, j)] = std::max((*samples)[at(i, j)], echo);
        }
      }
    }
  }
  Ping ping = water;
  ping.intensity = Intensities(samples->data(), SampleType::kU8, beams, bins, bins, 1);
  ping.storage = std::move(samples);
  return ping;
}

/// Range and bearing of the nearest marked cell.
struct Mark {
  double range_m = 0;
  Angle azimuth;
};
std::optional<Mark> nearest_mark(const MarkedFrame& frame) {
  const Ping& ping = frame.ping;
  for (int k = 0; k < ping.window.bins; ++k) {
    for (int b = 0; b < ping.fan->beams(); ++b) {
      if (frame.marked[static_cast<std::size_t>(b) * ping.window.bins + static_cast<std::size_t>(k)])
        return Mark{ping.window.centre(k), ping.fan->azimuth[static_cast<std::size_t>(b)]};
    }
  }
  return std::nullopt;
}

// The water is empty because nothing is in it, not because the detector is deaf: each target that somebody marked,
// put into all frames from the 31st on, is an obstacle within half a metre of its nearest mark.
TEST(DidsonObstacles, MarkedTargetsInTheSameWaterAreObstacles) {
  ISOBATH_NEEDS_DATA(folder, "didson-hull");
  std::vector<Ping> water = background_of(folder);
  water.resize(60);
  int targets = 0, found = 0;
  for (const MarkedFrame& frame : read_marked_frames(folder, {})) {
    const std::optional<Mark> mark = frame.background ? std::nullopt : nearest_mark(frame);
    if (!mark) continue;
    ++targets;
    std::vector<Ping> pings = water;
    for (std::size_t i = 30; i < pings.size(); ++i) pings[i] = with_target(water[i], frame);
    const test::ScanKeeper keeper = run_live(pings, test::configured());
    const Eigen::Vector2d place = mark->range_m * Eigen::Vector2d(cos(mark->azimuth), sin(mark->azimuth));
    int scans = 0, at_mark = 0;
    std::optional<double> first_s;
    std::size_t most = 0;
    for (const auto& scan : keeper.scans) {
      if (scan.time < pings[30].time) continue;
      ++scans;
      most = std::max(most, scan.obstacles.size());
      const bool there = std::any_of(scan.obstacles.begin(), scan.obstacles.end(), [&](const Obstacle& o) {
        return std::any_of(o.outline.begin(), o.outline.end(),
                           [&](const Eigen::Vector2d& p) { return (p - place).norm() < 0.5; });
      });
      at_mark += there;
      if (there && !first_s) first_s = to_seconds(scan.time - pings[30].time);
    }
    std::printf(
        "target at %.2f m, %+.1f deg: an obstacle there in %d of %d scans, first after %.1f s; most %zu at once\n",
        mark->range_m, mark->azimuth.degrees(), at_mark, scans, first_s.value_or(-1), most);
    found += 4 * at_mark >= 3 * scans;
  }
  EXPECT_EQ(targets, 6);
  EXPECT_EQ(found, targets);
}

}  // namespace
}  // namespace isobath

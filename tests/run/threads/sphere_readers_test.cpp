// A live run whose spherical grid four processes read while it is mapped and while the agents plan on it (the paper's
// figure 1).
#include <array>
#include <atomic>
#include <gtest/gtest.h>
#include <isobath/map/spherical/spherical_clusters.hpp>
#include <isobath/map/spherical/spherical_passage.hpp>
#include <isobath/perception/scan_control.hpp>
#include <isobath/perception/tangential_clusters.hpp>
#include <isobath/run/closed_loop.hpp>
#include <map>
#include <mutex>
#include <tests/support/data.hpp>
#include <thread>

namespace isobath {
namespace {

constexpr const char* kPoleForReaders = R"(
[scene]
title = "A pole beside the way"
duration_s = 20
[vehicle]
file = "vehicles/hovering_rov.toml"
dynamic = true
start = [0, 0, 10]
speed = 0.8
[[cylinder]]
name = "pole"
centre = [20, 6, 10]
radius = 0.6
length = 20
[[sonar]]
preset = "micron"
sector_deg = 120
range_m = 40
bins = 80
interval_s = 0.03
[mission]
title = "Past a pole"
speed = 0.8
[[mission_point]]
north = 40
depth_m = 10
)";

/// What navigator, scan control, modelling and positioning make of a snapshot, in one number each.
using ReaderWork = double (*)(const GridSnapshot&);
constexpr std::array<ReaderWork, 4> kReaderWorks{
    [](const GridSnapshot& s) {
      return way_ahead(s.grid, {0, 1, 0}, 20, 0.5).clear_m;
    },
    [](const GridSnapshot& s) { return ScanControl().next(s.grid, Angle{}).worth; },
    [](const GridSnapshot& s) {
      const auto planes = tangential_clusters(echoes_of(s.grid, 0.3)).planes;
      return static_cast<double>(clusters(s.grid, 0.3).size() + 100 * planes.size());
    },
    [](const GridSnapshot& s) {
      Eigen::Vector3d sum = s.X_WB.translation;
      for (const Eigen::Vector3d& p : echoes_of(s.grid, 0)) sum += world_from_grid_axes(p);
      return sum.sum();
    },
};

/// Hands the snapshots of the run to reader threads, which work on each new one until the run ends.
class SphereReaders : public OnboardObserver {
 public:
  struct Found {
    std::shared_ptr<const GridSnapshot> snapshot;
    double result = 0;
  };
  using Results = std::map<std::uint64_t, Found>;

  SphereReaders() {
    for (std::size_t r = 0; r < 4; ++r) threads_.emplace_back([this, r] { read(r); });
  }
  /// Ends the readers, who finish with the last snapshot.
  std::array<Results, 4> finish() {
    over_ = true;
    for (std::thread& thread : threads_) thread.join();
    return found_;
  }
  void on_sphere(Time, const std::shared_ptr<const GridSnapshot>& sphere) override {
    const std::lock_guard lock(mutex_);
    newest_ = sphere;
  }

 private:
  void read(std::size_t r) {
    std::uint64_t version = 0;
    for (bool last = false; !last;) {
      last = over_;
      std::shared_ptr<const GridSnapshot> snapshot;
      {
        const std::lock_guard lock(mutex_);
        snapshot = newest_;
      }
      if (!snapshot || snapshot->version == version) {
        std::this_thread::yield();
        continue;
      }
      EXPECT_GT(snapshot->version, version) << "never an older one";
      version = snapshot->version;
      found_[r][version] = {snapshot, kReaderWorks[r](*snapshot)};
    }
  }

  std::mutex mutex_;
  std::shared_ptr<const GridSnapshot> newest_;
  std::atomic<bool> over_ = false;
  std::array<Results, 4> found_;
  std::vector<std::thread> threads_;
};

// Each finds in a snapshot, while the run goes on, what it finds alone with it afterwards. ledger: S4-48
TEST(SphereReaders, FourProcessesReadTheGridOfALiveRunAsItWasAtTheEndOfAScan) {
  const Scenario scenario = parse_scenario(kPoleForReaders, (test::source_folder() / "readers.toml").string());
  SphereReaders readers;
  LoopRequest request;
  request.live = true;
  request.observers = {&readers};
  request.configuration.mission.chart_room.sphere = true;  // the chart room reads it, too, in its own thread
  run_closed_loop(scenario, request);
  const std::array<SphereReaders::Results, 4> results = readers.finish();
  for (std::size_t r = 0; r < results.size(); ++r) {
    const SphereReaders::Results& found = results[r];
    ASSERT_FALSE(found.empty());
    for (const auto& [version, read] : found) {
      EXPECT_EQ(read.result, kReaderWorks[r](*read.snapshot)) << "reader " << r << ", scan " << version;
    }
    EXPECT_GE(found.rbegin()->first, 5u) << "scans";
    EXPECT_GT(found.rbegin()->second.snapshot->grid.cells().size(), 20u);
  }
}

}  // namespace
}  // namespace isobath

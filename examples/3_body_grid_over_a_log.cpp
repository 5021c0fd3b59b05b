// Maps a log into the body grid, the occupancy of the water around the vehicle, and detects obstacles, scan by scan.
//
//   3_body_grid_over_a_log [LOG]    without LOG a simulated vehicle nears a mooring buoy
#include <cstdio>
#include <isobath/io/open_source.hpp>
#include <isobath/map/occupancy/whole_obstacle.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/scenario/scenario.hpp>

using namespace isobath;

std::unique_ptr<Source> open_log(const char* file) {
  if (file) return open_source(file);
  return std::make_unique<SimulatedSource>(open_scene(), SimulationConfig{.duration_s = 25});
}

/// Gets the results of the pipeline, and keeps the obstacles of the last scan.
class Obstacles : public ResultSink {
 public:
  void on_ping(const PosedPing&) override {}
  void on_scan(const ScanResult& scan) override {
    const Detection& found = scan.detection;
    outlines.clear();
    for (const Obstacle& obstacle : found.obstacles) outlines.push_back(world_outline(obstacle, found.X_WB));
    if (found.obstacles.empty()) return;
    const Obstacle& nearest = found.obstacles.front();  // convex pieces, nearest first
    std::printf("scan %d at %s: %zu obstacle(s), the nearest %.1f m off at %.0f deg, existence %.2f, %u echoes\n",
                scan.number, to_text(found.time).c_str(), whole_obstacles(found.obstacles).size(), nearest.range_m,
                nearest.bearing.degrees(), nearest.existence, nearest.hits);
  }
  std::vector<Polygon> outlines;  ///< north, east
};

/// The grid from above; the vehicle looks up.
void draw(const BodyGrid& grid, const std::filesystem::path& file) {
  PlanPicture picture({-10, 50, -35, 35}, 700, {"Body grid", "forward (m)", "starboard (m)"});
  const double prior = grid.config().prior;
  picture.raster([&](double x, double y) {
    const auto cell = grid.cell_at({x, y});
    return occupancy_colour(cell ? grid.probability(*cell) : prior, prior);
  });
  picture.range_rings({0, 0}, 10);
  picture.vehicle({0, 0}, 0);
  picture.finish({{occupancy_colour(0.98, prior), "occupied"},
                  {occupancy_colour(prior, prior), "unknown"},
                  {occupancy_colour(0.001, prior), "free"}});
  picture.save(file);
}

int main(int argc, char** argv) {
  const std::unique_ptr<Source> log = open_log(argv[1]);
  Obstacles obstacles;
  Pipeline pipeline({}, obstacles);
  while (auto event = log->next()) pipeline.on_event(std::move(*event));
  pipeline.finish();

  if (!pipeline.grid()) return std::printf("no ping could be mapped\n"), 1;
  draw(*pipeline.grid(), "body_grid.png");
  if (argc > 1) return 0;
  const Eigen::Vector2d buoy(45, 4);
  for (const Polygon& outline : obstacles.outlines) {
    if ((nearest_point(outline, buoy) - buoy).norm() < 1.5) return 0;
  }
  return std::printf("no obstacle where the buoy is\n"), 1;
}

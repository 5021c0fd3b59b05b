// A sink that keeps the obstacles of every scan, and a function that runs an input through the pipeline.
#pragma once

#include <isobath/configuration/configuration.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <string>
#include <vector>

namespace isobath::test {

struct KeptScan {
  int number = 0;
  Time time;
  Pose X_WB;
  std::vector<Obstacle> obstacles;
};

class ScanKeeper : public ResultSink {
 public:
  void on_ping(const PosedPing&) override { ++pings; }
  void on_scan(const ScanResult& scan) override {
    scans.push_back({scan.number, scan.detection.time, scan.detection.X_WB, scan.detection.obstacles});
  }
  int pings = 0;
  std::vector<KeptScan> scans;
};

/// The configuration with settings such as "input.set=noisy".
inline Configuration configured(const std::vector<std::string>& settings = {}) {
  Configuration configuration;
  auto all = sections(configuration);
  for (const std::string& setting : settings) set_from_text(setting, all);
  return configuration;
}

inline ScanKeeper scans_of(const std::filesystem::path& input, const Configuration& configuration) {
  ScanKeeper keeper;
  const auto source = open_source(input, configuration.input);
  Pipeline pipeline(configuration, keeper);
  while (auto event = source->next()) pipeline.on_event(std::move(*event));
  pipeline.finish();
  return keeper;
}

/// Distance to the first outline along a bearing, not nearer than `from`.
inline std::optional<double> first_along(const std::vector<Obstacle>& obstacles, double bearing_deg, double from) {
  const Angle bearing = Angle::degrees(bearing_deg);
  const Eigen::Vector2d ray(cos(bearing), sin(bearing));
  std::optional<double> first;
  for (const Obstacle& o : obstacles) {
    const auto hit = ray_hit(o.outline, Eigen::Vector2d::Zero(), ray);
    if (hit && *hit > from && (!first || *hit < *first)) first = hit;
  }
  return first;
}

}  // namespace isobath::test

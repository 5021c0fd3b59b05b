#include <fmt/format.h>
#include <isobath/runtime/reservoir_source.hpp>

namespace isobath {

ReservoirSource::ReservoirSource(const ReservoirConfig& config) : scene_(config) {
  report_.format = "simulated reservoir";
  report_.details["scene"] = fmt::format("two buoys and an embankment, seed {}", config.seed);
  report_.details["sonar"] = "scanning, 3 x 35 deg, 90 deg sector, 44 bins to 50 m";
}

std::optional<Event> ReservoirSource::next() {
  if (pending_) {
    std::optional<Event> ping(std::move(*pending_));
    pending_.reset();
    return ping;
  }
  auto step = scene_.step();
  if (!step) return std::nullopt;
  pending_ = std::move(step->second);
  return step->first;
}

}  // namespace isobath

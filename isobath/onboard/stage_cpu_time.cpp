#include <ctime>
#include <fmt/format.h>
#include <isobath/onboard/stage_cpu_time.hpp>

namespace isobath {
namespace {

std::size_t place_of(Stage stage) { return static_cast<std::size_t>(stage); }

}  // namespace

std::int64_t thread_nanoseconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

const char* to_text(Stage stage) {
  switch (stage) {
    case Stage::kEchoes: return "echoes";
    case Stage::kPlane: return "plan view";
    case Stage::kVoxels: return "voxels";
    case Stage::kSphere: return "spherical grid";
    case Stage::kDepths: return "depth map";
    case Stage::kObstacles: return "obstacles";
    case Stage::kAgents: return "planning and agents";
    case Stage::kSource: return "input";
    case Stage::kReport: return "report";
  }
  return "report";
}

void StageCpuTime::enter(Stage stage) {
  const std::int64_t now = thread_nanoseconds();
  if (since_ >= 0) nanoseconds_[place_of(stage_)] += now - since_;
  stage_ = stage;
  since_ = now;
}

void StageCpuTime::leave() {
  if (since_ >= 0) enter(stage_);
  since_ = -1;
}

double StageCpuTime::seconds(Stage stage) const { return 1e-9 * static_cast<double>(nanoseconds_[place_of(stage)]); }

double RunLoad::sum_s() const {
  double sum = 0;
  for (std::size_t i = 0; i < place_of(Stage::kSource); ++i) sum += stage_s[i];
  return sum;
}

RunLoad load_of(const StageCpuTime& one, const StageCpuTime& other) {
  RunLoad all;
  for (std::size_t i = 0; i < kStages; ++i) {
    const auto stage = static_cast<Stage>(i);
    all.stage_s[i] = one.seconds(stage) + other.seconds(stage);
  }
  return all;
}

std::string load_text(const RunLoad& load, std::uint64_t pings, double log_s) {
  if (pings == 0 || !(log_s > 0)) return {};
  const double count = static_cast<double>(pings);
  std::string text =
      fmt::format("load of one core: {:.1f} ms per ping, {:.0f} % of real time:", 1000 * load.sum_s() / count,
                  100 * load.sum_s() / log_s);
  const char* before = " ";
  for (std::size_t i = 0; i < place_of(Stage::kSource); ++i) {
    text += fmt::format("{}{} {:.1f}", before, to_text(static_cast<Stage>(i)), 1000 * load.stage_s[i] / count);
    before = ", ";
  }
  text += fmt::format("; in addition, input {:.1f} and report {:.1f}",
                      1000 * load.stage_s[place_of(Stage::kSource)] / count,
                      1000 * load.stage_s[place_of(Stage::kReport)] / count);
  return text;
}

}  // namespace isobath

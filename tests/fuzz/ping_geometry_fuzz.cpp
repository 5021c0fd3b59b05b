// Pings of any geometry, poses and soundings, through the gate into the plan view and the map in three dimensions, as a
// run takes them: what no map can use is counted, and nothing that is let in does harm.
//
// The bytes are numbers, drawn one after another: most from lists of what sonars do and of what they should not, some
// as they stand.
#include <cmath>
#include <cstring>
#include <isobath/base/error.hpp>
#include <isobath/configuration/configuration.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/world/voxel_model.hpp>
#include <limits>

namespace {

using namespace isobath;

class Draw {
 public:
  Draw(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  [[nodiscard]] bool over() const { return left_ == 0; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  double any() {
    std::array<std::uint8_t, sizeof(double)> bytes;
    for (std::uint8_t& b : bytes) b = byte();
    double value = 0;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  /// Within a span that is usual, or what nobody expects.
  double number(double low, double high) {
    constexpr double kOdd[] = {0, -1, 1e-300, -1e-9, 1e-5, 1e7, 1e30, 1e300, HUGE_VAL, -HUGE_VAL, NAN};
    const std::uint8_t kind = byte();
    if (kind < 224) return low + (high - low) * byte() / 255;
    return kind < 250 ? kOdd[kind % std::size(kOdd)] : any();
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

Pose pose_of(Draw& draw, double reach_m) {
  const double heading = draw.number(-180, 180), pitch = draw.number(-90, 90), roll = draw.number(-180, 180);
  Pose pose;
  if (std::isfinite(heading) && std::isfinite(pitch) && std::isfinite(roll)) {
    pose.rotation =
        Rotation::from_heading_pitch_roll(Angle::degrees(heading), Angle::degrees(pitch), Angle::degrees(roll));
  }
  for (int a = 0; a < 3; ++a) pose.translation[a] = draw.number(-reach_m, reach_m);
  return pose;
}

Ping ping_of(Draw& draw, Time time) {
  constexpr int kMaxBeams = 24, kMaxBins = 64;
  Ping ping;
  ping.time = time;
  auto fan = std::make_shared<BeamFan>();
  const int beams = draw.byte() % (kMaxBeams + 1);
  double azimuth = draw.number(-400, 400);
  const double step = draw.number(0.1, 20);
  const double width = draw.number(0.1, 40);
  for (int b = 0; b < beams; ++b, azimuth += step) {
    fan->azimuth.push_back(Angle::degrees(azimuth));
    fan->width.push_back(Angle::degrees(width));
  }
  fan->height = Angle::degrees(draw.number(0.5, 380));
  if (draw.byte() % 16 == 0 && beams > 0) fan->width.pop_back();
  ping.fan = fan;
  ping.window = {draw.number(0, 5), draw.number(0.01, 0.5), draw.byte() % (kMaxBins + 1)};
  if (draw.byte() % 16 == 0) ping.window.bins = -ping.window.bins;
  const bool floats = draw.byte() % 4 == 0;
  const std::size_t bytes = floats ? sizeof(float) : 1;
  auto samples = std::make_shared<std::vector<std::uint8_t>>(std::size_t{kMaxBeams} * kMaxBins * bytes);
  const std::uint8_t level = draw.byte(), echo_every = draw.byte();
  for (std::size_t i = 0; i < samples->size(); ++i) {
    (*samples)[i] = echo_every > 3 && i / bytes % echo_every == 3 ? 250 : level % 64;
  }
  const int bins = std::max(0, ping.window.bins);
  ping.intensity = Intensities(samples->data(), floats ? SampleType::kF32 : SampleType::kU8, beams, bins,
                               static_cast<std::ptrdiff_t>(bytes) * bins, static_cast<std::ptrdiff_t>(bytes));
  ping.storage = samples;
  ping.X_BS = pose_of(draw, 3);
  ping.sound_speed = draw.number(1400, 1600);
  ping.blanking_m = draw.number(0, 1);
  return ping;
}

Navigation fix_of(Draw& draw, Time time) {
  Navigation fix;
  fix.time = time;
  fix.X_WB = pose_of(draw, 60);
  if (draw.byte() % 2 == 0) fix.v_WB = Eigen::Vector3d(draw.number(-2, 2), 0, 0);
  return fix;
}

Swath swath_of(Draw& draw, Time time) {
  Swath swath;
  swath.time = time;
  for (int n = draw.byte() % 8; n > 0; --n) {
    Sounding& s = swath.soundings.emplace_back();
    for (int a = 0; a < 3; ++a) s.point[a] = static_cast<float>(draw.number(-8, 8));
    s.range_m = draw.byte() % 4 == 0 ? static_cast<float>(draw.number(0, 15)) : s.point.norm();
    s.kind = draw.byte() % 4 == 0 ? Sounding::Kind::kBottom : Sounding::Kind::kWater;
  }
  return swath;
}

class Sink : public ResultSink {
 public:
  explicit Sink(const VoxelModelConfig& config) : model(config) {}
  void on_ping(const PosedPing& posed) override { take(posed); }
  void on_vertical_ping(const PosedPing& posed) override { take(posed); }
  void on_jump(const Eigen::Vector3d& by_W) override { model.move_along(by_W); }
  void on_scan(const ScanResult& scan) override {
    const auto space = model.map() ? model.space_around(scan, 5 * model.map()->voxel_m()) : nullptr;
    ISOBATH_ASSERT(!space || space->size().maxCoeff() < 64);
  }
  void on_soundings(const Swath& swath, const Pose& X_WB) override { model.update(swath, X_WB); }
  VoxelModel model;

 private:
  /// A fan of hundreds of megabytes is right, and no matter for a fuzzer.
  void take(const PosedPing& posed) {
    const BeamFan& fan = *posed.ping.fan;
    const double across = model.map() ? posed.ping.window.end_m() / model.map()->voxel_m() : 200;
    const double radians = (fan.azimuth.back() - fan.azimuth.front() + fan.width.front()).radians();
    if (std::pow(across, 3) * radians * std::min(2.0, fan.height.radians()) / 3 < 2e5) model.update(posed);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Draw draw(data, size);
  Configuration configuration;
  configuration.echoes.method = DetectionMethod::kOrderedStatistic;
  configuration.voxels.sonars = VoxelModelConfig::Sonars::kAll;
  configuration.voxels.fit = draw.byte() % 4 == 0;
  configuration.voxels.map.voxel_m = 0.25 * (1 + draw.byte() % 8);
  configuration.voxels.fans.rule = static_cast<FanMapperConfig::Rule>(draw.byte() % 3);
  try {
    Sink sink(configuration.voxels);
    Pipeline pipeline(configuration, sink);
    Time time(seconds(1));
    std::uint64_t events = 0;
    while (!draw.over() && events < 12) {
      time += seconds(0.25) * (draw.byte() % 8);
      const std::uint8_t kind = draw.byte() % 8;
      Event event = kind < 4 ? Event(ping_of(draw, time)) : kind < 7 ? Event(fix_of(draw, time)) : swath_of(draw, time);
      ++events;
      pipeline.on_event(std::move(event));
    }
    pipeline.finish();
    const PipelineCounts& n = pipeline.counts();
    std::uint64_t refused = 0;
    for (const auto& [reason, count] : pipeline.rejected()) refused += count;
    ISOBATH_ASSERT(n.pings + n.vertical + n.navigation + n.swaths + refused >= events);
    constexpr std::size_t kSmall = 8'000'000;  // bytes: all of it is looked at then
    if (!sink.model.map() || sink.model.map()->bytes() > kSmall) return 0;
    const VoxelOutcome outcome = sink.model.outcome();
    ISOBATH_ASSERT(outcome.occupied + outcome.free <= outcome.seen);
  } catch (const Error& error) {
    ISOBATH_ASSERT(false && error.what());  // no single ping ends a run
  }
  return 0;
}

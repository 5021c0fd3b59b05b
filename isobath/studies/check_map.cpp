#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/perception/depth_mapper.hpp>
#include <isobath/perception/revisit_check.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/run/run_source.hpp>
#include <isobath/sonar/beam_cone.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/studies/check_map.hpp>
#include <map>
#include <memory>

namespace isobath {
namespace {

constexpr const char* kNoDepth = "no depth in the map";
constexpr const char* kOnlyClear = "place that the map knows only as clear down to a depth";
constexpr const char* kLand = "place that the chart shows as dry land";
constexpr const char* kNoEcho = "no echo";
constexpr const char* kNotDown = "not of a depth sonar";
constexpr const char* kInWater = "echo in the water column";

/// Compares each sounding with the map.
class Comparer final : public SoundingSink, public ResultSink {
 public:
  Comparer(const StoredMap& map, const DepthMapperParts& parts)
      : map_(map),
        parts_(parts),
        gate_(parts.gate),
        comparison_(map.facts.area.grid),
        read_([&map](const PixelWindow& window, std::span<DepthPixel> out) { map.trees.read(window, out); }) {}

  void on_range(const RangeReading& reading, const PoseEstimate& pose) override {
    ++input.offered;
    const BeamCone cone(reading, pose.X_WB);
    if (cone.axis().z() < std::cos(parts_.evidence.depth_within.radians())) return leave_out(kNotDown);
    if (!reading.range_m) return leave_out(kNoEcho);
    const Eigen::Vector3d p_W = cone.apex() + *reading.range_m * cone.axis();
    const std::size_t sensor = sensors_.index_of(reading.X_BS).value_or(SensorTable::kMax - 1);
    const auto verdict = gate_.judge(static_cast<int>(sensor), p_W);
    if (verdict == SoundingGate::Verdict::kHeld || verdict == SoundingGate::Verdict::kImpossible) {
      return leave_out(to_text(DepthRefusal::kHeldAlone));
    }
    compare(p_W, *reading.range_m * std::tan(reading.width.radians() / 2), pose.sigma_m, reading.time);
  }

  void on_swath(const Swath& swath, const PoseEstimate& pose) override {
    input.offered += swath.soundings.size();
    const Pose X_WF = frame_in_world(swath, pose.X_WB);
    points_.clear();
    for (const Sounding& s : swath.soundings) points_.push_back(X_WF * s.point.cast<double>());
    believed_.assign(points_.size(), 1);
    gate_.judge_swath(points_, believed_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (swath.soundings[i].kind == Sounding::Kind::kWater) {
        leave_out(kInWater);
      } else if (believed_[i] == 0) {
        leave_out(to_text(DepthRefusal::kHeldAlone));
      } else {
        const double range = static_cast<double>(swath.soundings[i].range_m);
        compare(points_[i], range * std::tan(swath.beam_width.radians() / 2), pose.sigma_m, swath.time);
      }
    }
  }

  void on_passage(Time, const Pose&) override {}
  void on_ping(const PosedPing&) override {}
  void on_scan(const ScanResult&) override {}

  void finish() { input.left_out.assign(reasons_.begin(), reasons_.end()); }
  CrosscheckInput input;

 private:
  void leave_out(const char* reason) { ++reasons_[reason]; }

  void compare(const Eigen::Vector3d& p_W, double footprint_m, double sigma_m, Time time) {
    const double radius = footprint_m + parts_.mapper.spread_sigmas * sigma_m;
    const auto mapped = comparison_.at(read_, p_W.head<2>(), radius);
    if (!mapped) {
      const NoBottom why = comparison_.why();
      return leave_out(why == NoBottom::kOnlyClear ? kOnlyClear : why == NoBottom::kLand ? kLand : kNoDepth);
    }
    const double minute = to_seconds(time - map_.facts.epoch) / 60;
    CrosscheckSample sample{.observed_m = static_cast<float>(p_W.z()),
                            .predicted_m = static_cast<float>(mapped->depth_m),
                            .confidence = static_cast<std::uint8_t>(std::lround(mapped->confidence)),
                            .flags = static_cast<std::uint8_t>(mapped->flags),
                            .age_days = static_cast<float>((minute - mapped->minute) / (60 * 24)),
                            .independent = independent_.counts(p_W.head<2>(), radius, minute)};
    sample.gradient = comparison_.gradient(read_, p_W.head<2>());
    input.samples.push_back(sample);
  }

  const StoredMap& map_;
  const DepthMapperParts& parts_;
  SoundingGate gate_;
  SensorTable sensors_;
  std::map<std::string, std::uint64_t> reasons_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint8_t> believed_;
  SoundingComparison comparison_;
  SoundingComparison::Read read_;
  IndependentSoundings independent_;
};

}  // namespace

CheckOutcome check_map(const CheckRequest& request) {
  const StoredMap map = open_map(request.map);
  CheckOutcome outcome;
  outcome.damages = map.damages;
  const auto source = open_run_source(request.input, request.configuration, map.facts.origin);
  Comparer comparer(map, request.configuration.depth);
  Pipeline pipeline(request.configuration, comparer, &comparer);
  while (auto event = source->next()) {
    if (std::holds_alternative<Ping>(*event)) continue;  // no depth in it
    pipeline.on_event(std::move(*event));
    if (request.progress) request.progress(source->report(), pipeline.counts());
  }
  pipeline.finish();
  comparer.finish();
  CrosscheckInput& input = comparer.input;
  input.map = request.map.string();
  input.log = request.input.string();
  input.revisits = map.facts.revisits;
  input.margin_floor_m = request.configuration.depth.evidence.margin_m;
  input.margin_share = request.configuration.depth.evidence.margin_share;
  for (const auto& [reason, count] : pipeline.rejected()) input.left_out.emplace_back(reason, count);
  outcome.result = crosscheck(input);
  if (!request.out.empty()) {
    make_folder(request.out);
    write_whole_file(request.out / "crosscheck.json", to_json(outcome.result));
    write_whole_file(request.out / "crosscheck.html", crosscheck_page(input, outcome.result).html());
    outcome.files = {"crosscheck.json", "crosscheck.html"};
  }
  return outcome;
}

}  // namespace isobath

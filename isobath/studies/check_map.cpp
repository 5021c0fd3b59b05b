#include <cmath>
#include <Eigen/LU>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/perception/depth_mapper.hpp>
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

constexpr int kMaxReach = 64;         // pixels around a sounding, to either side
constexpr double kSlopeReach = 5;     // m around a sounding, over which the map's slope is fitted
constexpr double kFewestAround = 40;  // pixels
constexpr double kNarrowest = 1;      // m, standard deviation of their positions across

/// Compares each sounding with the map.
class Comparer final : public SoundingSink, public ResultSink {
 public:
  Comparer(const StoredMap& map, const DepthMapperParts& parts) : map_(map), parts_(parts), gate_(parts.gate) {}

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

  /// The map's prediction is the mean over the pixels within the footprint, widened by the position uncertainty, each
  /// weighted by 1 + confidence. Charted land, and pixels known only as clear down to a depth, are skipped.
  void compare(const Eigen::Vector3d& p_W, double footprint_m, double sigma_m, Time time) {
    const PixelGrid& grid = map_.facts.area.grid;
    const double radius = footprint_m + parts_.mapper.spread_sigmas * sigma_m;
    const int reach = std::min(kMaxReach, footprint_half_width(radius, grid.pixel_m));
    const int side = 2 * reach + 1;
    const Pixel middle = grid.at(p_W.head<2>());
    patch_.resize(static_cast<std::size_t>(side) * side);
    map_.trees.read({middle.column - reach, middle.row - reach, side, side}, patch_);
    double weight = 0, depth = 0, confidence = 0, minute = 0;
    unsigned flags = 0;
    bool land = false, only_clear = false;
    for (const DepthPixel& pixel : patch_) {
      if (!pixel.known()) continue;
      const bool measured = pixel.has(kSensed);
      land = land || (!measured && pixel.depth_cm() <= 0);
      only_clear = only_clear || (measured && !pixel.has(kSeenByDepth));
      if ((measured && !pixel.has(kSeenByDepth)) || (!measured && pixel.depth_cm() <= 0)) continue;
      const double w = 1 + pixel.confidence();
      weight += w;
      depth += w * pixel.depth_m();
      confidence += w * pixel.confidence();
      minute += w * pixel.minute();
      flags |= pixel.flags();
    }
    if (weight == 0) return leave_out(only_clear ? kOnlyClear : land ? kLand : kNoDepth);
    const double predicted = depth / weight;
    const double minutes = to_seconds(time - map_.facts.epoch) / 60 - minute / weight;
    input.samples.push_back({static_cast<float>(p_W.z()), static_cast<float>(predicted),
                             static_cast<std::uint8_t>(std::lround(confidence / weight)),
                             static_cast<std::uint8_t>(flags), static_cast<float>(minutes / (60 * 24))});
    if (const auto gradient = gradient_at(p_W.head<2>())) {
      input.slopes.push_back({p_W.z() - predicted, *gradient});
    }
  }

  /// Gradient (north, east) of the plane through the sounded pixels around. Empty if they are few, or on one line.
  std::optional<Eigen::Vector2d> gradient_at(const Eigen::Vector2d& north_east) {
    const PixelGrid& grid = map_.facts.area.grid;
    const int reach = std::max(1, static_cast<int>(std::lround(kSlopeReach / grid.pixel_m)));
    const int side = 2 * reach + 1;
    const Pixel middle = grid.at(north_east);
    patch_.resize(static_cast<std::size_t>(side) * side);
    map_.trees.read({middle.column - reach, middle.row - reach, side, side}, patch_);
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (int i = 0; i < side * side; ++i) {
      const DepthPixel& pixel = patch_[static_cast<std::size_t>(i)];
      if (!pixel.known() || !pixel.has(kSeenByDepth)) continue;
      const int north = reach - i / side, east = i % side - reach;  // pixels
      const Eigen::Vector3d a{1, north * grid.pixel_m, east * grid.pixel_m};
      normal += a * a.transpose();
      right += pixel.depth_m() * a;
    }
    // Spread of the pixels along their narrower direction: a single track gives only the slope along it.
    if (normal(0, 0) < kFewestAround) return std::nullopt;
    const Eigen::Vector2d mean = normal.block<2, 1>(1, 0) / normal(0, 0);
    const Eigen::Matrix2d spread = normal.block<2, 2>(1, 1) / normal(0, 0) - mean * mean.transpose();
    const double half = 0.5 * spread.trace();
    const double narrow = half - std::sqrt(std::max(0.0, half * half - spread.determinant()));
    if (narrow < kNarrowest * kNarrowest) return std::nullopt;
    return Eigen::Vector2d(normal.inverse().eval().bottomRows<2>() * right);
  }

  const StoredMap& map_;
  const DepthMapperParts& parts_;
  SoundingGate gate_;
  SensorTable sensors_;
  std::map<std::string, std::uint64_t> reasons_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::uint8_t> believed_;
  std::vector<DepthPixel> patch_;
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

#include <cmath>
#include <fmt/format.h>
#include <isobath/perception/depth_update.hpp>
#include <isobath/world/world_level.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr unsigned bit_of(WorldLevel::Part part) { return 1U << part; }

}  // namespace

const std::vector<WatchedModule>& WorldLevel::watched() {
  static const std::vector<WatchedModule> kWatched{{"update"}, {"prediction"}, {"learning"}};
  return kWatched;
}

void WorldLevel::on_input(const LevelInput& input) const {
  std::optional<RangePrediction> expected;
  if (input.range && predict) expected = predict(*input.range, input.pose.X_WB);
  if (input.range && learn) learn(*input.range, expected);
  if (update) update(input);
  // A part without work for this input is idle, not silent. A part that is missing is silent.
  const unsigned worked =
      (update ? bit_of(kUpdate) : 0) | (predict ? bit_of(kPrediction) : 0) | (learn ? bit_of(kLearning) : 0);
  if (evaluate) evaluate(input.time, worked);
}

std::optional<RangePrediction> MapPrediction::operator()(const DepthWindow& window, const RangeReading& reading,
                                                         const Pose& X_WB) {
  const auto cone = evidence_.cone(reading, X_WB);
  if (!cone || !cone->apex().allFinite() || cone->apex().head<2>().norm() > 1e8) return std::nullopt;
  const double max_range_m = evidence_.max_range_m(reading);
  const PixelWindow wanted = predictor_.window(*cone, max_range_m);
  if (overlap(wanted, window.extent()) != wanted) return std::nullopt;
  const std::size_t size = static_cast<std::size_t>(wanted.width) * static_cast<std::size_t>(wanted.height);
  if (patch_.size() < size) patch_.resize(size);
  for (const PixelSpan& span : predictor_.pixels(*cone, max_range_m, wanted)) {
    float* to = patch_.data() + std::ptrdiff_t{span.row - wanted.row} * wanted.width - wanted.column;
    for (int column = span.column_begin; column < span.column_end; ++column) {
      const DepthPixel& pixel = window.at({column, span.row});
      if (!vouched(pixel)) return std::nullopt;
      to[column] = static_cast<float>(pixel.depth_m());
    }
  }
  return predictor_.predict_listed(*cone, max_range_m, {wanted, std::span(patch_).first(size)});
}

void SensorLearning::operator()(const RangeReading& reading, const std::optional<RangePrediction>& expected) {
  const auto sensor = table_.index_of(reading.X_BS);
  if (!sensor) return;
  if (!expected || (reading.range_m && !std::isfinite(*reading.range_m))) {
    return counts_.count(*sensor, Agreement::kIrrelevant);
  }
  std::optional<double> heard = reading.range_m;
  if (heard && *heard >= evidence_.max_range_m(reading)) heard.reset();
  const double sigma = deviation_.of_range(heard.value_or(expected->max_range_m));
  counts_.count(*sensor, expected->agrees(heard, sigma, gate_) ? Agreement::kConfirming : Agreement::kConflicting);
}

std::string aim_of(const Pose& X_BS) {
  const Eigen::Vector3d axis_B = X_BS.rotation * Eigen::Vector3d::UnitX();
  const double level = std::hypot(axis_B.x(), axis_B.y());
  const auto down = std::lround(Angle::radians(std::atan2(axis_B.z(), level)).degrees());
  if (down >= 85) return "down";
  const auto right = std::lround(Angle::radians(std::atan2(axis_B.y(), axis_B.x())).degrees());
  std::string text =
      right == 0 ? "ahead" : fmt::format("{} deg to {}", std::abs(right), right > 0 ? "starboard" : "port");
  if (down != 0) text += fmt::format(", {} deg {}", std::abs(down), down > 0 ? "down" : "up");
  return text;
}

std::vector<SensorLearning::Sensor> SensorLearning::sensors() const {
  std::vector<Sensor> all;
  for (const Pose& X_BS : table_.mountings()) all.push_back({X_BS, counts_.counts()[all.size()]});
  return all;
}

}  // namespace isobath

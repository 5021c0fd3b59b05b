#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/sensor_model.hpp>
#include <isobath/sonar/strict_json.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

constexpr int kVersion = 1;
constexpr const char* kFormat = "isobath-sensor-model";
constexpr int kMaxBins = 1 << 20;

void require(bool good, const std::string& file, const std::string& key, const std::string& problem,
             const std::string& allowed) {
  if (!good) throw Error(problem, {file, {}, {}, {}, key}, allowed, "calibrate again");
}

constexpr const char* kAdvice = "a sensor model is written by `isobath calibrate`";

SensorModel::Bin read_bin(const Json& json, const std::string& file, std::size_t index) {
  const JsonObject r(json, file, "bins[" + std::to_string(index) + "].", kAdvice,
                     {"threshold", "p_detect", "noise_mean", "noise_deviation", "blind"});
  return {r.number("threshold"), r.number("p_detect"), r.number("noise_mean"), r.number("noise_deviation"),
          r.flag("blind")};
}

}  // namespace

void SensorModel::check(const std::string& file) const {
  require(window.bins > 0 && window.bins <= kMaxBins, file, "window.bins", "out of range", "1 .. 1048576");
  require(window.start_m >= 0 && window.bin_m > 0 && std::isfinite(window.end_m()), file, "window", "no usable window",
          "start_m >= 0, bin_m > 0");
  require(bins.size() == static_cast<std::size_t>(window.bins), file, "bins",
          std::to_string(bins.size()) + " bins for a window of " + std::to_string(window.bins),
          "as many as in the window");
  require(std::isfinite(full_scale) && full_scale > 0, file, "full_scale", "out of range", "> 0");
  require(false_alarm > 0 && false_alarm < 1, file, "false_alarm", "out of range", "between 0 and 1");
  for (const double gain : beam_gains) require(gain > 0 && gain < 1e6, file, "beam_gains", "out of range", "above 0");
  for (std::size_t k = 0; k < bins.size(); ++k) {
    const Bin& bin = bins[k];
    const std::string key = "bins[" + std::to_string(k) + "]";
    require(std::isfinite(bin.noise_mean) && bin.noise_deviation >= 0 && std::isfinite(bin.noise_deviation), file, key,
            "noise is not finite", "finite, deviation >= 0");
    if (bin.blind) continue;
    require(std::isfinite(bin.threshold) && bin.threshold > 0, file, key + ".threshold", "out of range",
            "above 0, or mark the bin as blind");
    require(bin.p_detect > false_alarm && bin.p_detect < 1, file, key + ".p_detect",
            "the detection probability is not above the false-alarm rate",
            "above false_alarm and below 1, or mark the bin as blind");
  }
}

const char* to_text(ModelMismatch mismatch) {
  switch (mismatch) {
    case ModelMismatch::kFullScale: return "the sensor model was calibrated at another full scale";
    case ModelMismatch::kRange: return "the range window reaches beyond the calibrated ranges";
    case ModelMismatch::kBinLength: return "range bins are over twice as long or short as the calibrated ones";
  }
  return "unknown";
}

Result<std::vector<SensorModel::Bin>, ModelMismatch> for_window(const SensorModel& model, const RangeWindow& window,
                                                                double full_scale) {
  const RangeWindow& own = model.window;
  if (full_scale != model.full_scale) return tl::unexpected(ModelMismatch::kFullScale);
  if (window == own) return model.bins;
  const double ratio = window.bin_m / own.bin_m;
  if (!(ratio >= 0.5 && ratio <= 2)) return tl::unexpected(ModelMismatch::kBinLength);
  const double slack = 0.5 * own.bin_m;
  if (window.start_m < own.start_m - slack || window.end_m() > own.end_m() + slack) {
    return tl::unexpected(ModelMismatch::kRange);
  }
  std::vector<SensorModel::Bin> bins(window.bins);
  for (int k = 0; k < window.bins; ++k) {
    const double at = std::clamp((window.centre(k) - own.centre(0)) / own.bin_m, 0.0, own.bins - 1.0);
    const int i = std::min(static_cast<int>(at), std::max(0, own.bins - 2));
    const SensorModel::Bin& a = model.bins[i];
    const SensorModel::Bin& b = model.bins[std::min(i + 1, own.bins - 1)];
    const double share = at - i;
    const auto mix = [&](double x, double y) { return std::lerp(x, y, share); };
    bins[k] = {mix(a.threshold, b.threshold), mix(a.p_detect, b.p_detect), mix(a.noise_mean, b.noise_mean),
               mix(a.noise_deviation, b.noise_deviation), (a.blind && share < 1) || (b.blind && share > 0)};
  }
  return bins;
}

std::string write_sensor_model(const SensorModel& model) {
  Json json = {
      {"format", kFormat},
      {"version", kVersion},
      {"source", model.source},
      {"window", {{"start_m", model.window.start_m}, {"bin_m", model.window.bin_m}, {"bins", model.window.bins}}},
      {"full_scale", model.full_scale},
      {"false_alarm", model.false_alarm},
      {"beam_gains", model.beam_gains},
      {"bins", Json::array()}};
  for (const SensorModel::Bin& bin : model.bins) {
    json["bins"].push_back({{"threshold", bin.threshold},
                            {"p_detect", bin.p_detect},
                            {"noise_mean", bin.noise_mean},
                            {"noise_deviation", bin.noise_deviation},
                            {"blind", bin.blind}});
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

SensorModel read_sensor_model(std::string_view text, const std::string& file) {
  const Json json = parse_json(text, file, kAdvice);
  const JsonObject top(json, file, "", kAdvice,
                       {"format", "version", "source", "window", "full_scale", "false_alarm", "beam_gains", "bins"});
  if (top.text("format") != kFormat) top.fail("format", "not a sensor model", kFormat);
  if (top.number("version") != kVersion) top.fail("version", "unknown version", std::to_string(kVersion));
  const JsonObject window(json["window"], file, "window.", kAdvice, {"start_m", "bin_m", "bins"});
  SensorModel model;
  model.source = top.text("source");
  model.window = {window.number("start_m"), window.number("bin_m"), window.integer("bins", 1, kMaxBins)};
  model.full_scale = top.number("full_scale");
  model.false_alarm = top.number("false_alarm");
  if (!json["beam_gains"].is_array()) top.fail("beam_gains", "wrong type", "a list");
  for (const Json& gain : json["beam_gains"]) {
    if (!gain.is_number()) top.fail("beam_gains", "wrong type", "a list of numbers");
    model.beam_gains.push_back(gain.get<double>());
  }
  if (!json["bins"].is_array()) top.fail("bins", "wrong type", "a list");
  for (const Json& bin : json["bins"]) model.bins.push_back(read_bin(bin, file, model.bins.size()));
  model.check(file);
  return model;
}

}  // namespace isobath

#include <isobath/sonar/calibration.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Json = nlohmann::ordered_json;

Json json(const Rate& r) {
  return {{"value", r.value}, {"interval", {r.interval.low, r.interval.high}}, {"trials", r.trials}};
}

Json json(const NoiseFit& fit) {
  Json j = {{"law", to_text(fit.law)},
            {"scale", fit.scale},
            {"anderson_darling", fit.statistic},
            {"p_value", fit.p_value},
            {"samples", fit.samples}};
  if (fit.law == NoiseLaw::kGaussian) j["mean"] = fit.location;
  if (fit.law == NoiseLaw::kK) j["shape"] = fit.shape;
  return j;
}

/// A missing rate (0/0) is null.
Json rate(std::uint64_t part, std::uint64_t rest) {
  if (part + rest == 0) return nullptr;
  const auto n = static_cast<double>(part + rest);
  const auto x = static_cast<double>(part);
  return json(Rate{x / n, wilson_interval(x, n), n});
}

Json json(const RocCurve& roc) {
  Json points = Json::array();
  for (const RocPoint& p : roc.points()) points.push_back({p.threshold, p.f, p.p});
  return {{"area", roc.area()},
          {"noise_samples", roc.noise_samples()},
          {"target_samples", roc.target_samples()},
          {"threshold_f_p", std::move(points)}};
}

Json theory(const RangeGroup& g) {
  Json points = Json::array();
  for (const double f : {0.01, 0.02, 0.03, 0.04}) points.push_back({f, theoretical_detection(f, g.snr)});
  return {{"snr", g.snr}, {"f_p", std::move(points)}};
}

Json json(const RangeGroup& g) {
  Json fits = Json::array();
  for (const NoiseFit& fit : g.fits) fits.push_back(json(fit));
  return {{"bins", {g.first, g.last}},
          {"range_m", {g.near_m, g.far_m}},
          {"noise_fits", {{"bin", g.fitted_bin}, {"laws", std::move(fits)}}},
          {"counts",
           {{"hits", g.counts.hits},
            {"false_alarms", g.counts.false_alarms},
            {"misses", g.counts.misses},
            {"correct_rejections", g.counts.correct_rejections}}},
          {"p", rate(g.counts.hits, g.counts.misses)},
          {"f", rate(g.counts.false_alarms, g.counts.correct_rejections)},
          {"roc", g.roc ? json(*g.roc) : Json(nullptr)},
          {"theory", g.roc ? theory(g) : Json(nullptr)}};
}

}  // namespace

std::string to_json(const CalibrationResult& result) {
  Json groups = Json::array();
  for (const RangeGroup& g : result.groups) groups.push_back(json(g));
  Json comparison = Json::array();
  for (const ThresholdComparison& c : result.comparison) {
    comparison.push_back({{"nominal_false_alarm", c.nominal_false_alarm},
                          {"false_alarm", json(c.false_alarm)},
                          {"p_per_bin_thresholds", json(c.per_bin)},
                          {"p_global_threshold", json(c.global)}});
  }
  const Json all = {{"source", result.model.source},
                    {"false_alarm", result.model.false_alarm},
                    {"background_pings", result.background_pings},
                    {"marked_pings", result.marked_pings},
                    {"marked_cells", result.marked_cells},
                    {"groups", std::move(groups)},
                    {"cross_validation", std::move(comparison)}};
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isobath

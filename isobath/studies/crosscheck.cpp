#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/geometry/contours.hpp>
#include <isobath/map/depth/depth_pixel.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <isobath/perception/sounding_comparison.hpp>
#include <isobath/report/result_text.hpp>
#include <isobath/studies/crosscheck.hpp>
#include <map>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using Json = nlohmann::ordered_json;

struct Allowance {
  const char* name;
  double a_m, b;
};
// Table 1 of IHO S-44, edition 6.
constexpr std::array<Allowance, 5> kOrders{{{"Exclusive", 0.15, 0.0075},
                                            {"Special", 0.25, 0.0075},
                                            {"1a", 0.5, 0.013},
                                            {"1b", 0.5, 0.013},
                                            {"2", 1.0, 0.023}}};
constexpr double kOrderShare = 0.95;
constexpr std::array<std::pair<int, int>, 5> kConfidenceClasses{{{0, 4}, {5, 9}, {10, 14}, {15, 19}, {20, 20}}};

/// Whether a map can hold the depth; false for NaN.
bool holds(float depth_m) { return std::abs(depth_m) <= 1e7f; }

Json json(const DifferenceStatistics& s) {
  return {{"n", s.n}, {"median_m", s.median_m}, {"robust_sd_m", s.robust_sd_m}, {"p95_m", s.p95_m}};
}

std::string class_name(const CrosscheckResult::ConfidenceClass& c) {
  return c.low == c.high ? std::to_string(c.low) : fmt::format("{}-{}", c.low, c.high);
}
std::string class_name(const CrosscheckResult::DepthClass& c) { return fmt::format("{:g}-{:g}", c.from_m, c.to_m); }

std::vector<CrosscheckResult::DepthClass> depth_classes(const std::vector<CrosscheckSample>& samples) {
  double low = INFINITY, high = -INFINITY;
  for (const CrosscheckSample& s : samples) {
    low = std::min(low, static_cast<double>(s.observed_m));
    high = std::max(high, static_cast<double>(s.observed_m));
  }
  const double tenths = std::round(10 * nice_step(low, high, 8));
  std::map<std::int64_t, std::vector<double>> differences;
  for (const CrosscheckSample& s : samples) {
    differences[static_cast<std::int64_t>(std::floor(10 * static_cast<double>(s.observed_m) / tenths))].push_back(
        difference(s));
  }
  std::vector<CrosscheckResult::DepthClass> classes;
  for (auto& [index, values] : differences) {
    const auto i = static_cast<double>(index);
    classes.push_back({i * tenths / 10, (i + 1) * tenths / 10, difference_statistics(std::move(values))});
  }
  return classes;
}

}  // namespace

bool comparable(const CrosscheckSample& s) {
  return holds(s.observed_m) && holds(s.predicted_m) && s.confidence <= kFullConfidence;
}

double total_vertical_uncertainty(double a_m, double b, double depth_m) { return std::hypot(a_m, b * depth_m); }

namespace {

double share_of(std::uint64_t part, double whole) {
  return whole > 0 ? static_cast<double>(part) / whole : std::numeric_limits<double>::quiet_NaN();
}

/// The samples that can be compared; counts the others in `left_out`.
std::vector<CrosscheckSample> comparable_samples(const std::vector<CrosscheckSample>& all,
                                                 std::vector<std::pair<std::string, std::uint64_t>>& left_out) {
  std::vector<CrosscheckSample> samples;
  std::uint64_t no_depth = 0, no_confidence = 0;
  for (const CrosscheckSample& s : all) {
    if (comparable(s)) {
      samples.push_back(s);
    } else {
      ++(holds(s.observed_m) && holds(s.predicted_m) ? no_confidence : no_depth);
    }
  }
  if (no_depth > 0) left_out.emplace_back("depth is no number", no_depth);
  if (no_confidence > 0) left_out.emplace_back("confidence unknown", no_confidence);
  return samples;
}

std::vector<CrosscheckResult::Order> s44_orders(const std::vector<CrosscheckSample>& samples) {
  const auto n = static_cast<double>(samples.size());
  std::vector<CrosscheckResult::Order> orders;
  for (const Allowance& o : kOrders) {
    const auto within = static_cast<std::uint64_t>(std::count_if(samples.begin(), samples.end(), [&](const auto& s) {
      return std::abs(difference(s)) <= total_vertical_uncertainty(o.a_m, o.b, s.observed_m);
    }));
    const double share = share_of(within, n);
    orders.push_back({o.name, o.a_m, o.b, within, share, n > 0 && share >= kOrderShare});
  }
  return orders;
}

/// Within which a sounding agrees with the map.
double margin_of(const CrosscheckInput& input, const CrosscheckSample& s) {
  return agreement_margin(input.margin_floor_m, input.margin_share, s.observed_m);
}

/// By how much the log's offset and bias change the difference of a sounding, m.
double shift_of(const CrosscheckSample& s, const std::optional<PositionOffset>& offset) {
  if (!offset) return 0;
  return offset->bias_m + (s.gradient ? s.gradient->dot(offset->offset_m) : 0);
}

/// Number of samples by confidence.
using ConfidenceCounts = std::array<std::uint64_t, kFullConfidence + 1>;

struct Agreements {
  ConfidenceCounts n{}, agreeing{}, aligned{}, independent{};
};

/// Compares the share of agreeing samples with the one that the map promises for each confidence.
void add_calibration(const Agreements& count, const RevisitRecord& revisits, double n, CrosscheckResult& r) {
  double error = 0;
  for (int c = 0; c <= kFullConfidence; ++c) {
    const auto i = static_cast<std::size_t>(c);
    if (count.n[i] == 0) continue;
    const auto learnt = revisits.promise(c);
    CrosscheckResult::Promise row{
        .confidence = c,
        .n = count.n[i],
        .agreeing = count.agreeing[i],
        .independent = count.independent[i],
        .share = static_cast<double>(count.agreeing[i]) / static_cast<double>(count.n[i]),
        .promised = learnt ? learnt->share : c / static_cast<double>(kFullConfidence),
        .aligned = r.offset ? static_cast<double>(count.aligned[i]) / static_cast<double>(count.n[i]) : NAN,
        .learnt = learnt.has_value(),
        .interval = {}};
    const auto independent = static_cast<double>(row.independent);
    row.interval = wilson_interval(row.share * independent, independent);
    error += static_cast<double>(row.n) * std::abs(row.share - row.promised);
    r.calibration.push_back(row);
  }
  if (n > 0) r.calibration_error = error / n;
}

/// The share of the independent soundings within the uncertainty that the map states.
void add_uncertainty(const std::vector<CrosscheckSample>& samples, const CrosscheckInput& input, CrosscheckResult& r) {
  r.uncertainty = input.revisits.uncertainty();
  if (!r.uncertainty) return;
  constexpr std::array<double, 5> kSlopes = {0, 0.02, 0.05, 0.1, 0.2};
  std::vector<CrosscheckResult::Within> rows;
  for (std::size_t k = 0; k < kSlopes.size(); ++k) {
    rows.push_back({kSlopes[k], k + 1 < kSlopes.size() ? kSlopes[k + 1] : INFINITY, 0, 0, {}});
  }
  rows.push_back({NAN, NAN, 0, 0, {}});
  rows.push_back({0, INFINITY, 0, 0, {}});
  for (const CrosscheckSample& s : samples) {
    if (!s.independent) continue;
    const auto slope = s.gradient ? std::optional(s.gradient->norm()) : std::nullopt;
    const double tvu = r.uncertainty->tvu_m(margin_of(input, s), slope);
    const auto above = std::upper_bound(kSlopes.begin(), kSlopes.end(), slope.value_or(0));
    const auto k = slope ? static_cast<std::size_t>(above - kSlopes.begin()) - 1 : kSlopes.size();
    for (const std::size_t at : {k, rows.size() - 1}) {
      ++rows[at].n;
      rows[at].within += std::abs(difference(s)) <= tvu ? 1 : 0;
    }
  }
  for (CrosscheckResult::Within& row : rows) {
    if (row.n == 0) continue;
    row.interval = wilson_interval(static_cast<double>(row.within), static_cast<double>(row.n));
    r.within.push_back(row);
  }
}

}  // namespace

CrosscheckResult crosscheck(const CrosscheckInput& input) {
  CrosscheckResult r;
  r.offered = input.offered;
  r.left_out = input.left_out;
  const std::vector<CrosscheckSample> samples = comparable_samples(input.samples, r.left_out);
  const auto n = static_cast<double>(samples.size());
  r.covered = input.offered > 0 ? n / static_cast<double>(input.offered) : 0;
  std::vector<SlopeSample> slopes;
  for (const CrosscheckSample& s : samples) {
    if (s.gradient) slopes.push_back({difference(s), *s.gradient});
  }
  r.offset = position_offset(slopes);
  std::vector<double> all;
  std::array<std::vector<double>, kConfidenceClasses.size()> by_class;
  Agreements count;
  std::uint64_t shoaler = 0;
  for (const CrosscheckSample& s : samples) {
    const double d = difference(s);
    const double margin = margin_of(input, s);
    all.push_back(d);
    by_class[std::min<std::size_t>(s.confidence / 5U, 4)].push_back(d);
    ++count.n[s.confidence];
    count.agreeing[s.confidence] += std::abs(d) <= margin ? 1 : 0;
    count.aligned[s.confidence] += std::abs(d - shift_of(s, r.offset)) <= margin ? 1 : 0;
    count.independent[s.confidence] += s.independent ? 1 : 0;
    shoaler += d < -margin ? 1 : 0;
  }
  r.shoaler = share_of(shoaler, n);
  r.all = difference_statistics(std::move(all));
  if (!samples.empty()) r.by_depth = depth_classes(samples);
  for (std::size_t k = 0; k < kConfidenceClasses.size(); ++k) {
    r.by_confidence.push_back(
        {kConfidenceClasses[k].first, kConfidenceClasses[k].second, difference_statistics(std::move(by_class[k]))});
  }
  r.s44 = s44_orders(samples);
  add_calibration(count, input.revisits, n, r);
  add_uncertainty(samples, input, r);
  return r;
}

std::string slope_class(const CrosscheckResult::Within& w) {
  if (std::isnan(w.low)) return "not known";
  if (w.low == 0 && std::isinf(w.high)) return "all";
  return std::isinf(w.high) ? fmt::format("{:g} and more", w.low) : fmt::format("{:g} to {:g}", w.low, w.high);
}

std::string to_json(const CrosscheckResult& r) {
  Json left_out = Json::object();
  for (const auto& [reason, count] : r.left_out) left_out[reason] = count;
  Json by_depth = Json::array(), by_confidence = Json::array(), s44 = Json::array(), calibration = Json::array();
  for (const auto& c : r.by_depth) {
    Json j = {{"class", class_name(c)}, {"from_m", c.from_m}, {"to_m", c.to_m}};
    j.update(json(c.differences));
    by_depth.push_back(std::move(j));
  }
  for (const auto& c : r.by_confidence) {
    Json j = {{"class", class_name(c)}, {"low", c.low}, {"high", c.high}};
    j.update(json(c.differences));
    by_confidence.push_back(std::move(j));
  }
  for (const auto& o : r.s44) {
    s44.push_back(
        {{"order", o.name}, {"a_m", o.a_m}, {"b", o.b}, {"within", o.within}, {"share", o.share}, {"met", o.met}});
  }
  for (const auto& p : r.calibration) {
    calibration.push_back({{"confidence", p.confidence},
                           {"n", p.n},
                           {"agreeing", p.agreeing},
                           {"independent", p.independent},
                           {"share", p.share},
                           {"promised", p.promised},
                           {"share_aligned", p.aligned},
                           {"learnt", p.learnt},
                           {"interval", {p.interval.low, p.interval.high}}});
  }
  Json uncertainty = uncertainty_json(r.uncertainty);
  if (r.uncertainty) {
    uncertainty["within"] = Json::array();
    for (const auto& w : r.within) {
      uncertainty["within"].push_back({{"slope", {w.low, w.high}},
                                       {"n", w.n},
                                       {"within", w.within},
                                       {"interval", {w.interval.low, w.interval.high}}});
    }
  }
  Json offset;  // null if unknown
  if (r.offset) {
    offset = {{"n", r.offset->n},
              {"north_m", r.offset->offset_m.x()},
              {"east_m", r.offset->offset_m.y()},
              {"north_sigma_m", r.offset->sigma_m.x()},
              {"east_sigma_m", r.offset->sigma_m.y()},
              {"depth_bias_m", r.offset->bias_m},
              {"robust_sd_m", r.offset->robust_sd_m},
              {"robust_sd_without_it_m", r.offset->robust_sd_left_m}};
  }
  const Json all = {{"n", r.all.n},
                    {"offered", r.offered},
                    {"covered", r.covered},
                    {"median_m", r.all.median_m},
                    {"robust_sd_m", r.all.robust_sd_m},
                    {"p95_m", r.all.p95_m},
                    {"shoaler_than_margin", r.shoaler},
                    {"left_out", std::move(left_out)},
                    {"position_offset", std::move(offset)},
                    {"by_depth", std::move(by_depth)},
                    {"by_confidence", std::move(by_confidence)},
                    {"s44", std::move(s44)},
                    {"calibration_error", r.calibration_error},
                    {"calibration", std::move(calibration)},
                    {"uncertainty", std::move(uncertainty)}};
  return all.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_text(const CrosscheckResult& r) {
  std::string out = fmt::format("soundings offered {}, used {} ({:.1f} %)\n", r.offered, r.all.n, 100 * r.covered);
  for (const auto& [reason, count] : r.left_out) out += fmt::format("  {}: {}\n", reason, count);
  const auto row = [&out](const std::string& name, const DifferenceStatistics& s) {
    out += s.n == 0
               ? fmt::format("{:<14}{:>9}{:>12}{:>12}{:>12}\n", name, 0, "-", "-", "-")
               : fmt::format("{:<14}{:>9}{:>12.3f}{:>12.3f}{:>12.3f}\n", name, s.n, s.median_m, s.robust_sd_m, s.p95_m);
  };
  out += fmt::format("\n{:<14}{:>9}{:>12}{:>12}{:>12}\n", "sounding - map", "n", "median m", "robust sd m", "95 % m");
  row("all", r.all);
  for (const auto& c : r.by_depth) row(class_name(c) + " m", c.differences);
  for (const auto& c : r.by_confidence) row("conf. " + class_name(c), c.differences);
  if (r.offset) out += "\n" + to_text(*r.offset) + "\n";
  out += "\nIHO S-44 order  within  met\n";
  for (const auto& o : r.s44) {
    out += fmt::format("{:<14}{:>7} {:>5}\n", o.name,
                       std::isnan(o.share) ? "-" : fmt::format("{:.1f} %", 100 * o.share), o.met ? "yes" : "no");
  }
  out += "\nconfidence        n   agree  aligned  promised  95 % interval\n";
  for (const auto& p : r.calibration) {
    const std::string aligned = std::isnan(p.aligned) ? "-" : fmt::format("{:.0f} %", 100 * p.aligned);
    out += fmt::format("{:>10}{:>9}{:>6.0f} %{:>9}{:>8.0f} %  {:.0f}-{:.0f} %{}\n", p.confidence, p.n, 100 * p.share,
                       aligned, 100 * p.promised, 100 * p.interval.low, 100 * p.interval.high,
                       p.learnt ? "" : "  (5 % a step: too few revisits)");
  }
  if (!r.uncertainty) return out;
  out += fmt::format("\nuncertainty of a depth at 95 %, {}\nslope of the bottom        n  within  95 % interval\n",
                     to_text(*r.uncertainty, ReadingEvidenceConfig{}.margin_m));
  for (const auto& w : r.within) {
    out += fmt::format("{:<19}{:>9}{:>6.0f} %  {:.0f}-{:.0f} %\n", slope_class(w), w.n,
                       100 * share_of(w.within, static_cast<double>(w.n)), 100 * w.interval.low, 100 * w.interval.high);
  }
  return out;
}

}  // namespace isobath

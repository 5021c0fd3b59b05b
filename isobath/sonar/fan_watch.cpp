#include <algorithm>
#include <cmath>
#include <isobath/sonar/fan_watch.hpp>

namespace isobath {
namespace {

constexpr double kDeadBeam = 0.01;  // of the median beam, in power
constexpr double kApart_db = 3;     // gains
constexpr int kJudged = 40;         // pings
constexpr double kMiddleRate = 1e-3;

double power_decibels(double power_ratio) {
  return power_ratio > 0 ? std::max(FanModel::kFaintest_db, 10 * std::log10(power_ratio)) : FanModel::kFaintest_db;
}

}  // namespace

double median_of(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void FanWatch::begin(const Ping& ping, const FanCells& cells, int first_bin) {
  *this = {};
  rows_ = cells.beams();
  bins_ = cells.bins();
  first_bin_ = first_bin;
  first_sample_ = first_bin * cells.bins_per_cell();
  cell_m_ = cells.window().bin_m;
  window_ = ping.window;
  type_ = ping.intensity.type();
  full_scale_ = ping.full_scale;
  first_ = ping.time;
  sum_.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(bins_), 0);
  count_.assign(sum_.size(), 0);
  row_.resize(static_cast<std::size_t>(ping.window.bins));
  beam_sum_.assign(static_cast<std::size_t>(ping.fan->beams()), 0);
  beam_count_.assign(beam_sum_.size(), 0);
}

void FanWatch::end_ping(const Ping& ping, const std::vector<float>& power, const std::vector<std::uint8_t>& target) {
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    if (power[i] < 0 || target[i]) continue;
    sum_[i] += double{power[i]};
    count_[i] += 1;
  }
  const bool clips = type_ != SampleType::kF32;
  for (int b = pings_ % kEvery; b < ping.fan->beams(); b += kEvery) {
    const BinSpan span = sampled_bins(ping, b);
    ping.intensity.copy_beam(b, row_.data());
    for (int k = std::max(first_sample_, span.first); k < span.end; ++k) {
      const float z = row_[static_cast<std::size_t>(k)];
      clipped_ += clips && z >= full_scale_ ? 1 : 0;
      silent_ += z <= 0 ? 1 : 0;
      samples_ += 1;
      beam_sum_[static_cast<std::size_t>(b)] += double{z} * double{z};
      beam_count_[static_cast<std::size_t>(b)] += 1;
    }
  }
  last_ = ping.time;
  ++pings_;
}

bool FanWatch::contradicts(const TailLaw& law, const std::vector<float>& ratios) {
  if (pings_ >= kJudged) return false;
  if (pings_ == kRough) heard_ = {};
  for (const float u : ratios) {
    if (u >= 0) heard_.add(u);
  }
  // One ping, or levels that still settle: a wide bound.
  const bool settled = pings_ == 2 * kRough || pings_ == kJudged - 1;
  if (!settled && pings_ != 0 && pings_ != kRough - 1) return false;
  const double ratio = double{heard_.robust_threshold(kMiddleRate)} / double{law.robust_threshold(kMiddleRate)};
  const double most = settled ? 1.5 : 2;
  return !(ratio < most && ratio > 1 / most);
}

std::vector<double> FanWatch::levels() const {
  std::vector<double> all, column;
  for (int k = 0; k < bins_; ++k) {
    column.clear();
    for (int r = 0; r < rows_; ++r) {
      const auto cell = static_cast<std::size_t>(r) * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(k);
      if (count_[cell] > 0) column.push_back(mean(cell));
    }
    all.push_back(median_of(column));
  }
  return all;
}

std::vector<double> FanWatch::gains_db(const std::vector<double>& levels) const {
  std::vector<double> all, ratios;
  for (int r = 0; r < rows_; ++r) {
    ratios.clear();
    for (int k = first_bin_; k < bins_; ++k) {
      const auto cell = static_cast<std::size_t>(r) * static_cast<std::size_t>(bins_) + static_cast<std::size_t>(k);
      if (levels[static_cast<std::size_t>(k)] > 0 && count_[cell] > 0)
        ratios.push_back(mean(cell) / levels[static_cast<std::size_t>(k)]);
    }
    all.push_back(power_decibels(median_of(ratios)));
  }
  return all;
}

void FanWatch::describe(FanModel& model) const {
  model.window = window_;
  model.type = type_;
  model.full_scale = double{full_scale_};
  model.cell_m = cell_m_;
  model.level = levels();
  model.gains_db = gains_db(model.level);
  std::vector<double> power;
  for (std::size_t b = 0; b < beam_sum_.size(); ++b)
    power.push_back(beam_count_[b] > 0 ? beam_sum_[b] / beam_count_[b] : -1);
  std::vector<double> heard;
  std::copy_if(power.begin(), power.end(), std::back_inserter(heard), [](double p) { return p > 0; });
  const double least = kDeadBeam * median_of(heard);
  for (std::size_t b = 0; b < power.size(); ++b) {
    if (power[b] >= 0 && power[b] <= least) model.dead_beams.push_back(static_cast<int>(b));
  }
  model.laws = tally_;
  for (const TailLaw& law : tally_) model.all.merge(law);
  model.clipped = samples_ > 0 ? clipped_ / samples_ : 0;
  model.silent = samples_ > 0 ? silent_ / samples_ : 0;
  model.pings = pings_;
  model.seconds = to_seconds(last_ - first_);
}

FanDeparture FanWatch::departure(const FanModel& model, const std::array<float, FanModel::kStrata>& thresholds,
                                 double asked, bool same) const {
  FanDeparture d;
  d.source = model.source;
  d.same_setting = same;
  d.pings = pings_;
  d.asked = asked;
  double above = 0, cells = 0;
  for (std::size_t i = 0; i < tally_.size(); ++i) {
    above += tally_[i].exceeding(thresholds[i]) * tally_[i].total();
    cells += tally_[i].total();
  }
  d.exceeding = cells > 0 ? above / cells : 0;
  d.clipped = samples_ > 0 ? clipped_ / samples_ : 0;
  d.model_clipped = model.clipped;
  if (!same || model.level.size() != static_cast<std::size_t>(bins_)) return d;
  const std::vector<double> now = levels();
  std::vector<double> apart;
  for (std::size_t k = static_cast<std::size_t>(first_bin_); k < now.size(); ++k) {
    if (now[k] > 0 && model.level[k] > 0) apart.push_back(now[k] / model.level[k]);
  }
  d.level_db = apart.empty() ? 0 : power_decibels(median_of(apart));
  const std::vector<double> gains = gains_db(now);
  for (std::size_t r = 0; r < std::min(gains.size(), model.gains_db.size()); ++r) {
    d.beams_apart += std::abs(gains[r] - model.gains_db[r]) > kApart_db ? 1 : 0;
  }
  d.rows = static_cast<int>(gains.size());
  return d;
}

}  // namespace isobath

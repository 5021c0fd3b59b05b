#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/fan_learner.hpp>
#include <isobath/sonar/fan_watch.hpp>
#include <isobath/sonar/roc.hpp>

namespace isobath {
namespace {

constexpr int kSummed = 200;    // pings whose level is looked at for ringing
constexpr float kMaxRatio = 6;  // u counts no more for correlation: one loud cell would be all of it
constexpr double kRinging_db = 3;
constexpr int kInARow = 3;

/// Of a straight line over the logarithm of the range through cells [from, end), its value at `at`.
double extrapolated(const std::vector<double>& level_db, const RangeWindow& window, int from, int end, int at) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (int k = from; k < end; ++k) {
    const double range = std::log(window.centre(k)), level = level_db[static_cast<std::size_t>(k)];
    ++n;
    x += range;
    y += level;
    xx += range * range;
    xy += range * level;
  }
  const double spread = n * xx - x * x;
  const double slope = spread > 0 ? (n * xy - x * y) / spread : 0;
  return y / n + slope * (std::log(window.centre(at)) - x / n);
}

double look_share(double r) { return (1 - std::max(0.0, r)) / (1 + std::max(0.0, r)); }

}  // namespace

void FanSurvey::add(const Ping& ping) {
  if (ping.fan->beams() < FanDetector::kMinBeams) return;
  ++pings_;
  auto at = std::find_if(all_.begin(), all_.end(), [&](const Heard& h) { return h.setting == ping; });
  if (at == all_.end()) {
    Heard heard{{}, FanCells(config_.range_cells), {}};
    set_sonar(heard.setting.identity, *ping.fan);
    heard.setting.identity.window = ping.window;
    heard.setting.identity.type = ping.intensity.type();
    heard.setting.identity.full_scale = double{ping.full_scale};
    at = all_.insert(all_.end(), std::move(heard));
  }
  ++at->setting.pings;
  if (at->summed == kSummed) return;
  ++at->summed;
  at->cells.prepare(ping);
  at->cells.pool(ping);
  at->sum.resize(at->cells.power().size());
  for (std::size_t i = 0; i < at->sum.size(); ++i) at->sum[i] += std::max(0.0, double{at->cells.power()[i]});
}

std::optional<FanSetting> FanSurvey::most() const {
  const auto at = std::max_element(all_.begin(), all_.end(),
                                   [](const Heard& a, const Heard& b) { return a.setting.pings < b.setting.pings; });
  if (at == all_.end()) return std::nullopt;
  FanSetting setting = at->setting;
  setting.blanking_m = blanking_m(*at);
  return setting;
}

double FanSurvey::blanking_m(const Heard& heard) const {
  const RangeWindow& window = heard.cells.window();
  const int rows = heard.cells.beams(), bins = window.bins;
  const double full = heard.setting.identity.full_scale;
  const double loudest = heard.setting.identity.type == SampleType::kF32 ? 1e300 : 0.4 * full * full;
  std::vector<double> level_db, column, all;
  for (int k = 0; k < bins; ++k) {
    column.clear();
    for (int r = 0; r < rows; ++r)
      column.push_back(
          heard.sum[static_cast<std::size_t>(r) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k)] /
          std::max(1, heard.summed));
    const double level = median_of(column);
    if (level > 0) all.push_back(level);
    level_db.push_back(level > loudest || level <= 0 ? NAN : 10 * std::log10(level));
  }
  const double min_db = 10 * std::log10(std::max(1e-300, median_of(all))) - 40;
  for (double& level : level_db) {
    if (level < min_db) level = NAN;  // blanked
  }
  const int reach = std::max(8, bins / 16);
  int row = 0;
  for (int k = 0; k < bins / 2 && k + kInARow + reach <= bins; ++k) {
    const double expected = extrapolated(level_db, window, k + kInARow, k + kInARow + reach, k);
    row = std::abs(level_db[static_cast<std::size_t>(k)] - expected) < kRinging_db ? row + 1 : 0;
    if (row == kInARow) return k + 1 == kInARow ? window.start_m : window.edge(k + 1 - kInARow);
  }
  return window.start_m;
}

FanLearner::FanLearner(const FanSetting& setting, const FanDetectorConfig& config)
    : setting_(setting),
      whole_([&] {
        FanDetectorConfig c = config;
        c.blanking_m = std::max(c.blanking_m, setting.blanking_m);
        return c;
      }()),
      judged_(config) {
  if (setting.pings >= kMinPings) return;
  throw Error("too few pings of one setting for a fan model: " + std::to_string(setting.pings), {},
              std::to_string(kMinPings) + " pings and more", "record about a minute");
}

bool FanLearner::add(const Ping& ping) {
  if (!(setting_ == ping)) return false;
  whole_.detect(ping, {}, samples_, looks_);
  ++pings_;
  if (pings_ == setting_.pings / 2) {
    first_ = whole_.learnt();
    first_->blanking_m = setting_.blanking_m;
    judged_.start_from(std::make_shared<const FanModel>(*first_));
  } else if (first_) {
    judged_.detect(ping, {}, samples_, looks_);
    correlate();
  }
  return true;
}

void FanLearner::correlate() {
  const EchoDecisions& d = looks_.decisions;
  const std::vector<float>& u = judged_.ratios();
  const int rows = d.beams(), bins = d.bins();
  now_.assign(u.size(), -1.f);
  across_.resize(u.size());
  along_.resize(u.size());
  after_.resize(u.size());
  const auto at = [bins](int r, int k) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k);
  };
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k < bins; ++k) {
      if (!d.usable(k) || u[at(r, k)] < 0) continue;
      bool echo = false;
      for (int b = std::max(0, r - 1); b <= std::min(rows - 1, r + 1); ++b) {
        for (int n = std::max(0, k - 1); n <= std::min(bins - 1, k + 1); ++n) echo = echo || d.hit(b, n);
      }
      if (!echo) now_[at(r, k)] = std::min(u[at(r, k)], kMaxRatio);
    }
  }
  for (int r = 0; r < rows; ++r) {
    for (int k = 0; k < bins; ++k) {
      const float here = now_[at(r, k)];
      if (here < 0) continue;
      if (r + 1 < rows && now_[at(r + 1, k)] >= 0) across_[at(r, k)].add(here, now_[at(r + 1, k)]);
      if (k + 1 < bins && now_[at(r, k + 1)] >= 0) along_[at(r, k)].add(here, now_[at(r, k + 1)]);
      if (before_.size() == now_.size() && before_[at(r, k)] >= 0) after_[at(r, k)].add(before_[at(r, k)], here);
    }
  }
  before_.swap(now_);
}

/// The covariances of all pairs over their variances; with n pairs about their own mean each falls short by 1 / n.
double FanLearner::pooled(const std::vector<Pairs>& pairs) {
  double covariance = 0, variance = 0;
  for (const Pairs& p : pairs) {
    if (p.n < 5) continue;
    const double n = double{p.n}, x = double{p.x} / n, y = double{p.y} / n;
    covariance += double{p.xy} - n * x * y;
    variance += 0.5 * (double{p.xx} - n * x * x + double{p.yy} - n * y * y);
  }
  return variance > 0 ? std::clamp(covariance / variance, -1.0, 1.0) : 0;
}

FanModel::Correlation FanLearner::correlation() const { return {pooled(across_), pooled(along_), pooled(after_)}; }

std::array<FanModel::Quality, FanModel::kAsked.size()> FanLearner::quality(double looks) const {
  std::array<FanModel::Quality, FanModel::kAsked.size()> all;
  const FanModel second = judged_.learnt();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double asked = FanModel::kAsked[i];
    std::array<double, FanModel::kThirds + 1> above{}, cells{};
    for (std::size_t s = 0; s < FanModel::kStrata; ++s) {
      const float threshold = FanDetector::threshold_of(first_->laws[s], first_->all, asked);
      const double total = second.laws[s].total();
      const std::size_t third = s / FanModel::kThirds % FanModel::kThirds;
      for (const std::size_t t : {third, std::size_t{FanModel::kThirds}}) {
        above[t] += second.laws[s].exceeding(threshold) * total;
        cells[t] += total;
      }
    }
    for (std::size_t t = 0; t < above.size(); ++t) {
      FanModel::Delivered& d = t < FanModel::kThirds ? all[i].thirds[t] : all[i].whole;
      d.cells = cells[t];
      if (cells[t] == 0) continue;
      const Interval interval = wilson_interval(looks * above[t], looks * cells[t]);
      d.ratio = above[t] / cells[t] / asked;
      d.low = interval.low / asked;
      d.high = interval.high / asked;
    }
  }
  return all;
}

FanModel FanLearner::finish(const std::string& source) const {
  FanModel model = whole_.learnt();
  model.source = source;
  model.blanking_m = setting_.blanking_m;
  model.correlation = correlation();
  model.looks =
      look_share(model.correlation.beams) * look_share(model.correlation.bins) * look_share(model.correlation.pings);
  model.quality = quality(model.looks);
  return model;
}

}  // namespace isobath

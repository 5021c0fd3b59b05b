#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/calibration.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr int kBlock = 4;  // neighbouring background frames that stay in one fold
constexpr double kComparedAt[] = {0.01, 0.02, 0.03, 0.05};
/// Minimum number of samples for a quantile at the rate f: 20 above it.
double samples_needed(double false_alarm) { return 20 / false_alarm; }

Rate rate_of(double successes, double trials) {
  successes = std::clamp(successes, 0.0, trials);
  return {trials > 0 ? successes / trials : 0, wilson_interval(successes, trials), trials};
}

std::uint64_t total(const std::vector<std::uint64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

/// Sums over bins of samples at or above a threshold, from cumulative histograms.
class HeldOut {
 public:
  HeldOut(const EchoHistogram& histogram, int first_bin) : first_bin_(first_bin) {
    for (int k = first_bin; k < histogram.bins(); ++k) bins_.emplace_back(histogram, k, k + 1);
  }
  template <class Threshold>
  [[nodiscard]] double above(Threshold threshold) const {
    double sum = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      if (bins_[i].samples() > 0) {
        sum += bins_[i].samples() * bins_[i].rate_at_or_above(threshold(first_bin_ + static_cast<int>(i)));
      }
    }
    return sum;
  }
  [[nodiscard]] double samples() const {
    double sum = 0;
    for (const auto& bin : bins_) sum += bin.samples();
    return sum;
  }

 private:
  int first_bin_;
  std::vector<EchoDistribution> bins_;
};

}  // namespace

std::vector<Field> fields(CalibrationConfig& c) {
  return {Field::real("false_alarm", &c.false_alarm, {1e-5, 0.5}, "1", "False-alarm rate of the operating point."),
          Field::real("p_detect", &c.p_detect, {0.01, 0.999}, "1", "Detection probability if no target is marked."),
          Field::real("blanking_m", &c.blanking_m, {0, 100}, "m", "Range below which bins are blind.").was("blind_m"),
          Field::integer("pool_bins", &c.pool_bins, {-1, 1000}, "bins",
                         "Neighbours on each side that share their noise; -1: 1/64 of the window."),
          Field::integer("min_targets", &c.min_targets, {1, 1'000'000}, "cells",
                         "Minimum number of marked cells for a detection probability.")
              .was("least_targets"),
          Field::integer("range_groups", &c.range_groups, {1, 10'000}, "1",
                         "Number of range groups of the noise fits and ROC curves."),
          Field::integer("folds", &c.folds, {2, 100}, "1", "Number of folds of the cross-validation."),
          Field::integer("bootstraps", &c.noise.bootstraps, {0, 100'000}, "1",
                         "Number of bootstrap samples of a noise fit.")};
}

Calibration::Calibration(const CalibrationConfig& config) : config_(config) { folds_.resize(config.folds); }

void Calibration::prepare(const Ping& ping) {
  if (full_scale_ == 0) {
    window_ = ping.window;
    full_scale_ = ping.full_scale;
    type_ = ping.intensity.type();
    const double blind =
        std::ceil((std::max(config_.blanking_m, ping.blanking_m) - window_.start_m) / window_.bin_m - 1e-9);
    first_bin_ = static_cast<int>(std::clamp(blind, 0.0, window_.bins - 1.0));
    const EchoLevels levels(type_, full_scale_);
    for (Fold& fold : folds_) fold = {EchoHistogram(levels, window_.bins), EchoHistogram(levels, window_.bins)};
  } else if (ping.window != window_ || ping.full_scale != full_scale_ || ping.intensity.type() != type_) {
    throw Error("the range window, full scale or sample type of a ping differs from the first ping's", {}, {},
                "calibrate each setting of the sonar separately");
  }
}

void Calibration::add_background(const Ping& ping) {
  prepare(ping);
  EchoHistogram& noise = folds_[background_pings_++ / kBlock % config_.folds].noise;
  beam_sums_.resize(std::max(beam_sums_.size(), static_cast<std::size_t>(ping.intensity.beams())));
  for (int b = 0; b < ping.intensity.beams(); ++b) {
    for (int k = 0; k < window_.bins; ++k) {
      const float sample = ping.intensity(b, k);
      noise.add(k, sample);
      if (k >= first_bin_) beam_sums_[b] += static_cast<double>(sample);
    }
  }
}

void Calibration::add_marked(const Ping& ping, std::span<const std::uint8_t> marked) {
  prepare(ping);
  ISOBATH_ASSERT(marked.size() == std::size_t(ping.intensity.beams()) * std::size_t(window_.bins));
  EchoHistogram& target = folds_[marked_pings_++ % config_.folds].target;
  for (int b = 0; b < ping.intensity.beams(); ++b) {
    for (int k = first_bin_; k < window_.bins; ++k) {
      if (marked[std::size_t(b) * std::size_t(window_.bins) + std::size_t(k)]) target.add(k, ping.intensity(b, k));
    }
  }
}

int Calibration::reach() const { return config_.pool_bins >= 0 ? config_.pool_bins : window_.bins / 64; }

Calibration::Fold Calibration::all() const {
  Fold sum = folds_[0];
  for (std::size_t i = 1; i < folds_.size(); ++i) {
    sum.noise.add(folds_[i].noise);
    sum.target.add(folds_[i].target);
  }
  return sum;
}

/// Noise of each bin from first_bin_ on, pooled with its neighbours; wider if samples are too few for the rate.
std::vector<EchoDistribution> Calibration::pooled_noise(const EchoHistogram& noise, double false_alarm) const {
  std::vector<EchoDistribution> pooled;
  for (int k = first_bin_; k < window_.bins; ++k) {
    for (int r = reach();; r = 2 * r + 1) {
      EchoDistribution d(noise, std::max(first_bin_, k - r), k + r + 1);
      if (d.samples() < samples_needed(false_alarm) && r < window_.bins) continue;
      pooled.push_back(std::move(d));
      break;
    }
  }
  return pooled;
}

CalibrationResult Calibration::finish(const std::string& source) const {
  if (background_pings_ == 0)
    throw Error("no background to calibrate from", {}, {}, "add frames of water without targets");
  const Fold sum = all();
  const auto noise = pooled_noise(sum.noise, config_.false_alarm);
  if (noise[0].samples() < samples_needed(config_.false_alarm)) {
    throw Error("too little background for this false-alarm rate: " + std::to_string(std::lround(noise[0].samples())) +
                    " samples",
                {}, std::to_string(std::lround(samples_needed(config_.false_alarm))) + " samples or more",
                "add frames, or raise false_alarm");
  }
  CalibrationResult result;
  SensorModel& model = result.model;
  model = {source,      window_, full_scale_, config_.false_alarm, std::vector<SensorModel::Bin>(window_.bins),
           beam_gains()};
  for (int k = 0; k < window_.bins; ++k) {
    SensorModel::Bin& bin = model.bins[k];
    const EchoDistribution own(sum.noise, k, k + 1);
    bin = {0, 0, own.mean(), own.deviation(), true};
    if (k >= first_bin_) bin.threshold = noise[k - first_bin_].threshold(config_.false_alarm);
  }
  set_detection(model, sum);
  model.check();
  result.background_pings = background_pings_;
  result.marked_pings = marked_pings_;
  result.marked_cells = total(sum.target.pooled(first_bin_, window_.bins));
  const int groups = std::min(config_.range_groups, window_.bins - first_bin_);
  for (int g = 0; g < groups; ++g) {
    const auto edge = [&](int i) { return first_bin_ + (window_.bins - first_bin_) * i / groups; };
    result.groups.push_back(group(edge(g), edge(g + 1), model, sum));
  }
  if (result.marked_cells > 0) result.comparison = compare();
  return result;
}

std::vector<double> Calibration::beam_gains() const {
  std::vector<double> sorted = beam_sums_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (sorted.size() < 8 || !(*middle > 0)) return {};  // too few beams for a median, or a silent sonar
  std::vector<double> gains;
  for (const double sum : beam_sums_) gains.push_back(std::max(sum / *middle, 1e-3));
  return gains;
}

void Calibration::set_detection(SensorModel& model, const Fold& sum) const {
  std::vector<double> cells(window_.bins + 1, 0);  // sums before each bin
  std::vector<double> hits(window_.bins + 1, 0);
  for (int k = 0; k < window_.bins; ++k) {
    const EchoDistribution target(sum.target, k, k + 1);
    cells[k + 1] = cells[k] + target.samples();
    hits[k + 1] = hits[k] + target.samples() * target.rate_at_or_above(model.bins[k].threshold);
  }
  const bool marked = cells.back() >= config_.min_targets;
  for (int k = first_bin_; k < window_.bins; ++k) {
    SensorModel::Bin& bin = model.bins[k];
    bin.p_detect = config_.p_detect;
    for (int r = 0; marked; ++r) {
      const int from = std::max(0, k - r);
      const int upto = std::min(window_.bins, k + r + 1);
      const double n = cells[upto] - cells[from];
      if (n < config_.min_targets) continue;
      bin.p_detect = (hits[upto] - hits[from] + 0.5) / (n + 1);
      break;
    }
    bin.blind = bin.p_detect <= config_.false_alarm || bin.threshold > full_scale_;
  }
}

RangeGroup Calibration::group(int first, int last, const SensorModel& model, const Fold& sum) const {
  RangeGroup g{first, last, window_.edge(first), window_.edge(last), (first + last) / 2, {}, {}, {}};
  const EchoLevels& levels = sum.noise.levels();
  for (NoiseLaw law : {NoiseLaw::kGaussian, NoiseLaw::kRayleigh, NoiseLaw::kK}) {
    g.fits.push_back(fit_noise(levels, sum.noise.pooled(g.fitted_bin, g.fitted_bin + 1), law, config_.noise));
  }
  for (int k = first; k < last; ++k) {
    if (model.bins[k].blind) continue;
    const auto split = [&](const EchoHistogram& h, std::uint64_t& above, std::uint64_t& below) {
      const EchoDistribution d(h, k, k + 1);
      const double hits = std::round(d.samples() > 0 ? d.samples() * d.rate_at_or_above(model.bins[k].threshold) : 0);
      above += static_cast<std::uint64_t>(hits);
      below += static_cast<std::uint64_t>(d.samples() - hits);
    };
    split(sum.noise, g.counts.false_alarms, g.counts.correct_rejections);
    split(sum.target, g.counts.hits, g.counts.misses);
  }
  const auto target = sum.target.pooled(first, last);
  if (total(target) > 0) {
    g.roc.emplace(levels.edges(), sum.noise.pooled(first, last), target);
    const EchoDistribution noise(sum.noise, first, last), echoes(sum.target, first, last);
    const double amplitude = std::max(0.0, echoes.mean() - noise.mean());
    if (noise.deviation() > 0) g.snr = amplitude * amplitude / (noise.deviation() * noise.deviation());
  }
  return g;
}

std::vector<ThresholdComparison> Calibration::compare() const {
  std::vector<HeldOut> noise;
  std::vector<HeldOut> target;
  std::vector<EchoHistogram> training;
  for (std::size_t held = 0; held < folds_.size(); ++held) {
    noise.emplace_back(folds_[held].noise, first_bin_);
    target.emplace_back(folds_[held].target, first_bin_);
    training.emplace_back(folds_[0].noise.levels(), window_.bins);
    for (std::size_t i = 0; i < folds_.size(); ++i) {
      if (i != held) training.back().add(folds_[i].noise);
    }
    if (EchoDistribution(training.back(), first_bin_, window_.bins).samples() <= 0) return {};
  }
  const auto sum = [](const std::vector<HeldOut>& parts) {
    return std::accumulate(parts.begin(), parts.end(), 0.0, [](double s, const HeldOut& h) { return s + h.samples(); });
  };
  const double noise_samples = sum(noise);
  const double target_samples = sum(target);

  std::vector<ThresholdComparison> all;
  for (double f : kComparedAt) {
    double alarms = 0, hits = 0;
    std::vector<EchoDistribution> whole;
    for (std::size_t held = 0; held < folds_.size(); ++held) {
      const auto pooled = pooled_noise(training[held], f);
      const auto threshold = [&](int k) { return pooled[k - first_bin_].quantile(1 - f); };
      alarms += noise[held].above(threshold);
      hits += target[held].above(threshold);
      whole.emplace_back(training[held], first_bin_, window_.bins);
    }
    // One threshold for all bins, moved until it has as many false alarms.
    const auto above = [&](const std::vector<HeldOut>& parts, double rate) {
      double count = 0;
      for (std::size_t held = 0; held < folds_.size(); ++held) {
        const double t = whole[held].quantile(1 - rate);
        count += parts[held].above([t](int) { return t; });
      }
      return count;
    };
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) (above(noise, (low + high) / 2) < alarms ? low : high) = (low + high) / 2;
    all.push_back({f, rate_of(alarms, noise_samples), rate_of(hits, target_samples),
                   rate_of(above(target, high), target_samples)});
  }
  return all;
}

}  // namespace isobath

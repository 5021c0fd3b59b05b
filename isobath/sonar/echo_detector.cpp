#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sonar/echo_detector.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr int kFansListened = 20;
constexpr int kBeamsListened = 100;  // at least, of a log: nothing waits for the first decision
constexpr int kBeamsLearnt = 16;     // beams of a multibeam ping to learn from: enough, at a fraction of the cost

DetectorState state_of(ModelMismatch mismatch) {
  switch (mismatch) {
    case ModelMismatch::kFullScale: return DetectorState::kModelFullScale;
    case ModelMismatch::kRange: return DetectorState::kModelRange;
    case ModelMismatch::kBinLength: return DetectorState::kModelBinLength;
  }
  return DetectorState::kNoModel;
}

/// Marks bins that a beam has not sampled as without information.
void leave_unsampled(const Ping& ping, EchoDecisions& out) {
  for (int b = 0; b < out.beams(); ++b) {
    const BinSpan span = sampled_bins(ping, b);
    for (int k = 0; k < span.first; ++k) out.set_blind(b, k);
    for (int k = span.end; k < out.bins(); ++k) out.set_blind(b, k);
  }
}

}  // namespace

std::vector<Field> fields(EchoDetectorConfig& c) {
  using M = DetectionMethod;
  std::vector<Field> all = {
      Field::choice<M>(
          "method", &c.method,
          {{"auto", M::kAutomatic},
           {"learnt", M::kLearnt},
           {"cells", M::kCells},
           {"model", M::kModel},
           {"global", M::kGlobal},
           {"ca_cfar", M::kCellAveraging},
           {"os_cfar", M::kOrderedStatistic},
           {"histogram", M::kHistogram}},
          "Method of echo detection; auto: by the model if one is given, else cells for fans and learnt for "
          "other sonars."),
      Field::real("false_alarm", &c.false_alarm, {1e-6, 0.5}, "1",
                  "Probability that a bin without a target reports an echo; a sensor model has its own."),
      Field::real(
          "false_alarm_m", &c.false_alarm_m, {0, 100}, "m",
          "In method auto, shorter bins of a scanning head get their share of false_alarm; 0: each bin has it."),
      Field::real("p_detect", &c.p_detect, {0.01, 0.999}, "1",
                  "Probability that a bin with a target reports an echo; a sensor model has its own."),
      Field::real("blanking_m", &c.blanking_m, {0, 100}, "m",
                  "Blanking range: nearer bins are never used, since the transmitter still rings.")
          .was("blind_m"),
      Field::real("global_threshold", &c.global_threshold, {0, 1}, "1",
                  "Threshold of method global, as a share of full scale."),
      Field::real("skirt_share", &c.skirt_share, {0, 1}, "1",
                  "Method learnt only: a hit below this share of a stronger echo just behind it is dropped as its "
                  "skirt; 0: never."),
      Field::real("skirt_m", &c.skirt_m, {0, 10}, "m", "Maximum distance of that stronger echo behind a hit.")};
  for (auto&& list : {fields(c.noise), fields(c.cfar), fields(c.boundary), fields(c.fan)})
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

const char* to_text(DetectorState state) {
  switch (state) {
    case DetectorState::kReady: return "ready";
    case DetectorState::kWarmingUp: return "learning the noise level";
    case DetectorState::kNoModel: return "no sensor model";
    case DetectorState::kModelFullScale: return to_text(ModelMismatch::kFullScale);
    case DetectorState::kModelRange: return to_text(ModelMismatch::kRange);
    case DetectorState::kModelBinLength: return to_text(ModelMismatch::kBinLength);
    case DetectorState::kHistogramOfOther: return "the histogram model is of another sonar or other settings";
  }
  return "unknown";
}

EchoDetector::EchoDetector(EchoDetectorConfig config, std::optional<SensorModel> model,
                           std::shared_ptr<const LikelihoodRatios> ratios, std::shared_ptr<const FanModel> fan_model)
    : config_(config),
      model_(std::move(model)),
      ratios_(std::move(ratios)),
      boundary_(config.boundary),
      unchecked_fan_(std::move(fan_model)) {
  config_.fan.blanking_m = config_.blanking_m;
  fan_detector_ = FanDetector(config_.fan);
  if (unchecked_fan_) fan_detector_.start_from(unchecked_fan_);
  if (ratios_ && config_.method == DetectionMethod::kAutomatic) config_.method = DetectionMethod::kHistogram;
  if (model_ && config_.method == DetectionMethod::kAutomatic) config_.method = DetectionMethod::kModel;
  if (config_.method == DetectionMethod::kModel) {
    if (!model_) throw Error("method model needs a sensor model", {{}, {}, {}, {}, "method"}, {}, "calibrate first");
    model_->check();
  } else if (config_.method == DetectionMethod::kHistogram && !ratios_) {
    throw Error("method histogram needs a histogram model", {{}, {}, {}, {}, "method"}, {}, "calibrate first");
  } else if (!(config_.p_detect > config_.false_alarm)) {
    throw Error("p_detect must be above false_alarm", {{}, {}, {}, {}, "p_detect"},
                "above " + std::to_string(config_.false_alarm),
                "an echo must be more likely with a target than without");
  }
}

double EchoDetector::false_alarm() const {
  return config_.method == DetectionMethod::kModel ? model_->false_alarm : config_.false_alarm * share_;
}

DetectionMethod EchoDetector::method_for(const Ping& ping) const {
  const bool fan = ping.fan->beams() >= FanDetector::kMinBeams;
  const bool open = config_.method == DetectionMethod::kAutomatic || config_.method == DetectionMethod::kCells;
  return !open ? config_.method : fan ? DetectionMethod::kCells : DetectionMethod::kLearnt;
}

void EchoDetector::detect(const Ping& ping, EchoDecisions& out, const WaterColumn& water) {
  by_cells_ = method_for(ping) == DetectionMethod::kCells;
  if (by_cells_) {
    if (unchecked_fan_) require_same_sonar(*unchecked_fan_, ping);
    unchecked_fan_.reset();
    state_ = DetectorState::kReady;
    return fan_detector_.detect(ping, water, out, looks_);
  }
  decide(ping, out);
  boundary_.learn(ping, water, first_bin_, out.false_alarm);
  if (state_ == DetectorState::kReady) boundary_.sort_out(ping, water, thresholds_, out);
  if (ping.sampled) leave_unsampled(ping, out);
}

bool EchoDetector::listen(const Ping& ping) {
  const DetectionMethod method = method_for(ping);
  if (method == DetectionMethod::kCells) {
    if (unchecked_fan_) return true;  // the fan model has the thresholds
    EchoDecisions unused;
    fan_detector_.detect(ping, {}, unused, looks_);
    return ++listened_fans_ >= kFansListened;
  }
  if (method != DetectionMethod::kLearnt) return true;
  prepare_for(ping);
  listened_ = true;
  for (int beam = 0; beam < ping.intensity.beams(); ++beam) {
    if (sampled_bins(ping, beam) != BinSpan{0, window_.bins}) continue;
    ping.intensity.copy_beam(beam, beam_.data());
    tracker_.learn(beam_.data());
  }
  if (!tracker_.warm() || tracker_.profiles() < kBeamsListened) return false;
  end_learning();
  return true;
}

void EchoDetector::end_learning() {
  if (tracker_.profiles() < kBeamsLearnt) return;
  tracker_.update(true);
  take_thresholds();
}

/// Measures the level of each beam relative to the others.
void EchoDetector::weigh_beams(const Ping& ping) {
  constexpr double kQuantile = 0.8;  // targets fill less than 20 %, and clipped noise is not 0 there
  const int used = window_.bins - first_bin_, beams = ping.intensity.beams();
  gains_.assign(static_cast<std::size_t>(beams), 1);
  if (used < kBeamsLearnt || beams < kBeamsLearnt) return;
  const auto quantile = [](auto first, auto last, double p) {
    const auto at = first + static_cast<std::ptrdiff_t>(p * static_cast<double>(last - first - 1));
    std::nth_element(first, at, last);
    return static_cast<double>(*at);
  };
  for (int b = 0; b < beams; ++b) {
    const BinSpan span = sampled_bins(ping, b);
    const int first = std::max(first_bin_, span.first);
    if (first >= span.end) continue;
    ping.intensity.copy_beam(b, beam_.data());
    for (int k = first; k < span.end; ++k) beam_[k] /= thresholds_[k];
    gains_[b] = quantile(beam_.begin() + first, beam_.begin() + span.end, kQuantile);
  }
  std::vector<double> sorted = gains_;
  const double middle = quantile(sorted.begin(), sorted.end(), 0.5);
  for (double& gain : gains_) gain = middle > 0 ? gain / middle : 1;
}

void EchoDetector::prepare_for(const Ping& ping) {
  const bool by_pixel = config_.method == DetectionMethod::kHistogram;
  if (ping.window != window_ || ping.blanking_m != blanking_m_ || ping.full_scale != full_scale_ ||
      ping.intensity.type() != type_ || (by_pixel && ping.fan != fan_)) {
    prepare(ping);
  }
}

void EchoDetector::decide(const Ping& ping, EchoDecisions& out) {
  const Intensities& z = ping.intensity;
  const bool by_pixel = config_.method == DetectionMethod::kHistogram;
  prepare_for(ping);
  const DetectionMethod method = method_for(ping);
  if (method == DetectionMethod::kLearnt) learn(ping);
  out.reset(z.beams(), z.bins());
  describe(out);
  if (state_ != DetectorState::kReady) return;
  const bool cfar =
      config_.method == DetectionMethod::kCellAveraging || config_.method == DetectionMethod::kOrderedStatistic;
  if (cfar) return decide_by_cfar(ping, out);
  if (by_pixel) return decide_by_ratios(ping, out);
  bin_thresholds_.decide(z, thresholds_, out);
  if (config_.method == DetectionMethod::kModel) raise_noisy_beams(ping, model_->beam_gains, out);
  if (method != DetectionMethod::kLearnt) return;
  if (listened_ && gains_.empty()) weigh_beams(ping);
  raise_noisy_beams(ping, gains_, out);
  if (config_.skirt_share > 0) drop_skirts(ping, out);
}

void EchoDetector::prepare(const Ping& ping) {
  window_ = ping.window;
  blanking_m_ = ping.blanking_m;
  full_scale_ = ping.full_scale;
  type_ = ping.intensity.type();
  const double blind_bins =
      std::ceil((std::max(config_.blanking_m, blanking_m_) - window_.start_m) / window_.bin_m - 1e-9);
  first_bin_ = static_cast<int>(std::clamp(blind_bins, 0.0, double(window_.bins)));
  beam_.resize(window_.bins);
  p_detect_.assign(window_.bins, static_cast<float>(config_.p_detect));
  std::fill_n(p_detect_.begin(), first_bin_, 0.0f);
  thresholds_.assign(window_.bins, std::numeric_limits<float>::infinity());
  const bool by_length = config_.method == DetectionMethod::kAutomatic && ping.fan->beams() == 1;
  share_ = by_length && config_.false_alarm_m > 0 ? std::min(1.0, window_.bin_m / config_.false_alarm_m) : 1;
  next_beam_ = 0;
  listened_ = false;
  gains_.clear();
  state_ = DetectorState::kReady;
  switch (config_.method) {
    case DetectionMethod::kAutomatic:
    case DetectionMethod::kCells:  // fans of too few beams
    case DetectionMethod::kLearnt:
      tracker_ = NoiseTracker(EchoLevels(type_, full_scale_), window_.bins, first_bin_, false_alarm(), config_.noise);
      state_ = DetectorState::kWarmingUp;
      break;
    case DetectionMethod::kModel: prepare_model(ping); break;
    case DetectionMethod::kGlobal:
      thresholds_.assign(window_.bins, static_cast<float>(config_.global_threshold) * full_scale_);
      break;
    case DetectionMethod::kCellAveraging:
    case DetectionMethod::kOrderedStatistic:
      cfar_ = Cfar(config_.cfar, config_.method == DetectionMethod::kOrderedStatistic, config_.false_alarm);
      thresholds_.clear();
      break;
    case DetectionMethod::kHistogram: prepare_histogram(ping); break;
  }
  bin_thresholds_.set(thresholds_);
}

void EchoDetector::prepare_model(const Ping& ping) {
  const auto bins = for_window(*model_, ping.window, ping.full_scale);
  if (!bins) {
    state_ = state_of(bins.error());
    return;
  }
  for (int k = 0; k < window_.bins; ++k) {
    const SensorModel::Bin& bin = (*bins)[k];
    if (bin.blind) p_detect_[k] = 0;
    if (p_detect_[k] > 0) p_detect_[k] = static_cast<float>(bin.p_detect);
    if (p_detect_[k] > 0) thresholds_[k] = static_cast<float>(bin.threshold);
  }
}

void EchoDetector::prepare_histogram(const Ping& ping) {
  thresholds_.clear();
  fan_ = ping.fan;
  if (mismatch(ratios_->model(), ping)) {
    state_ = DetectorState::kHistogramOfOther;
    return;
  }
  point_ = ratios_->operating_point(config_.false_alarm, first_bin_);
  looked_up_.resize(static_cast<std::size_t>(ping.intensity.beams()) * static_cast<std::size_t>(window_.bins));
  for (int k = 0; k < window_.bins; ++k)
    p_detect_[k] = point_.p_detect[k] > config_.false_alarm ? point_.p_detect[k] : 0;
}

void EchoDetector::learn(const Ping& ping) {
  const int beams = ping.intensity.beams();
  const int learnt = std::min(beams, kBeamsLearnt);
  for (int i = 0; i < learnt; ++i) {
    const int beam = (next_beam_ + i * beams / learnt) % beams;
    if (sampled_bins(ping, beam) != BinSpan{0, window_.bins}) continue;
    ping.intensity.copy_beam(beam, beam_.data());
    tracker_.learn(beam_.data());
  }
  next_beam_ = (next_beam_ + 1) % beams;
  if (tracker_.update()) take_thresholds();
}

void EchoDetector::take_thresholds() {
  state_ = DetectorState::kReady;
  std::copy(tracker_.thresholds().begin(), tracker_.thresholds().end(), thresholds_.begin());
  bin_thresholds_.set(thresholds_);
}

void EchoDetector::describe(EchoDecisions& out) const {
  out.false_alarm = false_alarm();
  for (int k = 0; k < out.bins(); ++k) {
    if (state_ != DetectorState::kReady || !(p_detect_[k] > 0)) {
      out.set_unusable(k);
    } else {
      out.p_detect[k] = p_detect_[k];
    }
  }
}

void EchoDetector::raise_noisy_beams(const Ping& ping, const std::vector<double>& gains, EchoDecisions& out) {
  constexpr double kNoisy = 1.05;
  if (gains.size() != static_cast<std::size_t>(out.beams())) return;  // none, or calibrated with another fan
  for (int b = 0; b < out.beams(); ++b) {
    if (gains[b] <= kNoisy) continue;
    const auto gain = static_cast<float>(gains[b]);
    ping.intensity.copy_beam(b, beam_.data());
    for (int k = 0; k < out.bins(); ++k) {
      if (beam_[k] < gain * thresholds_[k]) out.hits(b)[k / 64] &= ~(std::uint64_t{1} << (k % 64));
    }
  }
}

void EchoDetector::decide_by_cfar(const Ping& ping, EchoDecisions& out) {
  for (int b = 0; b < ping.intensity.beams(); ++b) {
    ping.intensity.copy_beam(b, beam_.data());
    const BinSpan span = sampled_bins(ping, b);
    cfar_.detect(beam_.data(), std::max(first_bin_, span.first), span.end, out.hits(b));
  }
}

void EchoDetector::decide_by_ratios(const Ping& ping, EchoDecisions& out) {
  ratios_->look_up(ping, looked_up_);
  const std::int16_t* ratio = looked_up_.data();
  for (int b = 0; b < out.beams(); ++b, ratio += out.bins()) {
    for (int k = first_bin_; k < out.bins(); ++k) {
      if (ratio[k] < point_.threshold || !out.usable(k)) continue;
      out.set_hit(b, k);
      out.set_ratio(b, k, static_cast<float>(std::exp(LikelihoodRatios::kUnit * ratio[k])));
    }
  }
}

namespace {

/// Whether the intensity rises from this bin to a much stronger echo within `reach` bins, without a dip between them.
bool is_skirt(const float* beam, int bin, int bins, int reach, float share) {
  const float own = beam[bin];
  for (int k = bin + 1; k < std::min(bins, bin + reach + 1); ++k) {
    if (beam[k] * share > own) return true;
    if (beam[k] < share * own) return false;
  }
  return false;
}

}  // namespace

void EchoDetector::drop_skirts(const Ping& ping, EchoDecisions& out) {
  const int reach = static_cast<int>(std::min(config_.skirt_m / window_.bin_m, double(window_.bins)));
  const auto share = static_cast<float>(config_.skirt_share);
  for (int b = 0; b < out.beams(); ++b) {
    std::uint64_t* hits = out.hits(b);
    if (std::all_of(hits, hits + out.words(), [](std::uint64_t w) { return w == 0; })) continue;
    ping.intensity.copy_beam(b, beam_.data());
    for (int w = 0; w < out.words(); ++w) {
      for (std::uint64_t left = hits[w]; left != 0; left &= left - 1) {
        const int bin = 64 * w + std::countr_zero(left);
        if (is_skirt(beam_.data(), bin, out.bins(), reach, share)) hits[w] &= ~(left & -left);
      }
    }
  }
}

}  // namespace isobath

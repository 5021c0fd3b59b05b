#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/report/plot/picture.hpp>
#include <isobath/sonar/echo_histogram.hpp>
#include <isobath/studies/histogram_calibration.hpp>
#include <numeric>

namespace isobath {
namespace {

constexpr int kFramesTogether = 4;  // neighbouring background frames in one fold, as in Calibration
constexpr double kWithin = 0.999;   // share of the background below the open level
constexpr double kMinShare = 1e-5;  // lower end of a chart, with room for its legend

/// Calls visit(frame, fold) for each frame.
template <class Visit>
void each_frame(std::span<const MarkedFrame> frames, int folds, const Visit& visit) {
  int background = 0, marked = 0;
  for (const MarkedFrame& frame : frames) {
    visit(frame, frame.background ? background++ / kFramesTogether % folds : marked++ % folds);
  }
}

int first_bin_of(const RangeWindow& window, double blanking_m) {
  return static_cast<int>(
      std::clamp(std::ceil((blanking_m - window.start_m) / window.bin_m - 1e-9), 0.0, double(window.bins)));
}

double fitting_width(std::span<const MarkedFrame> frames, int levels, double blanking_m) {
  const Ping& first = frames.front().ping;
  EchoHistogram all(EchoLevels(first.intensity.type(), first.full_scale), 1);
  for (const MarkedFrame& frame : frames) {
    const Ping& ping = frame.ping;
    if (!frame.background || ping.intensity.type() != first.intensity.type()) continue;
    for (int b = 0; b < ping.intensity.beams(); ++b) {
      for (int k = first_bin_of(ping.window, blanking_m); k < ping.window.bins; ++k) all.add(0, ping.intensity(b, k));
    }
  }
  const EchoDistribution noise(all, 0, 1);
  if (noise.samples() <= 0) return 0;
  const double width = noise.quantile(kWithin) / (levels - 1);
  const double most = static_cast<double>(first.full_scale) / levels;
  if (first.intensity.type() == SampleType::kF32) return std::clamp(width, most * 1e-3, most);
  return std::clamp(std::ceil(width), 1.0, std::max(1.0, std::ceil(most)));
}

/// Counts samples of held-out pixels by their likelihood ratio.
class RatioCounts {
 public:
  RatioCounts() : noise_(kCount, 0), target_(kCount, 0) {}

  void add(const MarkedFrame& frame, const LikelihoodRatios& ratios, int first_bin) {
    const int bins = frame.ping.window.bins;
    looked_up_.resize(static_cast<std::size_t>(frame.ping.intensity.beams()) * bins);
    ratios.look_up(frame.ping, looked_up_);
    for (std::size_t i = 0; i < looked_up_.size(); ++i) {
      if (static_cast<int>(i % static_cast<std::size_t>(bins)) < first_bin) continue;
      const auto at = static_cast<std::size_t>(std::ptrdiff_t{looked_up_[i]} + kZero);
      if (frame.background) ++noise_[at];
      if (!frame.background && frame.marked[i]) ++target_[at];
    }
  }
  [[nodiscard]] RocCurve curve() const {
    std::vector<double> edges(kCount + 1);
    std::iota(edges.begin(), edges.end(), -static_cast<double>(kZero));
    return {edges, noise_, target_};
  }

 private:
  static constexpr int kZero = 32768;
  static constexpr std::size_t kCount = 65536;
  std::vector<std::uint64_t> noise_, target_;
  std::vector<std::int16_t> looked_up_;
};

/// Draws a histogram as steps, one per level; empty levels lie at the lower end of the chart.
void steps(ChartPicture& chart, const HistogramModel& model, const std::vector<double>& shares, const Stroke& stroke,
           const std::string& name) {
  std::vector<double> x, y;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double share = std::max(shares[i], kMinShare), low = static_cast<double>(i) * model.config.level_width;
    x.insert(x.end(), {low, low + model.config.level_width});
    y.insert(y.end(), {share, share});
  }
  chart.curve(x, y, stroke, name);
}

ChartPicture histogram_picture(const HistogramModel& model, const std::string& title) {
  const double end = model.config.levels * model.config.level_width;
  return {720,
          440,
          title,
          {fmt::format("intensity (counts); open level from {:g}", end - model.config.level_width), 0, end, false},
          {"share of samples", kMinShare, 1, true}};
}

}  // namespace

HistogramCalibration learn_histograms(std::span<const MarkedFrame> frames, const Configuration& configuration,
                                      std::span<const ThresholdComparison> comparisons, const std::string& source) {
  const CalibrationConfig& calibration = configuration.calibration;
  HistogramConfig config = configuration.histogram;
  if (config.level_width <= 0) config.level_width = fitting_width(frames, config.levels, calibration.blanking_m);
  std::vector<HistogramLearner> folds(static_cast<std::size_t>(calibration.folds), HistogramLearner(config));
  each_frame(frames, calibration.folds, [&](const MarkedFrame& frame, int fold) {
    HistogramLearner& learner = folds[static_cast<std::size_t>(fold)];
    if (frame.background) {
      learner.add_background(frame.ping);
    } else {
      learner.add_marked(frame.ping, frame.marked);
    }
  });
  const auto without = [&](int left_out) {
    HistogramLearner sum(config);
    for (int i = 0; i < calibration.folds; ++i) {
      if (i != left_out && folds[static_cast<std::size_t>(i)].has_noise())
        sum.add(folds[static_cast<std::size_t>(i)].model(source));
    }
    return sum;
  };
  HistogramCalibration result{without(-1).model(source), {}};

  if (comparisons.empty()) return result;
  RatioCounts counts;
  for (int held = 0; held < calibration.folds; ++held) {
    const LikelihoodRatios ratios(std::make_shared<const HistogramModel>(without(held).model(source)));
    each_frame(frames, calibration.folds, [&](const MarkedFrame& frame, int fold) {
      if (fold == held) counts.add(frame, ratios, first_bin_of(frame.ping.window, calibration.blanking_m));
    });
  }
  const RocCurve curve = counts.curve();
  const auto targets = static_cast<double>(curve.target_samples());
  for (const ThresholdComparison& c : comparisons) {
    const double p = curve.at_false_alarm(c.false_alarm.value).p;
    result.worth.push_back({c.false_alarm.value, {p, wilson_interval(p * targets, targets), targets}});
  }
  return result;
}

std::string noise_histogram_chart(const HistogramModel& model) {
  ChartPicture chart = histogram_picture(model, "Noise of some pixels, by range and bearing");
  const auto nearest_beam = [&](double degrees) {
    const auto nearer = [&](Angle a, Angle b) {
      return std::abs(a.degrees() - degrees) < std::abs(b.degrees() - degrees);
    };
    return static_cast<int>(std::min_element(model.azimuth.begin(), model.azimuth.end(), nearer) -
                            model.azimuth.begin());
  };
  struct Pixel {
    int beam, bin;
  };
  const int last = model.window.bins - 1, ahead = nearest_beam(0);
  const Pixel pixels[] = {{ahead, last / 8},       {ahead, last / 2},
                          {ahead, last * 15 / 16}, {nearest_beam(-5), last * 15 / 16},
                          {0, last * 15 / 16},     {model.beams() - 1, last * 15 / 16}};
  int drawn = 0;
  for (const Pixel& p : pixels) {
    const Colour shade = intensity_colour(0.05 + 0.17 * drawn);
    steps(chart, model, model.noise_shares(p.beam, p.bin), {shade, 1.6, drawn >= 3},
          fmt::format("{:.1f} m, {} deg", model.window.centre(p.bin),
                      std::lround(model.azimuth[static_cast<std::size_t>(p.beam)].degrees())));
    ++drawn;
  }
  chart.finish();
  return chart.png();
}

std::string object_histogram_chart(const HistogramModel& model) {
  ChartPicture chart = histogram_picture(
      model, fmt::format("Objects of {} marked frames, and the noise of all pixels", model.marked_pings));
  std::vector<double> noise(static_cast<std::size_t>(model.config.levels), 0);
  for (std::size_t i = 0; i < model.noise.size(); ++i) noise[i % noise.size()] += model.noise[i];
  const double all = std::accumulate(noise.begin(), noise.end(), 0.0);
  for (double& n : noise) n /= all;
  steps(chart, model, noise, {palette::kTrack, 2, false}, "noise");
  steps(chart, model, model.object_shares(), {palette::kObstacle, 2, false}, "objects");
  chart.finish();
  return chart.png();
}

}  // namespace isobath

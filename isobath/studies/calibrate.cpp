#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/frames/frame_folder.hpp>
#include <isobath/io/frames/marked_frames.hpp>
#include <isobath/io/open_source.hpp>
#include <isobath/report/html_report.hpp>
#include <isobath/report/plot/picture.hpp>
#include <isobath/studies/calibrate.hpp>
#include <isobath/studies/truth_marks.hpp>

namespace isobath {
namespace {

Colour group_colour(std::size_t group, std::size_t groups) {
  return intensity_colour(0.05 + 0.75 * static_cast<double>(group) /
                                     static_cast<double>(std::max<std::size_t>(groups, 2) - 1));
}

double strongest(const Ping& ping, double blanking_m, std::vector<float>& beam) {
  beam.resize(static_cast<std::size_t>(ping.window.bins));
  float most = 0;
  for (int b = 0; b < ping.fan->beams(); ++b) {
    ping.intensity.copy_beam(b, beam.data());
    for (int k = 0; k < ping.window.bins; ++k) {
      if (ping.window.edge(k) >= blanking_m) most = std::max(most, beam[static_cast<std::size_t>(k)]);
    }
  }
  return static_cast<double>(most);
}

void add_marked_frames(Calibration& calibration, std::span<const MarkedFrame> frames) {
  for (const MarkedFrame& frame : frames) {
    if (frame.background) {
      calibration.add_background(frame.ping);
    } else {
      calibration.add_marked(frame.ping, frame.marked);
    }
  }
}

/// Learns the noise of a recording, and takes the objects of another model.
class BorrowedObjects {
 public:
  BorrowedObjects(const std::filesystem::path& model, HistogramConfig config)
      : objects_(load_histogram_model(model)), learner_(with_levels(config, objects_.config)) {}

  void add(const Ping& background) { learner_.add_background(background); }
  void add(std::span<const MarkedFrame> frames) {
    for (const MarkedFrame& frame : frames) {
      if (frame.background) {
        learner_.add_background(frame.ping);
      } else {
        learner_.add_marked(frame.ping, frame.marked);
      }
    }
  }
  HistogramModel model(const std::string& source) {
    learner_.add_objects(objects_);
    return learner_.model(source);
  }

 private:
  static HistogramConfig with_levels(HistogramConfig config, const HistogramConfig& from) {
    config.levels = from.levels;
    config.level_width = from.level_width;
    return config;
  }
  HistogramModel objects_;
  HistogramLearner learner_;
};

/// Learns a fan model without marks: survey() in the first reading, then prepare(), add() in the second reading.
class FanPart {
 public:
  explicit FanPart(const Configuration& configuration) : config_(configuration.echoes.fan), survey_(config_) {
    config_.blanking_m = configuration.echoes.blanking_m;
  }
  void survey(const Ping& ping) { survey_.add(ping); }
  void prepare(CalibrateOutcome& outcome) {
    const auto setting = survey_.most();
    if (!setting) return;
    setting_ = *setting;
    try {
      learner_.emplace(*setting, config_);
    } catch (const Error& e) {
      outcome.no_fan = e.what();
    }
  }
  /// Whether the ping has the setting that is learnt; true for every ping if there is no fan.
  bool add(const Ping& ping) {
    if (learner_) return learner_->add(ping);
    return !setting_ || *setting_ == ping;
  }
  void finish(const std::string& source, CalibrateOutcome& outcome) const {
    if (learner_) outcome.fan = {learner_->finish(source), survey_.pings() - setting_->pings};
  }

 private:
  FanDetectorConfig config_;
  FanSurvey survey_;
  std::optional<FanSetting> setting_;
  std::optional<FanLearner> learner_;
};

template <class Visit>
void for_pings(const CalibrateRequest& request, const Visit& visit) {
  const auto source = open_source(request.input, request.configuration.input);
  while (const auto event = source->next()) {
    const auto* ping = std::get_if<Ping>(&*event);
    if (ping && check(*ping) == PingFault::kNone) visit(*ping, source->report());
  }
}

/// Reads a log twice, to survey and to learn a fan. With `background_below` reads it once, and learns no fan.
void add_log(Calibration& calibration, BorrowedObjects* borrowed, const CalibrateRequest& request,
             CalibrateOutcome& outcome) {
  FanPart fan(request.configuration);
  if (!request.background_below) {
    for_pings(request, [&](const Ping& ping, const SourceReport&) { fan.survey(ping); });
    fan.prepare(outcome);
  }
  std::vector<float> beam;
  std::uint64_t pings = 0;
  for_pings(request, [&](const Ping& ping, const SourceReport& report) {
    const bool quiet = !request.background_below ||
                       strongest(ping, request.configuration.calibration.blanking_m, beam) < *request.background_below;
    if (fan.add(ping) && quiet) {
      calibration.add_background(ping);
      if (borrowed) borrowed->add(ping);
    } else {
      ++outcome.left_out;
    }
    if (request.progress) request.progress(report, ++pings);
  });
  fan.finish(request.input.filename().string(), outcome);
}

/// Learns a fan from frames, if none of them is marked.
void add_fan_frames(std::span<const MarkedFrame> frames, const CalibrateRequest& request, CalibrateOutcome& outcome) {
  FanPart fan(request.configuration);
  for (const MarkedFrame& frame : frames) {
    if (!frame.background) return;
    fan.survey(frame.ping);
  }
  fan.prepare(outcome);
  for (const MarkedFrame& frame : frames) fan.add(frame.ping);
  fan.finish(request.input.filename().string(), outcome);
}

/// Reads the marks, the background and the fan of the input; returns the marked frames, of which a log has none.
std::vector<MarkedFrame> read_calibration_input(Calibration& calibration, BorrowedObjects* borrowed,
                                                const CalibrateRequest& request, CalibrateOutcome& outcome) {
  std::vector<MarkedFrame> frames;
  if (request.truth) {
    TruthMarks marks = read_truth_marks(request.input, request.configuration.input, request.sonar);
    outcome.left_out = marks.left_out;
    frames = std::move(marks.frames);
    add_marked_frames(calibration, frames);
    if (borrowed) borrowed->add(frames);
  } else if (!request.background_below && looks_like_frame_folder(request.input)) {
    frames = read_marked_frames(request.input, request.configuration.input);
    add_marked_frames(calibration, frames);
    if (borrowed) borrowed->add(frames);
    add_fan_frames(frames, request, outcome);
  } else {
    add_log(calibration, borrowed, request, outcome);
  }
  return frames;
}

CalibrateOutcome learn_models(const CalibrateRequest& request) {
  Calibration calibration(request.configuration.calibration);
  CalibrateOutcome outcome;
  std::optional<BorrowedObjects> borrowed;
  if (!request.objects.empty()) borrowed.emplace(request.objects, request.configuration.histogram);
  const std::vector<MarkedFrame> frames =
      read_calibration_input(calibration, borrowed ? &*borrowed : nullptr, request, outcome);
  outcome.result = calibration.finish(request.input.filename().string());
  const CalibrationResult& result = outcome.result;
  if (borrowed) {
    outcome.histograms.emplace(HistogramCalibration{borrowed->model(result.model.source), {}});
  } else if (result.marked_cells > 0 && frames.front().ping.fan->beams() > 1) {  // a scanning head has no pixels
    outcome.histograms = learn_histograms(frames, request.configuration, result.comparison, result.model.source);
  }
  return outcome;
}

// Charts -------------------------------------------------------------------------------------------------------------

std::string roc_chart(const CalibrationResult& result) {
  ChartPicture chart(640, 460, "Detection against false alarms, by range (dashed: theory)",
                     {"false-alarm probability f", 1e-4, 1, true}, {"detection probability p", 0, 1});
  for (std::size_t g = 0; g < result.groups.size(); ++g) {
    const RangeGroup& group = result.groups[g];
    if (!group.roc) continue;
    std::vector<double> f, p, low, high;
    for (const RocPoint& point : group.roc->points()) {
      const auto trials = static_cast<double>(group.roc->target_samples());
      const Interval interval = wilson_interval(point.p * trials, trials);
      f.push_back(std::max(point.f, 1e-4));
      p.push_back(point.p);
      low.push_back(interval.low);
      high.push_back(interval.high);
    }
    Colour shade = group_colour(g, result.groups.size());
    const std::string name =
        fmt::format("{:.1f} to {:.1f} m, {} marked cells", group.near_m, group.far_m, group.roc->target_samples());
    chart.band(f, low, high, {shade.red, shade.green, shade.blue, 0.12});
    chart.curve(f, p, {shade, 2, false}, name);
    std::vector<double> theory_f, theory_p;
    for (double decade = -4; decade <= 0; decade += 0.05) {
      theory_f.push_back(std::pow(10, decade));
      theory_p.push_back(theoretical_detection(std::min(theory_f.back(), 1 - 1e-9), group.snr));
    }
    chart.curve(theory_f, theory_p, {shade, 1.2, true}, "");
  }
  chart.finish();
  return chart.png();
}

std::string threshold_chart(const CalibrationResult& result) {
  const SensorModel& model = result.model;
  std::vector<double> range, threshold, mean, low, high;
  double top = 1;
  for (int k = 0; k < model.window.bins; ++k) {
    const SensorModel::Bin& bin = model.bins[static_cast<std::size_t>(k)];
    if (bin.blind) continue;
    range.push_back(model.window.centre(k));
    threshold.push_back(bin.threshold);
    mean.push_back(bin.noise_mean);
    low.push_back(std::max(0.0, bin.noise_mean - bin.noise_deviation));
    high.push_back(bin.noise_mean + bin.noise_deviation);
    top = std::max({top, bin.threshold, high.back()});
  }
  ChartPicture chart(640, 380, fmt::format("Thresholds at f = {:g}, and the noise", model.false_alarm),
                     {"range (m)", model.window.start_m, model.window.end_m(), false},
                     {"intensity (counts)", 0, 1.1 * top, false});
  chart.band(range, low, high, {0.0, 0.45, 0.7, 0.18});
  chart.curve(range, mean, {palette::kTrack, 2, false}, "noise: mean and standard deviation");
  chart.curve(range, threshold, {palette::kObstacle, 2, false}, "threshold t");
  chart.finish();
  return chart.png();
}

std::string detection_chart(const CalibrationResult& result) {
  const SensorModel& model = result.model;
  std::vector<double> range, p;
  for (int k = 0; k < model.window.bins; ++k) {
    const SensorModel::Bin& bin = model.bins[static_cast<std::size_t>(k)];
    if (bin.blind) continue;
    range.push_back(model.window.centre(k));
    p.push_back(bin.p_detect);
  }
  ChartPicture chart(640, 380, "Detection probability at these thresholds",
                     {"range (m)", model.window.start_m, model.window.end_m(), false}, {"p", 0, 1, false});
  chart.curve(range, p, {palette::kObstacle, 2, false}, "p of the range bin");
  chart.finish();
  return chart.png();
}

// Report -------------------------------------------------------------------------------------------------------------

std::string with_interval(const Rate& rate) {
  return fmt::format("{:.4f} [{:.4f}, {:.4f}]", rate.value, rate.interval.low, rate.interval.high);
}

void add_fits(HtmlReport& page, const CalibrationResult& result) {
  page.heading("Noise laws");
  page.paragraph(
      "Anderson-Darling statistic of each law (smaller fits better), with the p-value of a parametric bootstrap. With "
      "many samples every law is rejected on real noise; the statistics show which law fits best.");
  std::vector<HtmlReport::Row> rows;
  for (const RangeGroup& group : result.groups) {
    HtmlReport::Row row{fmt::format("{:.2f} to {:.2f}", group.near_m, group.far_m)};
    for (const NoiseFit& fit : group.fits) {
      row.push_back(fmt::format("{}: {:.1f} (p {:.2f}; location {:.1f}, scale {:.1f}{})", to_text(fit.law),
                                fit.statistic, fit.p_value, fit.location, fit.scale,
                                fit.law == NoiseLaw::kK ? fmt::format(", shape {:.2f}", fit.shape) : ""));
    }
    rows.push_back(std::move(row));
  }
  page.table({"range (m)", "law", "", ""}, rows);
}

void add_comparison(HtmlReport& page, const CalibrationResult& result,
                    const std::optional<HistogramCalibration>& histograms) {
  page.heading("Per-bin thresholds and per-pixel histograms, against one threshold for all bins");
  page.paragraph(
      "Measured on frames that were not used for the thresholds (cross-validation), at the same measured false-alarm "
      "rate, with 95 % Wilson intervals.");
  std::vector<HtmlReport::Row> rows;
  const auto worth = histograms ? std::span(histograms->worth) : std::span<const HistogramCalibration::Worth>();
  for (std::size_t i = 0; i < result.comparison.size(); ++i) {
    const ThresholdComparison& c = result.comparison[i];
    rows.push_back({fmt::format("{:g}", c.nominal_false_alarm), with_interval(c.false_alarm), with_interval(c.per_bin),
                    with_interval(c.global), i < worth.size() ? with_interval(worth[i].detected) : ""});
  }
  page.table({"nominal f", "measured f", "p, per-bin thresholds", "p, one threshold", "p, per-pixel histograms"}, rows);
}

/// The charts of the models, as PNG; empty where there is no such model.
struct CalibrationCharts {
  std::string roc, thresholds, fan_level, fan_gains, noise, objects;
};

/// Writes the models and their charts, and lists them in `outcome.files`.
CalibrationCharts write_models(const std::filesystem::path& folder, CalibrateOutcome& outcome) {
  const auto write = [&](const std::string& name, const std::string& bytes) {
    write_whole_file(folder / name, bytes);
    outcome.files.emplace_back(name);
  };
  const CalibrationResult& result = outcome.result;
  CalibrationCharts charts;
  write("sensor_model.json", write_sensor_model(result.model));
  write("calibration.json", to_json(result));
  if (result.marked_cells > 0) charts.roc = roc_chart(result);
  charts.thresholds = threshold_chart(result);
  if (!charts.roc.empty()) write("roc.png", charts.roc);
  write("thresholds.png", charts.thresholds);
  if (outcome.fan) {
    write("fan_model.json", write_fan_model(outcome.fan->model));
    write("fan_level.png", charts.fan_level = level_chart(outcome.fan->model));
    write("fan_gains.png", charts.fan_gains = gain_chart(outcome.fan->model));
  }
  if (outcome.histograms) {
    const HistogramModel& model = outcome.histograms->model;
    write("histogram_model.bin", write_histogram_model(model));
    write("noise_histograms.png", charts.noise = noise_histogram_chart(model));
    write("object_histogram.png", charts.objects = object_histogram_chart(model));
  }
  return charts;
}

void add_charts(HtmlReport& page, const CalibrateOutcome& outcome, const CalibrationCharts& charts) {
  page.begin_row();
  if (!charts.roc.empty()) {
    page.figure(
        charts.roc,
        "Receiver operating characteristic by range, with 95 % bands of p. Dashed: the theory of a constant echo in "
        "Gaussian noise of the same signal-to-noise ratio.");
  }
  page.figure(charts.thresholds, "Echo threshold of the model by range bin.");
  page.figure(detection_chart(outcome.result), "Share of targets above the threshold.");
  if (outcome.histograms) {
    page.figure(charts.noise, "Noise of single pixels, smoothed with their neighbours in range.");
    page.figure(charts.objects, "Intensity of objects, against that of all noise.");
  }
  if (outcome.fan) {
    page.figure(charts.fan_level, "Level of the water by range.");
    page.figure(charts.fan_gains, "Gain of each beam relative to the median beam.");
  }
  page.end_row();
}

std::string calibration_page(const CalibrateRequest& request, const CalibrateOutcome& outcome,
                             const CalibrationCharts& charts) {
  const CalibrationResult& result = outcome.result;
  HtmlReport page("Isobath calibration: " + request.input.filename().string(),
                  fmt::format("{} pings of background, {} with marks ({} marked cells), {} left out; f = {:g}",
                              result.background_pings, result.marked_pings, result.marked_cells, outcome.left_out,
                              result.model.false_alarm));
  add_charts(page, outcome, charts);
  if (outcome.fan) {
    page.heading("Fan model, learnt without marks");
    for (const std::string& line : lines_of(*outcome.fan)) page.paragraph(line);
  }
  if (!result.comparison.empty()) add_comparison(page, result, outcome.histograms);
  add_fits(page, result);
  page.folded("Configuration in force", to_toml(request.configuration, true));
  return page.html();
}

}  // namespace

CalibrateOutcome calibrate(const CalibrateRequest& request) {
  CalibrateOutcome outcome = learn_models(request);
  make_folder(request.out);
  const CalibrationCharts charts = write_models(request.out, outcome);
  write_whole_file(request.out / "report.html", calibration_page(request, outcome, charts));
  outcome.files.emplace_back("report.html");
  return outcome;
}

}  // namespace isobath

#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/option_facts.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/app/values.hpp>
#include <isobath/base/file_access.hpp>
#include <isobath/studies/calibrate.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct CalibrateOptions {
  ConfigOptions config;
  CalibrateRequest request;
  bool json = false;
};

void print(const CalibrateRequest& request, const CalibrateOutcome& outcome) {
  const CalibrationResult& result = outcome.result;
  fmt::print("{} pings of background, {} with marks ({} marked cells), {} left out\n", result.background_pings,
             result.marked_pings, result.marked_cells, outcome.left_out);
  for (std::size_t i = 0; i < result.comparison.size(); ++i) {
    const ThresholdComparison& c = result.comparison[i];
    fmt::print(
        "f = {:.4f} (asked for {:g}): thresholds a bin p = {:.3f} [{:.3f}, {:.3f}], one threshold p = {:.3f} [{:.3f}, "
        "{:.3f}]",
        c.false_alarm.value, c.nominal_false_alarm, c.per_bin.value, c.per_bin.interval.low, c.per_bin.interval.high,
        c.global.value, c.global.interval.low, c.global.interval.high);
    if (outcome.histograms && i < outcome.histograms->worth.size()) {
      const Rate& p = outcome.histograms->worth[i].detected;
      fmt::print(", histograms a pixel p = {:.3f} [{:.3f}, {:.3f}]", p.value, p.interval.low, p.interval.high);
    }
    fmt::print("\n");
  }
  if (outcome.fan) {
    for (const std::string& line : lines_of(*outcome.fan)) fmt::print("{}\n", line);
    fmt::print("use it: isobath run LOG --set sensor.model={}\n", (request.out / "fan_model.json").string());
  }
  if (!outcome.no_fan.empty()) fmt::print("no fan model: {}\n", outcome.no_fan);
  fmt::print("written to {}: sensor_model.json and {} more files\n", request.out.string(), outcome.files.size() - 1);
}

/// How well histograms per pixel detect, at the false-alarm rates of the cross-validation.
nlohmann::ordered_json histograms_json(const HistogramCalibration& histograms) {
  auto json = nlohmann::ordered_json::array();
  for (const HistogramCalibration::Worth& worth : histograms.worth) {
    const Rate& p = worth.detected;
    json.push_back(
        {{"false_alarm", worth.false_alarm},
         {"p", {{"value", p.value}, {"interval", {p.interval.low, p.interval.high}}, {"trials", p.trials}}}});
  }
  return json;
}

int act(CalibrateOptions& options) {
  CalibrateRequest& request = options.request;
  request.configuration = options.config.read();
  check_output_folder(request.out, "--out");
  ProgressLine progress;
  request.progress = [&](const SourceReport& source, std::uint64_t pings) {
    progress.show(source.bytes_read, source.bytes_total, pings);
  };
  const CalibrateOutcome outcome = calibrate(request);
  progress.clear();
  if (options.json) {
    auto json = nlohmann::ordered_json::parse(to_json(outcome.result));
    json["pings_left_out"] = outcome.left_out;
    json["histograms"] = outcome.histograms ? histograms_json(*outcome.histograms) : nlohmann::ordered_json();
    json["fan"] = outcome.fan ? fan_json(*outcome.fan) : nlohmann::ordered_json();
    json["no_fan"] = outcome.no_fan;
    add_files(json, request.out, outcome.files);
    print_json(json);
  } else {
    print(request, outcome);
  }
  return kSuccess;
}

}  // namespace

Action add_calibrate(CLI::App& program) {
  auto options = std::make_shared<CalibrateOptions>();
  CalibrateRequest& request = options->request;
  request.out = "out/calibration";
  CLI::App* command = program.add_subcommand(
      "calibrate", "Learn the model of a sonar from an ordinary recording of one minute or from marked frames");
  command->add_option("LOG", request.input, "A log, or a folder of frames, with or without marks")
      ->check(reads())
      ->required();
  add_output_folder(*command, request.out, "Folder for the results");
  add_json_flag(*command, options->json);
  command
      ->add_option("--background-below", request.background_below,
                   "Without marks: pings whose strongest sample is below this many counts are background")
      ->check(number(0, INFINITY))
      ->group("Input");
  command
      ->add_option("--objects", request.objects,
                   "Histogram model whose object histogram is used, for a log without marks")
      ->type_name("FILE")
      ->check(reads())
      ->group("Input");
  command->add_flag("--truth", request.truth, "Take the marks from the ground truth of a simulated log")
      ->group("Input");
  command->add_option("--sonar", request.sonar, "With --truth: name of the sonar in the scene")
      ->type_name("NAME")
      ->default_str("that of the first ping")
      ->group("Input");
  options->config.add_to(*command);
  add_example(*command, "calibrate water.oculus --out out/sonar");
  add_example(*command, "calibrate simulated.mcap --truth --out out/model");
  add_example(*command, "calibrate frames/ --set calibration.false_alarm=0.01 --json");
  return [options] { return act(*options); };
}

}  // namespace isobath::app

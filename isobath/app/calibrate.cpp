#include <fmt/format.h>
#include <isobath/app/config_options.hpp>
#include <isobath/app/json_output.hpp>
#include <isobath/app/progress.hpp>
#include <isobath/studies/calibrate.hpp>
#include <memory>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

struct Options {
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

int act(Options& options) {
  CalibrateRequest& request = options.request;
  request.configuration = options.config.read();
  ProgressLine progress;
  request.progress = [&](const SourceReport& source, std::uint64_t pings) {
    progress.show(source.bytes_read, source.bytes_total, pings);
  };
  const CalibrateOutcome outcome = calibrate(request);
  progress.clear();
  if (options.json) {
    auto json = nlohmann::ordered_json::parse(to_json(outcome.result));
    if (outcome.fan) json["fan"] = fan_json(*outcome.fan);
    add_files(json, request.out, outcome.files);
    print_json(json);
  } else {
    print(request, outcome);
  }
  return kSuccess;
}

}  // namespace

Action add_calibrate(CLI::App& program) {
  auto options = std::make_shared<Options>();
  options->request.out = "out/calibration";
  CLI::App* command = program.add_subcommand(
      "calibrate", "Learn the model of a sonar from an ordinary recording of one minute or from marked frames");
  command->add_option("LOG", options->request.input, "A log, or a folder of frames, with or without marks")->required();
  command->add_option("--out", options->request.out, "Folder for the results")->capture_default_str();
  command->add_option("--background-below", options->request.background_below,
                      "Without marks: pings whose strongest sample is below this many counts are background");
  command->add_option("--objects", options->request.objects,
                      "Histogram model whose object histogram is used, for a log without marks");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  options->config.add_to(*command);
  return [options] { return act(*options); };
}

}  // namespace isobath::app

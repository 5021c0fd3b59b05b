#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isobath/report/fan_calibration.hpp>
#include <isobath/report/plot/picture.hpp>
#include <nlohmann/json.hpp>
#include <span>

namespace isobath {
namespace {

using nlohmann::ordered_json;

std::string delivered_text(const FanModel::Delivered& d) {
  return d.cells > 0 ? fmt::format("{:.2f} [{:.2f}, {:.2f}]", d.ratio, d.low, d.high) : "unknown";
}

ordered_json delivered_json(const FanModel::Delivered& d) {
  return {{"ratio", d.ratio}, {"low", d.low}, {"high", d.high}, {"cells", d.cells}};
}

double level_db(double power) { return 10 * std::log10(std::max(power, 1e-6)); }

std::string gains_text(const FanModel& model) {
  std::vector<double> heard;
  for (const double g : model.gains_db) {
    if (g > FanModel::kFaintest_db) heard.push_back(g);
  }
  if (heard.empty()) return "all beams are silent";
  const auto [low, high] = std::minmax_element(heard.begin(), heard.end());
  const auto apart = std::count_if(heard.begin(), heard.end(), [](double g) { return std::abs(g) > 3; });
  return fmt::format("{:+.1f} to {:+.1f} dB from the median beam, {} of {} rows of cells beyond 3 dB", *low, *high,
                     apart, model.gains_db.size());
}

}  // namespace

std::vector<std::string> lines_of(const FanCalibration& calibration) {
  const FanModel& m = calibration.model;
  const RangeWindow& w = m.window;
  std::vector<std::string> lines{
      fmt::format("sonar: {}, {:.2f} to {:.2f} m in {} bins, samples {}", sonar_text(m.beams, m.beam_width, m.span),
                  w.start_m, w.end_m(), w.bins, to_text(m.type)),
      fmt::format("recording: {} pings in {:.1f} s, {} of other settings left out", m.pings, m.seconds,
                  calibration.left_out),
      m.blanking_m > w.start_m ? fmt::format("blind zone: to {:.2f} m", m.blanking_m)
                               : std::string("blind zone: none found within the window"),
      "gains: " + gains_text(m),
      m.dead_beams.empty() ? std::string("dead beams: none")
                           : fmt::format("dead beams: {} (counted from 0)", fmt::join(m.dead_beams, ", ")),
      fmt::format("samples: {:.2f} % at full scale, {:.2f} % at zero", 100 * m.clipped, 100 * m.silent),
      fmt::format("correlation of neighbours: beams {:.2f}, ranges {:.2f}, pings {:.2f}; a cell of a ping is {:.2f} of "
                  "an independent look",
                  m.correlation.beams, m.correlation.bins, m.correlation.pings, m.looks)};
  for (std::size_t i = 0; i < m.quality.size(); ++i) {
    const FanModel::Quality& q = m.quality[i];
    lines.push_back(fmt::format("false alarms at {:g}, measured over nominal: {}; near {}, middle {}, far {}",
                                FanModel::kAsked[i], delivered_text(q.whole), delivered_text(q.thirds[0]),
                                delivered_text(q.thirds[1]), delivered_text(q.thirds[2])));
  }
  return lines;
}

ordered_json fan_json(const FanCalibration& calibration) {
  const FanModel& m = calibration.model;
  ordered_json quality = ordered_json::array();
  for (std::size_t i = 0; i < m.quality.size(); ++i) {
    ordered_json thirds = ordered_json::array();
    for (const auto& d : m.quality[i].thirds) thirds.push_back(delivered_json(d));
    quality.push_back(
        {{"asked", FanModel::kAsked[i]}, {"whole", delivered_json(m.quality[i].whole)}, {"thirds", thirds}});
  }
  return {
      {"beams", m.beams},
      {"beam_width_deg", m.beam_width.degrees()},
      {"span_deg", m.span.degrees()},
      {"start_m", m.window.start_m},
      {"end_m", m.window.end_m()},
      {"bins", m.window.bins},
      {"pings", m.pings},
      {"seconds", m.seconds},
      {"left_out", calibration.left_out},
      {"blind_m", m.blanking_m},
      {"gains_db", m.gains_db},
      {"dead_beams", m.dead_beams},
      {"clipped", m.clipped},
      {"silent", m.silent},
      {"correlation", {{"beams", m.correlation.beams}, {"bins", m.correlation.bins}, {"pings", m.correlation.pings}}},
      {"looks", m.looks},
      {"quality", quality}};
}

std::string level_chart(const FanModel& model) {
  std::vector<double> range, level;
  for (std::size_t k = 0; k < model.level.size(); ++k) {
    if (model.level[k] <= 0) continue;
    range.push_back(model.window.start_m + (static_cast<double>(k) + 0.5) * model.cell_m);
    level.push_back(level_db(model.level[k]));
  }
  double low = 0, high = 1;
  if (!level.empty()) {
    low = *std::min_element(level.begin(), level.end()) - 3;
    high = *std::max_element(level.begin(), level.end()) + 3;
  }
  ChartPicture chart(640, 380, "Level of the water by range",
                     {"range (m)", model.window.start_m, model.window.end_m(), false},
                     {"mean power of the samples (dB of one count)", low, high, false});
  chart.curve(range, level, {palette::kTrack, 2, false}, "median beam");
  if (model.blanking_m > model.window.start_m) chart.mark(model.blanking_m, "blind zone ends", palette::kObstacle);
  chart.finish();
  return chart.png();
}

std::string gain_chart(const FanModel& model) {
  std::vector<double> beam, gain;
  double most = 4;
  for (std::size_t r = 0; r < model.gains_db.size(); ++r) {
    beam.push_back((static_cast<double>(r) + 0.5) * model.beams / static_cast<double>(model.gains_db.size()));
    gain.push_back(std::clamp(model.gains_db[r], -20.0, 20.0));
    most = std::max(most, std::abs(gain.back()) + 1);
  }
  ChartPicture chart(640, 380, "Gain of the beams", {"beam", 0, static_cast<double>(model.beams), false},
                     {"gain over the median beam (dB)", -most, most, false});
  chart.curve(beam, gain, {palette::kTrack, 2, false}, "gain");
  chart.finish();
  return chart.png();
}

std::string to_text(const FanDeparture& d) {
  std::string text = fmt::format("fan model of {}: ", d.source);
  if (!d.same_setting) text += "another setting, so only its tail laws were used; ";
  if (d.dropped) text += "its tail laws were dropped because the first pings contradict them; ";
  if (d.same_setting) {
    text += fmt::format("level {:+.1f} dB relative to the model, {} of {} rows of cells differ by more than 3 dB, ",
                        d.level_db, d.beams_apart, d.rows);
  }
  return text + fmt::format(
                    "cells exceed its thresholds {:.2f} times as often as nominal ({:g}), {:.2f} % of the samples "
                    "at full scale (model {:.2f} %)",
                    d.exceeding / d.asked, d.asked, 100 * d.clipped, 100 * d.model_clipped);
}

ordered_json departure_json(const FanDeparture& d) {
  ordered_json json{{"source", d.source},        {"same_setting", d.same_setting},
                    {"laws_dropped", d.dropped}, {"pings", d.pings},
                    {"asked", d.asked},          {"exceeding", d.exceeding},
                    {"clipped", d.clipped},      {"clipped_in_model", d.model_clipped}};
  if (d.same_setting) {
    json["level_db"] = d.level_db;
    json["rows_apart"] = d.beams_apart;
    json["rows"] = d.rows;
  }
  return json;
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/nearest_name.hpp>
#include <isobath/base/thread_pool.hpp>
#include <isobath/scenario/embedded_files.hpp>
#include <isobath/studies/control_study.hpp>
#include <isobath/vehicle/vehicle_parameters.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

constexpr double kSeriesStep = 0.2;  // s, of the median error over time
constexpr std::string_view kVehicleFolder = "vehicles/", kVehicleEnding = ".toml";

ControlFigure figure_of(const std::vector<ControlScore>& scores, double ControlScore::*field) {
  std::vector<double> values;
  for (const ControlScore& score : scores) values.push_back(score.*field);
  std::ranges::sort(values);
  return {values[values.size() / 2], values.back()};
}

/// The error of a trial at a time after the change.
double error_at(const ControlTrial& trial, double after_s) {
  const double step = trial.samples[1].time_s - trial.samples[0].time_s;
  const auto index = std::lround((trial.change_s + after_s) / step);
  return trial.samples[static_cast<std::size_t>(std::clamp<long>(index, 0, std::ssize(trial.samples) - 1))].off_m();
}

ControlRow control_row(const std::string& vehicle, const VehicleModel& model, ControlTrialRequest one,
                       const ControlRequest& request, ThreadPool& pool) {
  std::vector<ControlTrial> trials(static_cast<std::size_t>(request.runs));
  pool.share(request.runs, 1, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      ControlTrialRequest mine = one;
      mine.run = request.first_run + i;
      trials[static_cast<std::size_t>(i)] = fly_trial(model, mine);
    }
  });
  std::vector<ControlScore> scores;
  for (const ControlTrial& trial : trials) scores.push_back(score(trial));
  ControlRow row;
  row.vehicle = vehicle;
  row.task = one.task;
  row.change = one.change;
  row.control = one.control;
  row.runs = request.runs;
  row.recovered = static_cast<int>(
      std::ranges::count_if(scores, [](const ControlScore& s) { return std::isfinite(s.recovery_s); }));
  row.before_rms_m = figure_of(scores, &ControlScore::before_rms_m);
  row.at_rms_m = figure_of(scores, &ControlScore::at_rms_m);
  row.after_rms_m = figure_of(scores, &ControlScore::after_rms_m);
  row.at_max_m = figure_of(scores, &ControlScore::at_max_m);
  row.after_max_m = figure_of(scores, &ControlScore::after_max_m);
  row.at_depth_max_m = figure_of(scores, &ControlScore::at_depth_max_m);
  row.at_level_max_m = figure_of(scores, &ControlScore::at_level_max_m);
  row.final_depth_m = figure_of(scores, &ControlScore::final_depth_m);
  row.final_level_m = figure_of(scores, &ControlScore::final_level_m);
  row.recovery_s = figure_of(scores, &ControlScore::recovery_s);
  const double leg_s = trials.front().leg_s;
  std::vector<double> errors(trials.size());
  for (double t = -leg_s; t <= 2.5 * leg_s; t += kSeriesStep) {
    std::ranges::transform(trials, errors.begin(), [t](const ControlTrial& trial) { return error_at(trial, t); });
    std::ranges::sort(errors);
    row.time_s.push_back(t);
    row.error_m.push_back(errors[errors.size() / 2]);
  }
  return row;
}

/// Whether the thrusters hold the vehicle, in the plane, in a current from any side.
bool holds_current(const VehicleModel& model, double speed) {
  const Allocator allocator(model);
  for (int i = 0; i < 36; ++i) {
    const double from = i * std::numbers::pi / 18;
    const Eigen::Vector2d through(speed * std::cos(from), speed * std::sin(from));
    Vector6 demand = Vector6::Zero();
    for (int axis = 0; axis < 2; ++axis) {
      const double v = through(axis);
      demand(axis) = (model.linear_damping(axis, axis) + model.quadratic_damping(axis, axis) * std::abs(v) +
                      model.lift_damping(axis, axis) * std::abs(through(0))) *
                     v;
    }
    if (allocator.allocate(demand, through(0), model.reference_density).scale < 1) return false;
  }
  return true;
}

/// The bars of a vehicle that hovers, for what the study has run.
void add_bars(const std::string& vehicle, const VehicleModel& model, ControlStudy& study) {
  constexpr double kPeakDepth_m = 0.1, kFinalDepth_m = 0.02, kPeakLevel_m = 0.3, kCurrent = 1;
  constexpr double kFormer = 1.25, kFormer_m = 0.005;  // former error: share of it, and beyond it
  const auto find = [&](ControlTask task, ControlChange change) {
    return study.row(vehicle, task, change, ControlKind::kAdaptive);
  };
  const auto add = [&](const std::string& what, double value, double bar, const std::string& why = {}) {
    study.bars.push_back({vehicle, what, value, bar, value <= bar, why});
  };
  for (const ControlChange change : {ControlChange::kBuoyant, ControlChange::kHeavy}) {
    const ControlRow* row = find(ControlTask::kStation, change);
    if (row == nullptr) continue;
    add(fmt::format("{}: greatest error of the depth, m", explained(change)), row->at_depth_max_m.most, kPeakDepth_m);
    add(fmt::format("{}: error of the depth at the end, m", explained(change)), row->final_depth_m.most, kFinalDepth_m);
  }
  if (const ControlRow* row = find(ControlTask::kStation, ControlChange::kStrongCurrent)) {
    add(fmt::format("{}: greatest error of the position, m", explained(row->change)), row->at_level_max_m.most,
        kPeakLevel_m, holds_current(model, kCurrent) ? "" : "its thrusters do not hold it in this current");
  }
  for (const ControlChange change : {ControlChange::kMass, ControlChange::kDrag}) {
    for (const ControlTask task : {ControlTask::kLine, ControlTask::kHelix}) {
      const ControlRow* row = find(task, change);
      if (row == nullptr) continue;
      add(fmt::format("{}, {}: rms error after, m; bar: the former", explained(change), to_text(task)),
          row->after_rms_m.median, kFormer * row->before_rms_m.median + kFormer_m);
    }
  }
}

}  // namespace

const ControlRow* ControlStudy::row(const std::string& vehicle, ControlTask task, ControlChange change,
                                    ControlKind control) const {
  const auto found = std::ranges::find_if(rows, [&](const ControlRow& r) {
    return r.vehicle == vehicle && r.task == task && r.change == change && r.control == control;
  });
  return found == rows.end() ? nullptr : &*found;
}

VehicleModel control_vehicle(const std::string& name_or_file) {
  std::vector<std::string> names;
  for (const EmbeddedFile& file : embedded_files()) {
    if (!file.name.starts_with(kVehicleFolder)) continue;
    names.emplace_back(
        file.name.substr(kVehicleFolder.size(), file.name.size() - kVehicleFolder.size() - kVehicleEnding.size()));
    if (names.back() == name_or_file) return parse_vehicle(file.text, std::string(file.name));
  }
  if (name_or_file.ends_with(kVehicleEnding)) return load_vehicle(name_or_file);
  std::string all;
  for (const std::string& name : names) all += name + ", ";
  throw Error("no such vehicle: " + name_or_file, {}, all + "or a vehicle file (.toml)",
              did_you_mean(name_or_file, names));
}

ControlStudy study_control(const ControlRequest& request) {
  if (request.runs < 1 || request.vehicles.empty()) throw Error("a study needs a vehicle and a run");
  ControlStudy study;
  ThreadPool pool(request.threads);
  for (const std::string& vehicle : request.vehicles) {
    const VehicleModel model = control_vehicle(vehicle);
    const bool hovers = parameters_of(model).min_speed == 0;
    for (const ControlTask task : request.tasks) {
      for (const ControlChange change : request.changes) {
        if (change == ControlChange::kTether && !hovers) continue;
        for (const ControlKind control : request.controls) {
          study.rows.push_back(control_row(vehicle, model, {task, change, control, 0}, request, pool));
        }
      }
    }
    if (hovers) add_bars(vehicle, model, study);
  }
  return study;
}

std::vector<std::vector<std::string>> control_table(const ControlStudy& study) {
  std::vector<std::vector<std::string>> table;
  std::vector<std::string> header = {"vehicle", "task", "change"};
  for (const ControlRow& row : study.rows) {
    if (table.empty() || table.back()[0] != row.vehicle || table.back()[1] != to_text(row.task) ||
        table.back()[2] != to_text(row.change)) {
      table.push_back({row.vehicle, to_text(row.task), to_text(row.change)});
    }
    const std::string recovery = row.recovered * 2 > row.runs ? fmt::format("{:.1f} s", row.recovery_s.median) : "no";
    table.back().push_back(fmt::format("{:.3f} {:.3f} {:.3f} {:>6}", row.before_rms_m.median, row.at_max_m.median,
                                       row.after_rms_m.median, recovery));
    if (table.size() == 1) header.emplace_back(to_text(row.control));
  }
  table.insert(table.begin(), header);
  return table;
}

}  // namespace isobath

// ControlStudy: three kinds of control, of the same vehicles, through the same tasks and changes, in many runs (ledger
// S7-08, S7-09, S7-11, S7-12; S7-D01, S7-D02). `isobath control` prints it. A pure function of its request, on any
// number of threads.
#pragma once

#include <filesystem>
#include <isobath/studies/control_trial.hpp>
#include <string>
#include <vector>

namespace isobath {

struct ControlRequest {
  std::vector<std::string> vehicles = {"bluerov2", "hovering_rov", "remus100"};  ///< of the program, or files
  std::vector<ControlTask> tasks{std::begin(kControlTasks), std::end(kControlTasks)};
  std::vector<ControlChange> changes{std::begin(kControlChanges), std::end(kControlChanges)};
  std::vector<ControlKind> controls{std::begin(kControlKinds), std::end(kControlKinds)};
  int runs = 20;
  int first_run = 0;
  int threads = 1;
};

/// A number over all runs of a row.
struct ControlFigure {
  double median = 0, most = 0;
};

/// All runs of one vehicle under one kind of control through one task and change.
struct ControlRow {
  std::string vehicle;
  ControlTask task = ControlTask::kStation;
  ControlChange change = ControlChange::kNone;
  ControlKind control = ControlKind::kPid;
  int runs = 0, recovered = 0;  ///< recovered: before the end of the run
  ControlFigure before_rms_m, at_rms_m, after_rms_m, at_max_m, after_max_m;
  ControlFigure at_depth_max_m, at_level_max_m, final_depth_m, final_level_m;
  ControlFigure recovery_s;
  /// The median error of the runs over the time from the change on.
  std::vector<double> time_s, error_m;
};

/// What the adaptive control must show (docs/control.md).
struct ControlBar {
  std::string vehicle, what;
  double value = 0, bar = 0;
  bool met = false;
  std::string why;  ///< why a bar does not hold for this vehicle; empty: it does
};

struct ControlStudy {
  std::vector<ControlRow> rows;
  std::vector<ControlBar> bars;

  [[nodiscard]] const ControlRow* row(const std::string& vehicle, ControlTask task, ControlChange change,
                                      ControlKind control) const;
};

/// Throws Error if a vehicle cannot be read. A vehicle that dives by pitch has no runs with a tether.
ControlStudy study_control(const ControlRequest& request);

/// The vehicle of the program with this name, or of a file. Throws Error.
VehicleModel control_vehicle(const std::string& name_or_file);

/// The heading and the rows of a table with the kinds of control beside each other.
std::vector<std::vector<std::string>> control_table(const ControlStudy& study);

/// report.html, control.csv and the pictures; returns the names of the files.
std::vector<std::filesystem::path> write_control_report(const ControlRequest& request, const ControlStudy& study,
                                                        const std::filesystem::path& folder);

}  // namespace isobath

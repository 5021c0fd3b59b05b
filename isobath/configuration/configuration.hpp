// Configuration: the structs of all classes, under the names that they have in a configuration file.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/cameras/camera_rig.hpp>
#include <isobath/configuration/recorder_config.hpp>
#include <isobath/configuration/report_config.hpp>
#include <isobath/io/input/input_config.hpp>
#include <isobath/onboard/onboard_configuration.hpp>
#include <isobath/sim/simulator.hpp>
#include <isobath/sonar/calibration.hpp>
#include <isobath/sonar/histogram_model.hpp>
#include <string>
#include <vector>

namespace isobath {

/// What runs on a vehicle has its settings in OnboardConfiguration; the others are those of input, cameras, simulator,
/// recorder, report and calibration.
struct Configuration : OnboardConfiguration {
  InputConfig input;
  CamerasConfig cameras;
  CalibrationConfig calibration;
  HistogramConfig histogram;
  SimulationConfig simulation;
  RecorderConfig recorder;
  ReportConfig report;
};

/// Bound to `configuration`, which must outlive them.
std::vector<Section> sections(Configuration& configuration);
/// The same with the lists: everything that a file may hold.
Schema schema(Configuration& configuration);
/// The values in force, as `schema` reads them.
std::string to_toml(const Configuration& configuration, bool annotated);

}  // namespace isobath

// FanCalibration: the model of a fan without marks (fan_learner.hpp) as text, JSON and charts, and how far a run
// departs from it.
#pragma once

#include <isobath/sonar/fan_learner.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace isobath {

struct FanCalibration {
  FanModel model;
  int left_out = 0;  ///< pings of other settings
};

/// One fact a line.
std::vector<std::string> lines_of(const FanCalibration& calibration);
nlohmann::ordered_json fan_json(const FanCalibration& calibration);
/// PNG: level by range, and gain by beam.
std::string level_chart(const FanModel& model);
std::string gain_chart(const FanModel& model);

/// One line: which model a run used, and how far its pings depart from it.
std::string to_text(const FanDeparture& departure);
nlohmann::ordered_json departure_json(const FanDeparture& departure);

}  // namespace isobath

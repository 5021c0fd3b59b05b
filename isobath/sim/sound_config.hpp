// Settings of a simulated passive array, and of the sounds of a scene (hydrophones.hpp; ledger S4-54).
#pragma once

#include <Eigen/Core>
#include <isobath/base/config.hpp>
#include <isobath/base/error.hpp>
#include <string>
#include <vector>

namespace isobath {

struct HydrophonesConfig {
  bool on = false;
  double interval_s = 1;
  Angle bearing_error = Angle::degrees(3);  ///< standard deviation of a bearing, bias included
  double bias_share = 0.5;                  ///< of that deviation which is the same in all bearings of a run
  Angle elevation_error = {};               ///< 0: elevation is not resolved
  double low_hz = 10, high_hz = 2000;
  double resolution_hz = 0.5;
  double noise_db = 75;  ///< of sea and vehicle, re 1 uPa2/Hz
  double gain_db = 6;
  double threshold_db = 8;
  double fluctuation_db = 3;
  Eigen::Vector3d position = {0, 0, 0};  ///< in B
};
std::vector<Field> fields(HydrophonesConfig& config);

/// A machine that sounds at one frequency.
struct SoundConfig {
  Place place = {};
  std::string name = {};
  std::string body = {};                 ///< name of the body that it sits in the middle of; empty: `position`
  Eigen::Vector3d position = {0, 0, 0};  ///< north, east, depth
  double frequency_hz = 120;
  double source_level_db = 130;  ///< of the line, re 1 uPa at 1 m
};
std::vector<Field> fields(SoundConfig& config);

/// Throws Error if a sound sits in no body of these names, or the band of the array is empty.
void check(const HydrophonesConfig& config, const std::vector<SoundConfig>& sounds,
           const std::vector<std::string>& bodies, const Place& scene);

}  // namespace isobath

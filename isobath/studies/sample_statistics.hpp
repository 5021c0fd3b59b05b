// SampleStatistics: statistics of the samples of one recording of an imaging sonar, without knowledge of the scene.
//
// Samples are in counts of a full scale of 255. Ranges within the blind zone (calibration.blanking_m, or what the ping
// states) are drawn but not counted. The rules:
// - Background: samples of a range group up to its median + 3 (median - 16 % level), or + 3 (84 % level - median) if
//   a threshold of the device cuts 40 % and more to 0; the margin is at least 2 counts. For that, half of the samples
//   of a range (84 % in the second case) must be water.
// - Bright: samples at least 12 dB (in amplitude: four times) above the mean background of their range group, and at
//   least 16 counts.
// - Brightest: the strongest 0.2 % of the samples of a scan, as many as a person marks in a frame of a hull (Teixeira
//   et al., IROS 2018).
// - Strongest echo of a scan: its -6 dB lengths are the runs of neighbours, along range and across bearing, that are at
//   least half as strong.
// - Spread over scans: standard deviation of one cell (beam, bin) from scan to scan; meaningful only if nothing moves.
// A scan is a ping of a fan, or a turn or sweep of a scanning head (sweep.hpp). Pings that differ from the first in
// window or number of beams are left out and counted.
#pragma once

#include <cstdint>
#include <isobath/sonar/echo_histogram.hpp>
#include <isobath/sonar/noise_fit.hpp>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/sweep.hpp>
#include <map>
#include <string>
#include <vector>

namespace isobath {

constexpr double kFullCounts = 255;                    ///< full scale of samples in counts
constexpr double kBrightRatio = 4, kBrightLeast = 16;  ///< minimum: times the background; counts
constexpr double kBrightestShare = 0.002;

/// Levels of the samples of one range interval, counts.
struct RangeLevels {
  double near_m = 0, far_m = 0;
  double samples = 0;
  double mean = 0, deviation = 0;
  double low = 0, median = 0, high = 0, top = 0;  ///< 16, 50, 84 and 99 %
  double zeros = 0;                               ///< share
  double background = 0;                          ///< mean of the background
  double background_limit = 0;                    ///< samples above it are not background
  std::vector<std::uint64_t> counts;              ///< by level
};

/// Levels of the samples that `counts` holds by level. Range, background and counts are not set.
RangeLevels levels_of(const EchoLevels& levels, const std::vector<std::uint64_t>& counts);

/// "Gaussian", "Rayleigh", "K".
const char* law_name(NoiseLaw law);

struct StrongestEcho {
  double level = 0;  ///< counts
  double range_m = 0;
  Angle azimuth;
  double length_m = 0;  ///< -6 dB, along range
  Angle width;          ///< -6 dB, across bearing
};

/// Rows by azimuth, columns by bin.
struct PolarImage {
  RangeWindow window;
  std::vector<Angle> azimuth;
  Angle width;  ///< width of a row, to draw gaps between rows
  std::vector<float> values;
  [[nodiscard]] float operator()(std::size_t row, int bin) const {
    return values[row * static_cast<std::size_t>(window.bins) + static_cast<std::size_t>(bin)];
  }
};

struct SampleStatistics {
  std::string name, format;
  std::uint64_t pings = 0, left_out = 0;
  int scans = 0;
  double blanking_m = 0;
  std::vector<RangeLevels> ranges;  ///< up to 120 groups of bins, from near to far, including the blind zone
  // Beyond the blind zone:
  RangeLevels all;
  EchoLevels levels;
  std::vector<std::uint64_t> counts;      ///< of all samples, by level
  std::vector<std::uint64_t> background;  ///< of the background
  double background_share = 0, background_mean = 0, background_deviation = 0;
  std::vector<NoiseFit> fits;                       ///< to the background; no p-values
  double bright_share = 0, bright_over_db = 0;      ///< mean bright over mean background, 20 log10
  double brightest_mean = 0, brightest_others = 0;  ///< mean of the brightest 0.2 %, and of the others
  std::vector<StrongestEcho> strongest;             ///< one per scan
  double spread_over_scans = 0;                     ///< rms over cells, counts; 0 with one scan
  double spread_over_cells = 0;                     ///< standard deviation of the mean image, counts
  PolarImage mean, scan;                            ///< mean of all scans; one scan from the middle
};

class SampleCollector {
 public:
  explicit SampleCollector(double blanking_m) : blanking_m_(blanking_m) {}
  void add(const Ping& ping);
  /// Throws Error that names `name` if no ping was taken, or if the blind zone covers the whole range.
  SampleStatistics finish(const std::string& name);

 private:
  struct Row {
    Angle azimuth;
    std::vector<double> sum, squares;
    std::uint64_t pings = 0;
  };
  void begin(const Ping& ping);
  void add_beam(int key, Angle azimuth);
  void end_scan();
  [[nodiscard]] int first_bin() const;
  void levels(SampleStatistics& out) const;

  double blanking_m_;
  bool begun_ = false, scanning_ = false;
  int beams_ = 0;
  float scale_ = 1;
  RangeWindow window_;
  Angle width_;
  EchoHistogram histogram_;
  std::map<int, Row> rows_;                              ///< by beam, or by azimuth in quarters of a degree
  std::map<int, std::vector<float>> current_;            ///< the open scan
  std::vector<std::map<int, std::vector<float>>> kept_;  ///< every 2^n-th scan, at most 16
  int keep_every_ = 1;
  std::vector<StrongestEcho> strongest_;
  std::vector<float> beam_, sorted_;
  double brightest_sum_ = 0, brightest_count_ = 0, others_sum_ = 0, others_count_ = 0;
  std::uint64_t pings_ = 0, left_out_ = 0;
  int scans_ = 0;
  SweepSegmenter sweeps_;
};

}  // namespace isobath

// FanModel: the properties of a fan sonar at one setting, learnt from an unmarked recording (ledger S6-06, S6-09,
// S6-64).
//
// FanLearner makes it; FanDetector starts from it. Content:
//
//   sonar        beams, median beam width, azimuth span: a model of another sonar is refused
//   setting      range window, sample type, full scale: at another setting only the tail laws are used
//   gains        of each row of cells (fan_cells.hpp) relative to the median row, dB; silent beams
//   level        of the quiet water by range: mean power of the samples, median row
//   blind zone   range below which the transmitter rings or the receiver is blanked
//   tail laws    of u = power / background, by stratum (fan_detector.hpp), and of all strata together
//   correlation  of neighbouring cells and successive pings; one cell of one ping is a share (1 - r) / (1 + r) of an
//                independent look for each of the three, as in a first-order process
//   quality      measured over requested false-alarm rate: laws of the first half of the pings, evaluated on the second
//
// Units: m, s, dB, power of the samples. The file is JSON, version 1; the reader trusts nothing in it.
#pragma once

#include <array>
#include <filesystem>
#include <isobath/sonar/ping.hpp>
#include <isobath/sonar/tail_law.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

struct FanModel {
  static constexpr int kThirds = 3, kStrata = 2 * kThirds * kThirds;  ///< quiet or loud, by thirds of range and beams
  static constexpr std::array<double, 3> kAsked{1e-2, 1e-3, 1e-4};
  static constexpr double kFaintest_db = -60;

  /// Measured over requested rate, with a 95 % interval for the number of independent looks among the cells.
  struct Delivered {
    double ratio = 0, low = 0, high = 0;
    double cells = 0;
    bool operator==(const Delivered&) const = default;
  };
  struct Quality {
    Delivered whole;
    std::array<Delivered, kThirds> thirds;  ///< by third of the ranges, nearest first
    bool operator==(const Quality&) const = default;
  };
  struct Correlation {
    double beams = 0, bins = 0, pings = 0;
    bool operator==(const Correlation&) const = default;
  };

  std::string source;  ///< description of the recording
  int beams = 0;
  Angle beam_width, span;
  RangeWindow window;
  SampleType type = SampleType::kU8;
  double full_scale = 255;

  std::vector<double> gains_db;  ///< by row of cells; kFaintest_db: silent
  std::vector<int> dead_beams;   ///< beams of the sonar, counted from 0
  std::vector<double> relief;    ///< by row: background relative to that of its range, in power
  double cell_m = 0;
  std::vector<double> level;  ///< by range cell
  double blanking_m = 0;      ///< distance from the sonar; the start of the window if there is no ringing
  std::array<TailLaw, kStrata> laws;
  TailLaw all;

  Correlation correlation;
  double looks = 1;  ///< independent looks per cell and ping
  double clipped = 0, silent = 0;
  int pings = 0;
  double seconds = 0;
  std::array<Quality, kAsked.size()> quality;

  /// Throws Error for sizes that disagree or values out of range.
  void check(const std::string& file = {}) const;
};

/// Sets beams, beam width and azimuth span of the model.
void set_sonar(FanModel& model, const BeamFan& fan);
bool same_sonar(const FanModel& model, const BeamFan& fan);
bool same_setting(const FanModel& model, const Ping& ping);
/// "256 beams of 1.0 deg over 130.0 deg".
std::string sonar_text(int beams, Angle beam_width, Angle span);
/// Throws Error if the ping is of another sonar than the model.
void require_same_sonar(const FanModel& model, const Ping& ping);

/// Departure of the pings of a run from its start model.
struct FanDeparture {
  std::string source;         ///< source of the model
  bool same_setting = false;  ///< false: only the tail laws are used
  bool dropped = false;       ///< the first pings contradicted its laws
  int pings = 0;              ///< number of pings at one setting
  double level_db = 0;        ///< level of the water relative to the model's, at the same setting
  double asked = 0;           ///< requested false-alarm rate
  double exceeding = 0;       ///< rate at which cells without a target exceed the threshold of the model
  int beams_apart = 0;        ///< rows of cells whose gain differs by more than 3 dB, at the same setting
  int rows = 0;
  double clipped = 0, model_clipped = 0;  ///< shares of the samples
};
const char* to_text(SampleType type);

std::string write_fan_model(const FanModel& model);
/// Throws Error with file and key.
FanModel read_fan_model(std::string_view text, const std::string& file);
/// Whether a text is meant as a fan model, as opposed to a sensor model.
bool looks_like_fan_model(std::string_view text);

}  // namespace isobath

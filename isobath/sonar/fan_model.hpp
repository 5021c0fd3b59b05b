// FanModel: what a recording without marks tells of the sonar of a fan at one setting (ledger S6-06, S6-09, S6-64).
//
// Made by FanLearner; FanDetector starts from one. What is in it:
//
//   sonar        beams, median beam width, azimuth span: a model of another sonar is refused
//   setting      range window, sample type, full scale: at another setting the tail laws alone are used
//   gains        of each row of cells (fan_cells.hpp) beside the median row, dB; beams that hear nothing
//   level        of the quiet water by range: mean power of the samples, median row
//   blind zone   nearer than this the transmitter rings or the receiver is blanked
//   tail laws    of u = power / background, stratum by stratum (fan_detector.hpp), and of all strata together
//   correlation  of neighbouring cells and successive pings; the share of an independent look that one cell of one ping
//                is, (1 - r) / (1 + r) for each of the three, as of a first-order process
//   quality      delivered over asked rate of false alarms: laws of the first half of the pings, judged on the second
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
  static constexpr int kThirds = 3, kStrata = 2 * kThirds * kThirds;  ///< quiet and loud; along the range; across
  static constexpr std::array<double, 3> kAsked{1e-2, 1e-3, 1e-4};
  static constexpr double kFaintest_db = -60;

  /// A measured rate over the rate that was asked for; the interval is 95 %, for the independent looks among the cells.
  struct Delivered {
    double ratio = 0, low = 0, high = 0;
    double cells = 0;
    bool operator==(const Delivered&) const = default;
  };
  struct Quality {
    Delivered whole;
    std::array<Delivered, kThirds> thirds;  ///< of the ranges, nearest first
    bool operator==(const Quality&) const = default;
  };
  struct Correlation {
    double beams = 0, bins = 0, pings = 0;
    bool operator==(const Correlation&) const = default;
  };

  std::string source;  ///< which recording: for people
  int beams = 0;
  Angle beam_width, span;
  RangeWindow window;
  SampleType type = SampleType::kU8;
  double full_scale = 255;

  std::vector<double> gains_db;  ///< of each row of cells; kFaintest_db: it hears nothing
  std::vector<int> dead_beams;   ///< of the sonar, counted from 0
  std::vector<double> relief;    ///< of each row: background beside that of its range, in power
  double cell_m = 0;
  std::vector<double> level;  ///< of each range cell
  double blind_m = 0;         ///< from the sonar; the start of the window where no ringing was heard
  std::array<TailLaw, kStrata> laws;
  TailLaw all;

  Correlation correlation;
  double looks = 1;  ///< independent ones of a cell and ping
  double clipped = 0, silent = 0;
  int pings = 0;
  double seconds = 0;
  std::array<Quality, kAsked.size()> quality;

  /// Throws Error: sizes that disagree, values out of range.
  void check(const std::string& file = {}) const;
};

/// Beams, beam width and azimuth span, into the model.
void set_sonar(FanModel& model, const BeamFan& fan);
bool same_sonar(const FanModel& model, const BeamFan& fan);
bool same_setting(const FanModel& model, const Ping& ping);
/// "256 beams of 1.0 deg over 130.0 deg".
std::string sonar_text(int beams, Angle beam_width, Angle span);
/// Throws Error where the ping is of another sonar than the model.
void require_same_sonar(const FanModel& model, const Ping& ping);

/// How far the pings of a run depart from the model that it began with.
struct FanDeparture {
  std::string source;         ///< of the model
  bool same_setting = false;  ///< else the tail laws alone were used
  bool dropped = false;       ///< the first pings contradicted its laws
  int pings = 0;              ///< at one setting
  double level_db = 0;        ///< of the water, against the model's; at the same setting
  double asked = 0;           ///< rate of false alarms
  double exceeding = 0;       ///< rate at which cells without a target exceed the threshold of the model
  int beams_apart = 0;        ///< rows of cells whose gain differs by more than 3 dB; at the same setting
  int rows = 0;
  double clipped = 0, model_clipped = 0;  ///< shares of the samples
};
const char* to_text(SampleType type);

std::string write_fan_model(const FanModel& model);
/// Throws Error with file and key.
FanModel read_fan_model(std::string_view text, const std::string& file);
/// Whether a text means to be one: a sensor model is another file.
bool looks_like_fan_model(std::string_view text);

}  // namespace isobath

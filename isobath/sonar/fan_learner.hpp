// FanLearner: learns a FanModel from about a minute of an ordinary, unmarked recording of a fan, in two passes:
//
//   FanSurvey    counts the pings of each setting, and finds the end of the ringing of each
//   FanLearner   uses the pings of one setting: it learns from all of them; and it learns from the first half, starts a
//                second detector from the result and evaluates it on the second half, as in a run that starts with it
//
// Targets are left out as in FanDetector: the recording may show objects if they do not fill it.
//
// Blind zone: found from the level over range, in cells. Ringing falls steeply or clips, a blanked receiver is silent;
// the water behind follows a straight line over the logarithm of the range. The zone ends at the first cell from which
// on three consecutive cells are within 3 dB of the line through the cells that follow three further on. Only the
// nearer half of the window is searched; without an end there, no blind zone is stated.
//
// Correlation: of u, each cell relative to its own mean over the second half, with the next cell and the next ping;
// cells beside an echo are left out. Intervals of the rates are Wilson's, with the number of independent looks as
// trials.
//
// Units as in FanModel. One thread; deterministic. Cost: two FanDetectors.
#pragma once

#include <isobath/sonar/fan_cells.hpp>
#include <isobath/sonar/fan_detector.hpp>
#include <isobath/sonar/fan_model.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// Pings of a fan at one range window.
struct FanSetting {
  FanModel identity;  ///< only sonar and setting
  int pings = 0;
  double blanking_m = 0;
  bool operator==(const Ping& ping) const { return same_sonar(identity, *ping.fan) && same_setting(identity, ping); }
};

class FanSurvey {
 public:
  explicit FanSurvey(const FanDetectorConfig& config = {}) : config_(config) {}
  /// Adds a ping that passes `check`. Pings of fewer than FanDetector::kMinBeams beams are not counted.
  void add(const Ping& ping);
  /// The setting with the most pings, the first of equal ones; empty: no fan.
  [[nodiscard]] std::optional<FanSetting> most() const;
  [[nodiscard]] int settings() const { return static_cast<int>(all_.size()); }
  [[nodiscard]] int pings() const { return pings_; }

 private:
  struct Heard {
    FanSetting setting;
    FanCells cells;
    std::vector<double> sum;
    int summed = 0;
  };
  [[nodiscard]] double blanking_m(const Heard& heard) const;
  FanDetectorConfig config_;
  std::vector<Heard> all_;
  int pings_ = 0;
};

class FanLearner {
 public:
  static constexpr int kMinPings = 40;

  /// Throws Error if the setting has fewer than kMinPings pings.
  explicit FanLearner(const FanSetting& setting, const FanDetectorConfig& config = {});
  /// Adds the pings of the recording, in order. Returns whether the ping has the setting.
  bool add(const Ping& ping);
  [[nodiscard]] FanModel finish(const std::string& source) const;

 private:
  void correlate();
  [[nodiscard]] FanModel::Correlation correlation() const;
  [[nodiscard]] std::array<FanModel::Quality, FanModel::kAsked.size()> quality(double looks) const;

  FanSetting setting_;
  FanDetector whole_, judged_;
  std::optional<FanModel> first_;  ///< of the first half
  EchoDecisions samples_;
  FanLooks looks_;
  int pings_ = 0;

  // Of each cell: number, sums of u and u^2; and pairs with the next row, the next cell, the next ping.
  struct Pairs {
    float n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
    void add(float a, float b) {
      ++n;
      x += a;
      y += b;
      xx += a * a;
      yy += b * b;
      xy += a * b;
    }
  };
  static double pooled(const std::vector<Pairs>& pairs);
  std::vector<Pairs> across_, along_, after_;
  std::vector<float> now_, before_;  ///< -1: left out
};

}  // namespace isobath

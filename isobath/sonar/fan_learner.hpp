// FanLearner: a minute of an ordinary recording of a fan, without marks, to a FanModel. Two readings of the recording:
//
//   FanSurvey    counts the pings of each setting; of each setting, where the ringing ends
//   FanLearner   the pings of one setting: learns from all of them; and learns from the first half, starts a second
//                detector from that and judges it on the second half, as a run that began with it would find it
//
// What holds a target is left out as FanDetector leaves it out: the recording may show things, if they do not fill it.
//
// Blind zone: level over range in cells. Ringing falls steeply or clips, a blanked receiver hears nothing; the water
// behind follows a straight line over the logarithm of the range. The zone ends with the first cell from which on three
// cells in a row stand within 3 dB of the line through the cells that follow three further on. Only the nearer half of
// the window is searched; without an end there nothing is said.
//
// Correlation: of u, each cell beside its own mean over the second half, with the next cell and the next ping; cells
// with an echo beside them are left out. Intervals of the rates are Wilson's, with as many trials as there are
// independent looks.
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
  FanModel identity;  ///< sonar and setting alone
  int pings = 0;
  double blind_m = 0;
  bool operator==(const Ping& ping) const { return same_sonar(identity, *ping.fan) && same_setting(identity, ping); }
};

class FanSurvey {
 public:
  explicit FanSurvey(const FanDetectorConfig& config = {}) : config_(config) {}
  /// The ping passes `check`. Fewer than FanDetector::kLeastBeams beams are no fan, and not counted.
  void add(const Ping& ping);
  /// The setting with most pings, the first of those; empty: there was no fan.
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
  [[nodiscard]] double blind_m(const Heard& heard) const;
  FanDetectorConfig config_;
  std::vector<Heard> all_;
  int pings_ = 0;
};

class FanLearner {
 public:
  static constexpr int kLeastPings = 40;

  /// Throws Error where the setting has fewer than kLeastPings pings.
  explicit FanLearner(const FanSetting& setting, const FanDetectorConfig& config = {});
  /// All pings of the recording, in order; whether this one is of the setting.
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

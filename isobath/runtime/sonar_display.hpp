// SonarDisplay: pings as pictures for a page: what each sonar heard, beam by beam, and what was decided of it.
//
// A sonar is known by the stance of its fan and by the fan itself, as in VoxelModel; a head that scans gives one beam a
// ping, and its beams are kept by their place in the turn. A fan of more than kMostBeams beams or kMostBins bins is
// pooled by maxima, so that no echo is lost to the eye. Samples of 8 bits are shown as they are, others in decibels
// below full scale.
//
// Items: sonar and echoes (docs/live-page.md). Times are those of the pings: at most kMostPerSecond of a fan are shown.
// Cost: 0.35 ms for 512 beams x 500 bins (DisplayOfAFan).
#pragma once

#include <isobath/runtime/display_items.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class SonarDisplay {
 public:
  static constexpr int kMostBeams = 256, kMostBins = 320;
  static constexpr int kMostPerSecond = 10;

  explicit SonarDisplay(DisplayItems& items) : items_(items) {}
  void take(const PosedPing& posed);

 private:
  struct Sonar {
    bool scanning = false, upright = false;
    std::shared_ptr<const BeamFan> fan;  ///< of the ping before
    RangeWindow window;
    int slots = 0;  ///< beams of a scanning head's turn; 0: not known yet
    std::optional<double> azimuth;
    std::optional<Time> shown;
    int beams_each = 1, bins_each = 1;  ///< pooled into one
  };
  struct Scale {
    bool decibels;
    double full;
  };
  Sonar& sonar_of(const Ping& ping, std::uint64_t& number);
  [[nodiscard]] bool describe(Sonar& sonar, std::uint64_t number, const Ping& ping);
  [[nodiscard]] std::string geometry(const Sonar& sonar, std::uint64_t number, const Ping& ping) const;
  void pool(const Sonar& sonar, const Ping& ping);
  [[nodiscard]] std::vector<std::uint8_t> hits(const Sonar& sonar, const EchoDecisions& decisions, int bins) const;
  [[nodiscard]] std::string picture(const Sonar& sonar, const PosedPing& posed);

  DisplayItems& items_;
  std::vector<Sonar> sonars_;
  std::vector<float> beam_, loudest_, pooled_;
  std::vector<std::uint8_t> shades_;
};

}  // namespace isobath

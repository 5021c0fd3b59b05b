// SonarDisplay: pings as pictures for the live page: the samples of each sonar, beam by beam, and the decided echoes.
//
// A sonar is identified by the stance of its fan (horizontal or vertical) and by the fan itself. A scanning head gives
// one beam per ping; its beams are kept by their position in the turn. A fan of more than kMaxBeams beams or kMaxBins
// bins is pooled by maxima, so that no echo becomes invisible. Samples of 8 bits are shown as they are, others in
// decibels below full scale.
//
// Items: sonar and echoes (docs/live-page.md). Times are those of the pings; each fan is shown at most kMaxPerSecond
// times per second.
// Cost: 0.35 ms for 512 beams x 500 bins (DisplayOfAFan).
#pragma once

#include <isobath/display/display_state.hpp>
#include <isobath/world/result_sinks.hpp>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class SonarDisplay {
 public:
  static constexpr int kMaxBeams = 256, kMaxBins = 320;
  static constexpr int kMaxPerSecond = 10;

  explicit SonarDisplay(DisplayState& items) : items_(items) {}
  void on_ping(const PosedPing& posed);

 private:
  struct Sonar {
    bool scanning = false, vertical = false;
    std::shared_ptr<const BeamFan> fan;  ///< fan of the last described ping
    RangeWindow window;
    int slots = 0;  ///< beams in a turn of a scanning head; 0: not known yet
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

  DisplayState& items_;
  std::vector<Sonar> sonars_;
  std::vector<float> beam_, loudest_, pooled_;
  std::vector<std::uint8_t> shades_;
};

}  // namespace isobath

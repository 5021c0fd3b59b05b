// The echoes of one column of cells (all elevations of one azimuth) in the bins of a sonar: surfaces by echo_paths.hpp,
// and the volume of open water in front of them. Internal to the sources of the simulated echoes.
#pragma once

#include <isobath/sim/echo_paths.hpp>
#include <isobath/sonar/echo_truth.hpp>
#include <vector>

namespace isobath {

/// Echoes of one direction, before the receive patterns; arrays by bin, with kLoopPad more than bins.
struct EchoColumn {
  std::vector<float> power, strongest;
  std::vector<EchoLabel> labels;
  float loudest = 0;           ///< after the gain of the receiver
  std::vector<double> volume;  ///< differences along the bins of the (gain x solid angle) of open water

  explicit EchoColumn(int bins);
};

/// Adds an echo to the bins that it spans. Its power is what one bin would hold if all of the echo were in it.
void deposit_echo(const EchoPaths& paths, const PathEcho& echo, float* power, float* strongest, EchoLabel* labels);

/// Receives all echoes of the cells of a direction. `back_from`: two-way attenuation of each bin; `by_bin`: gain of the
/// receiver.
void fill_column(const EchoPaths& paths, int direction, const std::vector<double>& back_from,
                 const std::vector<float>& by_bin, EchoColumn& column);

}  // namespace isobath

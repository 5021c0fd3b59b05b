// ReportConfig: the replay of the run that the report embeds (EmbeddedReplay).
#pragma once

#include <isobath/base/config.hpp>

namespace isobath {

struct ReportConfig {
  bool replay = true;      ///< embed the replay
  double replay_s = 0.5;   ///< between two moments of the replay
  double replay_mb = 7.5;  ///< maximum size of the replay in the report
};
std::vector<Field> fields(ReportConfig& config);

}  // namespace isobath

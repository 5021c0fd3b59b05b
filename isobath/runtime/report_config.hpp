// What the report of a run carries beside what is written in it (RunFilm).
#pragma once

#include <isobath/base/config.hpp>

namespace isobath {

struct ReportConfig {
  bool film = true;      ///< the run itself, to be looked at again
  double film_s = 0.5;   ///< between two moments of it
  double film_mb = 7.5;  ///< of the report's bytes that it may take
};
std::vector<Field> fields(ReportConfig& config);

}  // namespace isobath

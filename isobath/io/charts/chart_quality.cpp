#include <isobath/io/charts/chart_quality.hpp>

namespace isobath {

const char* datum_of_code(int code) {
  static constexpr std::array kNames = {"",
                                        "MLWS",
                                        "MLLWS",
                                        "MSL",
                                        "LLW",
                                        "MLW",
                                        "LLWS",
                                        "approximate MLWS",
                                        "ISLW",
                                        "LWS",
                                        "approximate LAT",
                                        "nearly lowest low water",
                                        "MLLW",
                                        "LW",
                                        "approximate MLW",
                                        "approximate MLLW",
                                        "MHW",
                                        "MHWS",
                                        "HW",
                                        "approximate MSL",
                                        "HWS",
                                        "MHHW",
                                        "ESLW",
                                        "LAT",
                                        "",
                                        "IGLD 1985",
                                        "MWL",
                                        "LLWLT",
                                        "HHWLT",
                                        "NHHW",
                                        "HAT"};
  return code >= 0 && code < static_cast<int>(kNames.size()) ? kNames[static_cast<std::size_t>(code)] : "";
}

const ConfidenceZone& zone_of_scale(double scale) {
  return kConfidenceZones[scale <= 25000 ? 2 : scale <= 100000 ? 3 : 4];
}

}  // namespace isobath

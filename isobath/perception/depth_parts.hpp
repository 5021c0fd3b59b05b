// DepthMapperParts: what the depth mapper is configured with, part by part; and what it says of a pixel that it
// changed.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/map/depth_map.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <isobath/perception/sounding_gate.hpp>
#include <isobath/sonar/reading_prefilter.hpp>
#include <vector>

namespace isobath {

struct DepthMapperConfig {
  bool prefilter = true;     ///< alike readings of a sensor become one of more weight (S1-68)
  bool quarantine = true;    ///< depths that nothing supports are held back
  bool honest = true;        ///< steps fall with range and doubt of place (S1-73)
  bool explain = true;       ///< an echo that the map predicts affirms it and denies nothing (S1-66)
  double spread_sigmas = 1;  ///< a sounding speaks of its footprint widened by so many sigmas of the vehicle's place
  bool queue_all = true;     ///< during a shift; false: only readings that changed something are kept (S1-33)
  bool background = false;   ///< windows shift beside the readings, in a thread of their own
};
std::vector<Field> fields(DepthMapperConfig& config);

struct DepthMapperParts {
  DepthMapperConfig mapper;
  DepthRules rules;
  ReadingEvidenceConfig evidence;
  ReadingPrefilterConfig prefilter;
  SoundingGateConfig gate;
};

/// One change of a pixel, for audits (S1-02): replayed on a copy of the starting map it gives the final one.
struct PixelChange {
  Pixel pixel;
  DepthPixel before, after;
};

}  // namespace isobath

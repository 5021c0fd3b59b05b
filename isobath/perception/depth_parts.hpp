// DepthMapperParts: the configuration of the depth mapper's parts; and PixelChange, its record of a changed pixel.
#pragma once

#include <isobath/base/config.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <isobath/perception/sounding_gate.hpp>
#include <isobath/sonar/reading_prefilter.hpp>
#include <vector>

namespace isobath {

struct DepthMapperConfig {
  bool prefilter = true;         ///< similar readings of a sensor merge into one of more weight (S1-68)
  bool quarantine = true;        ///< depths without support are held back
  bool range_weighting = true;   ///< steps fall with range and position uncertainty (S1-73)
  bool affirm_predicted = true;  ///< an echo that the map predicts affirms it and contradicts nothing (S1-66)
  double spread_sigmas = 1;      ///< widening of a sounding's footprint, in sigmas of the vehicle's position
  bool queue_all = true;         ///< during a shift; false: only readings that changed something are queued (S1-33)
  bool background = false;       ///< windows shift in a thread of their own
};
std::vector<Field> fields(DepthMapperConfig& config);

struct DepthMapperParts {
  DepthMapperConfig mapper;
  DepthRules rules;
  ReadingEvidenceConfig evidence;
  ReadingPrefilterConfig prefilter;
  SoundingGateConfig gate;
};

/// One change of a pixel, for audits (S1-02). All changes, replayed on a copy of the starting map, give the final map.
struct PixelChange {
  Pixel pixel;
  DepthPixel before, after;
};

}  // namespace isobath

#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/depth_rules.hpp>

namespace isobath {

std::vector<Field> fields(DepthRules& c) {
  return {
      Field::integer("base_prior", &c.base_prior, {1, kFullConfidence}, "5 %", "Confidence of a charted depth."),
      Field::integer("base_sensor", &c.base_sensor, {1, kFullConfidence}, "5 %",
                     "Confidence of a depth that a sensor has just put in place of another."),
      Field::integer("threshold", &c.threshold, {1, kFullConfidence}, "5 %",
                     "A depth is replaced when its confidence falls below this."),
      Field::flag("refine", &c.refine, "Agreeing soundings move the depth by their share; false: as published."),
      Field::flag("tighten", &c.tighten,
                  "A higher bound of a forward sonar replaces a lower one at once; false: as published."),
  };
}

void DepthRules::check() const {
  const auto refuse = [](const std::string& what, const std::string& allowed) { throw Error(what, {}, allowed); };
  if (!(threshold <= base_prior && base_prior < base_sensor && base_sensor <= kFullConfidence && threshold > 0)) {
    refuse(fmt::format("confidence constants do not fit together: threshold {}, base_prior {}, base_sensor {}",
                       threshold, base_prior, base_sensor),
           fmt::format("0 < threshold <= base_prior < base_sensor <= {}", kFullConfidence));
  }
}

}  // namespace isobath

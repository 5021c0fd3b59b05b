#include <isobath/base/error.hpp>
#include <isobath/perception/sensor_reliability.hpp>

namespace isobath {

void SensorReliability::count(std::size_t sensor, Agreement agreement) {
  ISOBATH_ASSERT(sensor < counts_.size());
  ReliabilityCounts& c = counts_[sensor];
  switch (agreement) {
    case Agreement::kConfirming: ++c.confirming; break;
    case Agreement::kConflicting: ++c.conflicting; break;
    case Agreement::kIrrelevant: ++c.irrelevant; break;
  }
}

}  // namespace isobath

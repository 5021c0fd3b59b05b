#include <isobath/vehicle/health.hpp>

namespace isobath {

const char* to_text(HealthState state) {
  switch (state) {
    case HealthState::kOk: return "ok";
    case HealthState::kDegraded: return "degraded";
    case HealthState::kLost: return "lost";
  }
  return "";
}

}  // namespace isobath

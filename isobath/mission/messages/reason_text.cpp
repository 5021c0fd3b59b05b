#include <cmath>
#include <fmt/format.h>
#include <isobath/mission/messages/reason_text.hpp>

namespace isobath {

std::string text_of(const Hazard& hazard) {
  const bool numbered = hazard.obstacle > 0;
  switch (hazard.kind) {
    case HazardKind::kSeen: return numbered ? fmt::format("obstacle {}", hazard.obstacle) : "an obstacle";
    case HazardKind::kRemembered:
      return numbered ? fmt::format("remembered obstacle {}", hazard.obstacle) : "a remembered obstacle";
    case HazardKind::kCharted: return "a charted obstacle";
    case HazardKind::kMapped: return "an obstacle of the depth map";
    case HazardKind::kVoxels: return "an obstacle of the voxel map";
    case HazardKind::kFence: return "the fence";
    case HazardKind::kInjected: return "an injected obstacle";
    case HazardKind::kMoving:
      return numbered ? fmt::format("moving obstacle {}", hazard.obstacle) : "a moving obstacle";
    case HazardKind::kVehicle: return "a vehicle of the group that waits";
    case HazardKind::kBlocked: return "a passage that counts as blocked";
  }
  return "";
}

std::string direction_of(const Eigen::Vector2d& place, const Eigen::Vector2d& vehicle, Angle heading) {
  const Eigen::Vector2d away = place - vehicle;
  const double metres = away.norm();
  if (metres < 0.05) return "at the vehicle";
  const double bearing = (Angle::radians(std::atan2(away.y(), away.x())) - heading).wrapped().degrees();
  const double off_bow = std::abs(bearing);
  const char* along = off_bow <= 75 ? "ahead" : off_bow < 105 ? "abeam" : "astern";
  const char* side = off_bow <= 10 || off_bow >= 170 ? "" : bearing < 0 ? " to port" : " to starboard";
  return fmt::format("{:.{}f} m {}{}", metres, metres < 9.95 ? 1 : 0, along, side);
}

std::string text_of(const Eigen::Vector2d& north_east) {
  return fmt::format("north {:.1f}, east {:.1f} m", north_east.x(), north_east.y());
}

std::string name_of(const MissionPoint& point, std::size_t index) {
  return point.name.empty() ? fmt::format("point {}", index + 1) : point.name;
}

}  // namespace isobath

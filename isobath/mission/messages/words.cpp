#include <fmt/format.h>
#include <isobath/mission/messages/words.hpp>

namespace isobath {

const char* text_of(HazardKind kind) {
  switch (kind) {
    case HazardKind::kSeen: return "an obstacle";
    case HazardKind::kRemembered: return "a remembered obstacle";
    case HazardKind::kCharted: return "a charted obstacle";
    case HazardKind::kFence: return "the fence";
    case HazardKind::kInjected: return "an injected obstacle";
  }
  return "";
}

std::string text_of(const Eigen::Vector2d& north_east) {
  return fmt::format("north {:.1f}, east {:.1f} m", north_east.x(), north_east.y());
}

std::string name_of(const MissionPoint& point, std::size_t index) {
  return point.name.empty() ? fmt::format("point {}", index + 1) : point.name;
}

}  // namespace isobath

#include <isobath/run/mission_notes.hpp>

namespace isobath {
namespace {

constexpr Duration kBelievedInterval = std::chrono::milliseconds(95);  // ten a second, with some jitter allowed

}  // namespace

void MissionNotes::on_fix(const Navigation& fix) {
  if (!fix.X_WB.is_finite()) return;
  if (!believed_.empty() && fix.time - believed_.back().time < kBelievedInterval) return;
  believed_.push_back({fix.time, fix.X_WB.translation.head<2>(), fix.X_WB.translation.z()});
}

void MissionNotes::on_scan(const ScanResult& scan) {
  for (const Obstacle& o : scan.detection.obstacles) {
    if (o.behind) continue;
    seen_.push_back({scan.detection.time, world_outline(o, scan.detection.X_WB), o.existence});
  }
}

void MissionNotes::on_message(const Envelope& envelope) {
  const auto* said = std::get_if<ChartedHazards>(&envelope.message);
  if (!said || !said->hazards) return;
  const std::lock_guard lock(mutex_);
  if (!first_hazards_) first_hazards_ = said->hazards;
  last_hazards_ = said->hazards;
}

std::vector<Hazard> MissionNotes::hazards_of(const Hazards& hazards, HazardKind kind) const {
  const std::lock_guard lock(mutex_);
  std::vector<Hazard> found;
  if (!hazards) return found;
  for (const Hazard& hazard : *hazards) {
    if (hazard.kind == kind) found.push_back(hazard);
  }
  return found;
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <isobath/io/open_source.hpp>
#include <isobath/io/survey_folder.hpp>
#include <isobath/run/moving_fan.hpp>
#include <limits>

namespace isobath {

MovingFan::MovingFan(const ObstacleMemoryConfig& memory, PoseTimeline reference) : memory_(memory) {
  if (!reference.empty()) drift_.emplace(std::move(reference));
}

/// The agents take the deviation of the position from the same place (AgentsHelm).
void MovingFan::on_fix(const Navigation& fix) {
  if (const auto sigma_m = sigma_m_of(fix)) sigma_m_ = sigma_m;
}

void MovingFan::on_ping(const PosedPing& ping) { detections_.add(ping); }

void MovingFan::on_soundings(const Swath& swath, const Pose& X_WB) { detections_.add(swath, X_WB); }

void MovingFan::on_scan(const ScanResult& scan) {
  if (!scan.posed) return;
  const Detection& found = scan.detection;
  const Pose X_WL = level(found.X_WB);
  here_ = X_WL.translation.head<2>();
  heading_ = X_WL.rotation.heading();
  track_.push_back(here_);
  MemorySweep sweep{.time = found.time, .X_WL = X_WL, .sigma_m = {}, .obstacles = found.obstacles, .water = {}};
  if (sigma_m_ && *sigma_m_ > 0) sweep.sigma_m = sigma_m_;
  sweep.water = {found.cells, found.position, found.heading, found.free};
  if (!memory_.add(sweep)) return;
  for (std::size_t i = 0; i < found.obstacles.size(); ++i) {
    const std::uint32_t id = memory_.seen_as()[i];
    if (id == 0) continue;
    const auto [at, is_new] = last_echo_.try_emplace(id, found.obstacles[i].last_hit);
    at->second = std::max(at->second, found.obstacles[i].last_hit);
  }
  if (drift_) drift_->add(found.time, X_WL, known());
}

std::vector<RememberedObstacle> MovingFan::remembered() const {
  return memory_.known(here_, std::numeric_limits<double>::infinity());
}

std::vector<KnownObstacle> MovingFan::known() const {
  std::vector<KnownObstacle> known;
  for (const RememberedObstacle& o : remembered()) {
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : o.outline_W) box.extend(corner);
    const auto echo = last_echo_.find(o.id);
    known.push_back({box.center(), o.margin_m, echo == last_echo_.end() ? o.last_seen : echo->second});
  }
  return known;
}

void MovingFan::add_to(RunOutcome& outcome) {
  outcome.sharpness = detections_.sharpness();
  if (!drift_) return;
  outcome.drift = drift_->outcome(known());
  if (!outcome.drift || !outcome.sharpness) return;
  by_reference_ = detections_.placed_by([this](Time time) { return drift_->reference().at(time); });
  const auto sharpness = by_reference_->sharpness();
  outcome.drift->cells = outcome.sharpness->cells;
  outcome.drift->reference_cells = sharpness ? sharpness->cells : 0;
}

PlacementView MovingFan::view(const RunOutcome& outcome) const {
  PlacementView view;
  view.cells = (by_reference_ ? *by_reference_ : detections_).filled_cells();
  view.remembered = remembered();
  view.track = track_;
  view.heading = heading_;
  if (outcome.drift) view.reference = outcome.drift->reference;
  view.origin = outcome.source.origin;
  return view;
}

PoseTimeline reference_of(const std::filesystem::path& input, const InputConfig& config,
                          const std::optional<GeoOrigin>& frame) {
  const auto source = open_reference(input, config);
  if (!source) return {};
  std::vector<Navigation> fixes;
  while (const auto event = source->next()) {
    if (const auto* const fix = std::get_if<Navigation>(&*event)) fixes.push_back(*fix);
  }
  const auto& origin = source->report().origin;
  if (origin && frame) {
    const LocalPlane from(*origin), to(*frame);
    for (Navigation& fix : fixes) fix = in_plane(fix, from, to);
  }
  return PoseTimeline(fixes);
}

}  // namespace isobath

#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/world/placed_detections.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

constexpr int kMaxOffset_deg = 30;
constexpr std::size_t kMinDetections = 200;
constexpr double kMinTravel_m = 5;
constexpr double kFarthestPlace = 1e8;  // m: the index of a cell fits into 32 bits

/// A set of cells that is emptied at no cost.
class CellSet {
 public:
  explicit CellSet(std::size_t most) : slots_(std::bit_ceil(2 * most + 2)) {}
  void clear() {
    ++round_;
    size_ = 0;
  }
  void insert(const Vector2i& cell) {
    const std::uint64_t key = PlacedDetections::key_of(cell);
    std::size_t at = ((key * 0x9E3779B97F4A7C15U) >> 32) & (slots_.size() - 1);
    while (slots_[at].round == round_) {
      if (slots_[at].key == key) return;
      at = (at + 1) & (slots_.size() - 1);
    }
    slots_[at] = {key, round_};
    ++size_;
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t round = 0;
  };
  std::vector<Slot> slots_;
  std::uint32_t round_ = 1;
  std::size_t size_ = 0;
};

/// Where a point of a scan lies; `side` -1: with port and starboard exchanged.
struct PlanTurn {
  PlanTurn(const Vector2d& place, Angle heading, double side = 1)
      : from(place), ahead(cos(heading), sin(heading)), right(-side * ahead.y(), side * ahead.x()) {}
  [[nodiscard]] Vector2d operator()(const Eigen::Vector2f& p) const {
    return from + double(p.x()) * ahead + double(p.y()) * right;
  }
  Vector2d from, ahead, right;
};

}  // namespace

bool Sharpness::tells() const {
  if (curve.size() < 3) return false;
  const std::size_t ends = std::min(curve.front().cells, curve.back().cells);
  return best != curve.front().offset && best != curve.back().offset && 10 * ends > 11 * best_cells;
}

/// Whether the next scan is kept.
bool PlacedDetections::wanted() { return offered_++ % every_ == 0; }

void PlacedDetections::begin_scan(Time time, const Pose& X_WB) {
  scans_.push_back({time, X_WB.translation.head<2>(), X_WB.rotation.heading(), {}});
}

void PlacedDetections::add_point(const Eigen::Vector3d& p_B, const Pose& X_WB) {
  const Eigen::Vector3d p_L = level(X_WB).rotation.inverse() * (X_WB.rotation * p_B);
  if (p_L.head<2>().norm() < kFarthestPlace) scans_.back().points.emplace_back(p_L.head<2>().cast<float>());
}

/// Drops a scan without detections, and every second scan when there are too many detections.
void PlacedDetections::end_scan() {
  if (scans_.back().points.empty()) return scans_.pop_back();
  detections_ += scans_.back().points.size();
  if (detections_ <= kMax) return;
  every_ *= 2;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scans_.size(); i += 2) std::swap(scans_[kept++], scans_[i]);
  scans_.resize(kept);
  detections_ = 0;
  for (const Scan& scan : scans_) detections_ += scan.points.size();
}

void PlacedDetections::add(const Swath& swath, const Pose& X_WB) {
  if (!swath.is_flat() || swath.frame != Swath::Frame::kBody || X_WB.translation.norm() > kFarthestPlace) return;
  if (!wanted()) return;
  begin_scan(swath.time, X_WB);
  for (const Sounding& s : swath.soundings) {
    if (s.kind == Sounding::Kind::kWater) add_point(s.point.cast<double>(), X_WB);
  }
  end_scan();
}

void PlacedDetections::add(const PosedPing& posed) {
  const Ping& ping = posed.look_ping();
  const EchoDecisions& decisions = posed.look_decisions();
  if (ping.fan->beams() < 2 || posed.X_WB.translation.norm() > kFarthestPlace || !wanted()) return;
  begin_scan(ping.time, posed.X_WB);
  for (int beam = 0; beam < decisions.beams(); ++beam) {
    const std::uint64_t* const hits = decisions.hits(beam);
    for (int w = 0; w < decisions.words(); ++w) {
      const std::uint64_t echoes = hits[w] & decisions.usable()[w];
      if (echoes == 0) continue;
      const double range = ping.window.centre(64 * w + std::countr_zero(echoes));
      const Angle azimuth = ping.fan->azimuth[static_cast<std::size_t>(beam)];
      add_point(ping.X_BS * Eigen::Vector3d(range * cos(azimuth), range * sin(azimuth), 0), posed.X_WB);
      break;
    }
  }
  end_scan();
}

PlacedDetections PlacedDetections::placed_by(const std::function<std::optional<Pose>(Time)>& pose_at) const {
  PlacedDetections other;
  for (const Scan& scan : scans_) {
    const auto pose = pose_at(scan.time);
    if (!pose || pose->translation.norm() > kFarthestPlace) continue;
    other.scans_.push_back({scan.time, pose->translation.head<2>(), pose->rotation.heading(), scan.points});
    other.detections_ += scan.points.size();
  }
  return other;
}

bool PlacedDetections::travelled() const {
  Eigen::AlignedBox2d box;
  for (const Scan& scan : scans_) box.extend(scan.place);
  return !box.isEmpty() && box.diagonal().norm() >= kMinTravel_m;
}

std::optional<Sharpness> PlacedDetections::sharpness() const {
  if (detections_ < kMinDetections || !travelled()) return std::nullopt;
  CellSet cells(detections_);
  const auto count = [&](Angle offset, double side = 1) {
    cells.clear();
    for (const Scan& scan : scans_) {
      const PlanTurn placed(scan.place, scan.heading + offset, side);
      for (const Eigen::Vector2f& p : scan.points) cells.insert(cell_of(placed(p)));
    }
    return cells.size();
  };
  Sharpness sharpness;
  sharpness.cell_m = kCell_m;
  sharpness.detections = detections_;
  sharpness.scans = scans_.size();
  for (int degrees = -kMaxOffset_deg; degrees <= kMaxOffset_deg; ++degrees) {
    sharpness.curve.push_back({Angle::degrees(degrees), count(Angle::degrees(degrees))});
  }
  sharpness.cells = sharpness.curve[kMaxOffset_deg].cells;
  sharpness.mirrored = count({}, -1);
  const auto best = std::ranges::min_element(sharpness.curve, {}, &SharpnessPoint::cells);
  sharpness.best = best->offset;
  sharpness.best_cells = best->cells;
  const auto near = [&](const SharpnessPoint& point) { return 100 * point.cells <= 101 * best->cells; };
  auto low = best, high = best;
  while (low != sharpness.curve.begin() && near(*(low - 1))) --low;
  while (high + 1 != sharpness.curve.end() && near(*(high + 1))) ++high;
  sharpness.low = low->offset;
  sharpness.high = high->offset;
  return sharpness;
}

std::vector<PlacedDetections::FilledCell> PlacedDetections::filled_cells() const {
  const auto less = [](const Vector2i& a, const Vector2i& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); };
  std::vector<Vector2i> all, of_scan;
  for (const Scan& scan : scans_) {
    const PlanTurn placed(scan.place, scan.heading);
    of_scan.clear();
    for (const Eigen::Vector2f& p : scan.points) of_scan.push_back(cell_of(placed(p)));
    std::ranges::sort(of_scan, less);
    of_scan.erase(std::unique(of_scan.begin(), of_scan.end()), of_scan.end());
    all.insert(all.end(), of_scan.begin(), of_scan.end());
  }
  std::ranges::sort(all, less);
  std::vector<FilledCell> filled;
  for (const Vector2i& index : all) {
    if (filled.empty() || filled.back().index != index) filled.push_back({index, 0});
    ++filled.back().scans;
  }
  return filled;
}

}  // namespace isobath

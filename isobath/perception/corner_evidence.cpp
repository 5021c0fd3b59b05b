#include <algorithm>
#include <cmath>
#include <Eigen/LU>
#include <isobath/perception/corner_evidence.hpp>

namespace isobath {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The angle that an edge spans as seen from p; 0 from behind.
Angle width_from(const PlaneLine& edge, const Vector2d& p) {
  if (edge.height_of(p) <= 0) return {};
  return abs((plan_bearing(edge.at(edge.end_m) - p) - plan_bearing(edge.at(edge.begin_m) - p)).wrapped());
}

/// Whether the beams towards a point end before it or pass it.
enum class BeamsTo : std::uint8_t { kEndBefore, kPass, kUndecided };
BeamsTo beams_to(const PlaneScan& scan, const Vector2d& p, double margin_m) {
  const double distance = (p - scan.from).norm();
  const Angle bearing = plan_bearing(p - scan.from);
  int before = 0, behind = 0;
  for (const PlaneEcho& echo : scan.echoes) {
    if (abs((echo.bearing - bearing).wrapped()) > scan.beam_width.full) continue;
    before += echo.range_m < distance - margin_m ? 1 : 0;
    behind += echo.range_m > distance + margin_m ? 1 : 0;
  }
  if (before == behind) return BeamsTo::kUndecided;
  return before > behind ? BeamsTo::kEndBefore : BeamsTo::kPass;
}

}  // namespace

PlaneCorner fused(const PlaneCorner& a, const PlaneCorner& b) {
  const Matrix2d gain = a.covariance * (a.covariance + b.covariance).inverse();
  PlaneCorner both = a;
  both.at += gain * (b.at - a.at);
  both.covariance = (Matrix2d::Identity() - gain) * a.covariance;
  return both;
}

bool CornerEvidence::agree(const PlaneLine& edge, const PlaneLine& line) const {
  const double turned = std::acos(std::clamp(edge.normal.dot(line.normal), -1.0, 1.0));
  const double turn_variance = edge.bearing_variance() + line.bearing_variance() + std::pow(config_.floor.radians(), 2);
  if (turned * turned > config_.gate * config_.gate * turn_variance) return false;
  // compares them where they overlap or come nearest, so that neither is extrapolated far
  const double begin = edge.along_of(line.at(line.begin_m)), end = edge.along_of(line.at(line.end_m));
  const double low = std::min(begin, end), high = std::max(begin, end);
  if (low > edge.end_m + config_.gap_m || high < edge.begin_m - config_.gap_m) return false;
  const double at = 0.5 * (std::clamp(low, edge.begin_m, edge.end_m) + std::clamp(high, edge.begin_m, edge.end_m));
  const double on_line = line.along_of(edge.at(at)), apart = line.height_of(edge.at(at));
  const double variance = edge.variance_at(at) + line.variance_at(on_line) + config_.floor_m * config_.floor_m;
  return apart * apart <= config_.gate * config_.gate * variance;
}

std::size_t CornerEvidence::edge_of(const PlaneLine& line) {
  std::size_t best = edges_.size();
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (!agree(edges_[i].line, line)) continue;
    if (best == edges_.size() || edges_[i].line.support > edges_[best].line.support) best = i;
  }
  if (best == edges_.size()) {
    edges_.push_back({line, scans_, scans_, 1});
    return best;
  }
  SeenEdge& edge = edges_[best];
  edge.line = merged(edge.line, line);
  if (edge.last_scan != scans_) ++edge.scans;
  edge.last_scan = scans_;
  return best;
}

void CornerEvidence::hypothesise(const ScanCorner& seen, std::size_t first, std::size_t second) {
  for (SeenCorner& known : corners_) {
    const bool same = known.first == first && known.second == second;
    const bool swapped = known.first == second && known.second == first;
    if (!same && !swapped) continue;
    known.corner = fused(known.corner, seen);
    return;
  }
  corners_.push_back({static_cast<const PlaneCorner&>(seen), first, second, scans_, 0, 0, 0});
}

void CornerEvidence::weigh(const PlaneScan& scan, SeenCorner& corner) const {
  if (!corner.corner.convex || corner.hypothesised == scans_) return;
  const bool first = edges_[corner.first].last_scan == scans_, second = edges_[corner.second].last_scan == scans_;
  if (first == second) return;
  const PlaneLine& gone = edges_[first ? corner.second : corner.first].line;
  const Angle width = width_from(gone, scan.from);
  const Vector2d middle = gone.at(0.5 * (gone.begin_m + gone.end_m));
  const double margin = config_.gate * scan.range_sigma((middle - scan.from).norm());
  const BeamsTo beams = beams_to(scan, middle, margin);
  if (width <= scan.beam_width.full && beams == BeamsTo::kEndBefore) ++corner.scans_for;
  if (width >= config_.facing && beams == BeamsTo::kPass) ++corner.scans_against;
  const bool enough = corner.scans_for >= config_.enough && corner.scans_for > corner.scans_against;
  if (enough && corner.confirmed == 0) corner.confirmed = scans_;
}

void CornerEvidence::add(const PlaneScan& scan, const ScanShapes& shapes) {
  ++scans_;
  std::vector<std::size_t> edge(shapes.shapes.size(), 0);
  for (std::size_t i = 0; i < shapes.shapes.size(); ++i) {
    if (const PlaneLine* line = shapes.shapes[i].line()) edge[i] = edge_of(*line);
  }
  for (const ScanCorner& seen : shapes.corners) hypothesise(seen, edge[seen.first], edge[seen.second]);
  for (SeenCorner& corner : corners_) weigh(scan, corner);
}

}  // namespace isobath

// CornerEvidence: edges merged over scans from several positions, and the corners between them, confirmed by the edges
// that become visible or hidden as the vehicle passes (Auran, Silven 1995, 3.2 and figure 3; ledger S4-42, S4-D02).
//
// A line of a new scan joins the edge that it matches in direction, position and extent; their moments merge. Two lines
// of a scan that meet form a corner hypothesis. A later scan that detects only one of its edges is evidence:
//   for      the other edge cannot be visible from here if the corner is real: the vehicle is behind its line, or so
//            near to the line that the edge is narrower than a beam; and the beams towards it end at a nearer echo.
//   against  the other edge faces the vehicle and is wide enough to be detected, and the beams towards it pass through.
// A corner is confirmed by at least `enough` scans for it, if they outnumber the scans against it. A concave corner, of
// a room, hides nothing and is never confirmed, but its position is known as well. Positions are fused over scans by
// their covariances.
//
// Plan coordinates (north, east) of W, m. Positions of the scans are taken as exact. One thread.
#pragma once

#include <isobath/perception/scan_shapes.hpp>
#include <vector>

namespace isobath {

struct CornerEvidenceConfig {
  double gate = 3;                    ///< standard deviations within which angles and positions match
  double floor_m = 0.15;              ///< minimum standard deviation of a position
  Angle floor = Angle::degrees(2);    ///< minimum standard deviation of a direction
  double gap_m = 2;                   ///< maximum gap between parts of one edge
  int enough = 1;                     ///< scans that confirm a corner
  Angle facing = Angle::degrees(10);  ///< angular width from which an edge should be detected
};

struct SeenEdge {
  PlaneLine line;
  int first_scan = 0, last_scan = 0, scans = 0;
};
struct SeenCorner {
  PlaneCorner corner;
  std::size_t first = 0, second = 0;  ///< edges
  int hypothesised = 0;               ///< number of the first scan
  int confirmed = 0;                  ///< number of the confirming scan; 0: not confirmed
  int scans_for = 0, scans_against = 0;
};

class CornerEvidence {
 public:
  explicit CornerEvidence(const CornerEvidenceConfig& config = {}) : config_(config) {}

  /// Adds the next scan and its shapes. Scans are numbered from 1.
  void add(const PlaneScan& scan, const ScanShapes& shapes);
  [[nodiscard]] int scans() const { return scans_; }
  [[nodiscard]] const std::vector<SeenEdge>& edges() const { return edges_; }
  [[nodiscard]] const std::vector<SeenCorner>& corners() const { return corners_; }

 private:
  std::size_t edge_of(const PlaneLine& line);
  [[nodiscard]] bool agree(const PlaneLine& edge, const PlaneLine& line) const;
  void hypothesise(const ScanCorner& seen, std::size_t first, std::size_t second);
  void weigh(const PlaneScan& scan, SeenCorner& corner) const;

  CornerEvidenceConfig config_;
  int scans_ = 0;
  std::vector<SeenEdge> edges_;
  std::vector<SeenCorner> corners_;
};

/// Fuses two independent estimates of one corner.
PlaneCorner fused(const PlaneCorner& a, const PlaneCorner& b);

}  // namespace isobath

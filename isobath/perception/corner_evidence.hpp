// CornerEvidence: edges over the places that they were heard from, and the corners between them, confirmed by what
// appears and what vanishes on the way round (Auran, Silven 1995, 3.2 and figure 3; ledger S4-42, S4-D02).
//
// Lines of a new scan join the edge that they agree with in direction, in place and in extent; their moments merge.
// Where two lines of a scan meet there is a hypothesis of a corner. From then on, each scan that hears one of its edges
// and not the other says something of it:
//   for      the other edge cannot be heard from here if the corner is one: the vehicle stands behind its line, or so
//            near to it that it is no wider than a beam; and beams that way end before it, on what hides it.
//   against  the other edge faces the vehicle, wide enough to be heard, and beams that way went through it.
// A corner is confirmed by `enough` scans for it, more than are against it. A hollow corner, of a room, hides nothing
// and is never confirmed; its place is known as well. Places are fused over scans by their covariances.
//
// Plan coordinates (north, east) of W, m: places of the scans are taken to be right. One thread.
#pragma once

#include <isobath/perception/scan_shapes.hpp>
#include <vector>

namespace isobath {

struct CornerEvidenceConfig {
  double gate = 3;                    ///< standard deviations, of angles and places that are the same
  double floor_m = 0.15;              ///< that a place is never better known than
  Angle floor = Angle::degrees(2);    ///< nor a direction
  double gap_m = 2;                   ///< between parts of one edge
  int enough = 1;                     ///< scans
  Angle facing = Angle::degrees(10);  ///< what is so wide and not heard is missed
};

struct SeenEdge {
  PlaneLine line;
  int first_scan = 0, last_scan = 0, scans = 0;
};
struct SeenCorner {
  PlaneCorner corner;
  std::size_t first = 0, second = 0;  ///< edges
  int hypothesised = 0;               ///< number of the scan
  int confirmed = 0;                  ///< 0: not yet
  int scans_for = 0, scans_against = 0;
};

class CornerEvidence {
 public:
  explicit CornerEvidence(const CornerEvidenceConfig& config = {}) : config_(config) {}

  /// The next scan, and what it was told as. Scans are numbered from 1.
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

/// Of one place told twice, independently.
PlaneCorner fused(const PlaneCorner& a, const PlaneCorner& b);

}  // namespace isobath

// DynamicDelaunay: the Delaunay triangulation of labelled points in the plane, which takes insertion, deletion and
// movement of points without being rebuilt (Rodin, Amin c. 1988, 2.1; ledger S3-06, S3-31).
//
// Insertion: locate the triangle by walking, split it, flip edges until all are legal (Lawson 1977). Deletion: the hole
// is triangulated again, each side with the corner whose circle is empty. Movement: an interior point that stays inside
// the polygon of its neighbours keeps its triangles, whose edges are flipped where needed; any other is taken out and
// inserted again. All decisions are by exact predicates, so that grids, rows and points nearly in a row give a valid
// triangulation. Triangles with a corner at infinity cover the outside of the hull: each side has two triangles. Points
// on one line have no triangles. Points that coincide exactly share one corner, that of the point inserted there first;
// `twin` lists the others. Of four corners on one circle, either diagonal may be an edge.
//
// Units are the caller's (m in this project). Cost among 1e4 random points, one core of 2.0 GHz: 1.6 us an
// insertion, 2.9 us a deletion with an insertion, 0.8 us a small movement. With more than 256 points a sample of one in
// 32, triangulated in the same way, says where a walk starts (Devillers 2002), so that a random insertion takes near
// O(log n): measured exponent 0.18 from 1e3 to 6.4e4 points. Deletion takes O(k^2) for k neighbours.
// Memory: about 130 bytes a point for the maximum number of points, from the start; nothing is allocated later.
// Errors: Error for a point that is not finite or beyond 1e9, and for a point too many. Ids must be of live points.
// Threads: one at a time, because `around` and `nearest` share a list.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace isobath {

class DynamicDelaunay {
 public:
  static constexpr int kNone = -1;  ///< no point; as a corner: infinity
  struct Triangle {
    std::array<int, 3> corner;     ///< points, in the positive sense from x to y
    std::array<int, 3> neighbour;  ///< the triangle across the side that faces corner k
  };

  /// Where insertions fall: anywhere, or each near the one before, which needs no sample of the points.
  enum class Order : std::uint8_t { kAny, kNear };

  explicit DynamicDelaunay(int max_points, Order order = Order::kAny);

  /// Returns the id of the point: the least id that is free if none was ever removed, else one that became free.
  int insert(const Eigen::Vector2d& at, int label);
  void remove(int point);
  void move(int point, const Eigen::Vector2d& to);

  [[nodiscard]] int size() const { return live_; }
  [[nodiscard]] const Eigen::Vector2d& at(int point) const { return points_[index(point)].at; }
  [[nodiscard]] int label(int point) const { return points_[index(point)].label; }
  /// The next point that coincides with this corner or twin; kNone after the last.
  [[nodiscard]] int twin(int point) const { return points_[index(point)].twin; }
  /// All triangles by number, among them unused ones and those with a corner at infinity; see is_finite.
  [[nodiscard]] std::span<const Triangle> triangles() const { return triangles_; }
  [[nodiscard]] static bool is_finite(const Triangle& t) {
    return t.corner[0] >= 0 && t.corner[1] >= 0 && t.corner[2] >= 0;
  }
  /// The corner nearest to p, which must be finite; kNone while there are no triangles.
  [[nodiscard]] int nearest(const Eigen::Vector2d& p) const;
  /// The numbers of the triangles around a corner, those with a corner at infinity included, in the positive sense.
  /// Empty for a twin and while all points lie on one line. The list is valid until the next call.
  [[nodiscard]] std::span<const int> around(int point) const;
  /// The numbers of the triangles that the last insertion, removal or movement changed; some may be unused by now.
  [[nodiscard]] std::span<const int> changed() const { return changed_; }

 private:
  friend class KineticDelaunay;
  static constexpr int kUnused = -2;  // first corner of a triangle that is not in use
  struct Point {
    Eigen::Vector2d at{0, 0};
    int label = 0;
    int corner = kNone;    ///< the point whose corner it shares: itself, or the first one there
    int twin = kNone;      ///< the next one there
    int triangle = kNone;  ///< one of its triangles
    int coarse = kNone;    ///< its id in the sample
    bool live = false;
  };
  struct Rim {  ///< a side of a hole: from a corner to that of the next one
    int corner;
    int outside;  ///< the triangle beyond, and which of its neighbours the hole is
    int slot;
  };
  struct Gap {  ///< a part of a hole that is not filled yet: rims first to last, closed by a side of triangle outside
    int first, last;
    int outside, slot;
  };

  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  Triangle& tri(int t) { return triangles_[index(t)]; }
  [[nodiscard]] const Triangle& tri(int t) const { return triangles_[index(t)]; }
  [[nodiscard]] static bool is_ghost(const Triangle& t) {
    return t.corner[0] == kNone || t.corner[1] == kNone || t.corner[2] == kNone;
  }
  static int next_slot(int k) { return k == 2 ? 0 : k + 1; }
  static int previous_slot(int k) { return k == 0 ? 2 : k - 1; }
  /// The order along a line.
  static bool precedes(const Eigen::Vector2d& a, const Eigen::Vector2d& b);
  /// Whether p is beyond the side from a to b of the hull, on its left, or strictly within the side.
  static bool is_outside(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p);
  void place(int point);
  void join(int corner, int point);
  void take_out(int point);
  void leave_twins(int point);
  bool shift(int point, const Eigen::Vector2d& to);
  bool place_all(std::span<const Eigen::Vector2d> at);
  void rebuild();

  void place_in_row(int point);
  void raise(int point);
  void drop_to_row();
  void split(int t, int point);
  void dig(int point);
  void fill();
  [[nodiscard]] int apex(const Gap& gap) const;
  bool flip(int t, int k);
  void legalize();
  [[nodiscard]] bool in_conflict(const Triangle& t, const Eigen::Vector2d& p) const;
  [[nodiscard]] int walk(const Eigen::Vector2d& p, int start) const;
  [[nodiscard]] int start_for(const Eigen::Vector2d& p) const;
  int new_triangle();
  void set(int t, const std::array<int, 3>& corner, const std::array<int, 3>& neighbour);
  void link(int t, int slot, int other, int other_slot);
  [[nodiscard]] int slot_of(int t, int neighbour) const;

  int max_points_;
  int live_ = 0;
  int corners_ = 0;  ///< live points that are no twins
  std::vector<Point> points_;
  std::vector<int> free_points_;
  std::vector<Triangle> triangles_;  ///< empty while all points lie on one line
  std::vector<int> free_triangles_;
  std::vector<int> row_;  ///< corners in order along the line, while there are no triangles
  int last_ = 0;          ///< where a walk may start
  std::vector<int> changed_;
  std::vector<std::pair<int, int>> edges_;  ///< triangle and side, to be checked
  std::vector<Rim> rim_;
  std::vector<Gap> gaps_;
  mutable std::vector<int> around_;
  std::unique_ptr<DynamicDelaunay> coarse_;  ///< a sample of the points; their labels are ids here
};

}  // namespace isobath

// Removal of points from a DynamicDelaunay: the hole that a corner leaves is filled from its rim.
#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/geometry/dynamic_delaunay.hpp>
#include <isobath/geometry/exact_predicates.hpp>

namespace isobath {

void DynamicDelaunay::take_out(int point) {
  Point& p = points_[index(point)];
  if (p.corner != point || p.twin != kNone) {
    leave_twins(point);
    return;
  }
  --corners_;
  if (triangles_.empty()) {
    row_.erase(std::find(row_.begin(), row_.end(), point));
    return;
  }
  dig(point);
  p.triangle = kNone;
  if (static_cast<int>(rim_.size()) >= corners_) {  // all other corners are around the point: do they lie on one line?
    row_.clear();
    for (const Rim& r : rim_) {
      if (r.corner != kNone) row_.push_back(r.corner);
    }
    const auto on_line = [&](int c) { return orientation(at(row_[0]), at(row_[1]), at(c)) == 0; };
    if (static_cast<int>(row_.size()) == corners_ && std::all_of(row_.begin(), row_.end(), on_line)) {
      drop_to_row();
      return;
    }
    row_.clear();
  }
  fill();
}

void DynamicDelaunay::drop_to_row() {
  triangles_.clear();
  free_triangles_.clear();
  std::sort(row_.begin(), row_.end(), [&](int a, int b) { return precedes(at(a), at(b)); });
}

/// Unlinks a point that shares its corner with others. If it is the first, the next one becomes the corner.
void DynamicDelaunay::leave_twins(int point) {
  Point& p = points_[index(point)];
  if (p.corner != point) {
    int before = p.corner;
    while (points_[index(before)].twin != point) before = points_[index(before)].twin;
    points_[index(before)].twin = p.twin;
  } else {
    const int heir = p.twin;
    for (const int t : around(point)) {
      for (int& corner : tri(t).corner) corner = corner == point ? heir : corner;
      changed_.push_back(t);
    }
    std::replace(row_.begin(), row_.end(), point, heir);
    points_[index(heir)].triangle = p.triangle;
    for (int q = heir; q != kNone; q = points_[index(q)].twin) points_[index(q)].corner = heir;
  }
  p.corner = point;
  p.twin = p.triangle = kNone;
}

/// Takes the triangles around a corner away and lists the rim of the hole in the positive sense. Its last side, from
/// the last corner to the first, has no corner at infinity.
void DynamicDelaunay::dig(int point) {
  rim_.clear();
  std::size_t start = 0;
  for (const int t : around(point)) {
    const Triangle& here = tri(t);
    const int k = here.corner[0] == point ? 0 : here.corner[1] == point ? 1 : 2;
    const int a = here.corner[next_slot(k)], b = here.corner[previous_slot(k)];
    rim_.push_back({a, here.neighbour[k], slot_of(here.neighbour[k], t)});
    if (a != kNone && b != kNone) start = rim_.size();
  }
  std::rotate(rim_.begin(), rim_.begin() + static_cast<std::ptrdiff_t>(start % rim_.size()), rim_.end());
  for (const int t : around_) {
    changed_.push_back(t);
    tri(t).corner = {kUnused, kUnused, kUnused};
    free_triangles_.push_back(t);
  }
}

/// The corner of a gap whose circle through the closing side is empty.
int DynamicDelaunay::apex(const Gap& gap) const {
  const int p = rim_[index(gap.last)].corner, q = rim_[index(gap.first)].corner;
  int best = kNone;
  for (int i = gap.first + 1; i < gap.last; ++i) {
    const int s = rim_[index(i)].corner;
    if (best == kNone) {
      const bool usable = s == kNone || p == kNone || q == kNone || orientation(at(p), at(q), at(s)) > 0;
      if (usable) best = i;
      continue;
    }
    if (s == kNone) continue;  // infinity is the last choice
    const int b = rim_[index(best)].corner;
    bool better = false;
    if (p == kNone) {
      better = is_outside(at(q), at(b), at(s));
    } else if (q == kNone) {
      better = is_outside(at(b), at(p), at(s));
    } else if (orientation(at(p), at(q), at(s)) > 0) {
      better = b == kNone || in_circle(at(p), at(q), at(b), at(s)) > 0;
    }
    if (better) best = i;
  }
  ISOBATH_ASSERT(best != kNone);
  return best;
}

void DynamicDelaunay::fill() {
  const int last = static_cast<int>(rim_.size()) - 1;
  gaps_.assign(1, {0, last, rim_.back().outside, rim_.back().slot});
  while (!gaps_.empty()) {
    const Gap gap = gaps_.back();
    gaps_.pop_back();
    const int m = apex(gap);
    const Rim &i = rim_[index(gap.first)], &j = rim_[index(gap.last)], &top = rim_[index(m)];
    const int t = new_triangle();
    set(t, {j.corner, i.corner, top.corner}, {kNone, kNone, kNone});
    link(t, 2, gap.outside, gap.slot);
    if (m == gap.first + 1) {
      link(t, 0, i.outside, i.slot);
    } else {
      gaps_.push_back({gap.first, m, t, 0});
    }
    if (m == gap.last - 1) {
      link(t, 1, top.outside, top.slot);
    } else {
      gaps_.push_back({m, gap.last, t, 1});
    }
    last_ = t;
  }
}

}  // namespace isobath

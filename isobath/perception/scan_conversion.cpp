#include <algorithm>
#include <isobath/base/error.hpp>
#include <isobath/perception/scan_conversion.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kLargest = 1 << 30;

// Floor without std::floor, which is a function call in a build for any processor.
std::int32_t cell_below(double coordinate) {
  const double c = std::clamp(coordinate, -kLargest, kLargest);
  const auto truncated = static_cast<std::int32_t>(c);
  return truncated - static_cast<std::int32_t>(truncated > c);
}
/// Index of the first pixel whose centre is at or beyond the coordinate.
std::int32_t first_centre(double coordinate) {
  const double c = std::clamp(coordinate, -kLargest, kLargest) - 0.5;
  const auto truncated = static_cast<std::int32_t>(c);
  return truncated + static_cast<std::int32_t>(truncated < c);
}

/// A side from its upper to its lower corner, so that neighbouring polygons use the same numbers in the same order.
struct Side {
  Vector2d upper;
  Vector2d lower;

  Side(const Vector2d& a, const Vector2d& b) : upper(a), lower(b) {
    if (b.y() < a.y() || (b.y() == a.y() && b.x() < a.x())) std::swap(upper, lower);
  }
  /// If the products are exact there is a single rounding, so that no tie is missed.
  [[nodiscard]] double x_at(double y) const {
    const double height = lower.y() - upper.y();
    return (upper.x() * (lower.y() - y) + lower.x() * (y - upper.y())) / height;
  }
};

double lowest_row_coordinate(std::span<const Vector2d> convex) {
  double y = convex.front().y();
  for (const Vector2d& p : convex) y = std::max(y, p.y());
  return y;
}
double highest_row_coordinate(std::span<const Vector2d> convex) {
  double y = convex.front().y();
  for (const Vector2d& p : convex) y = std::min(y, p.y());
  return y;
}

/// Starts rows begin .. end of the window, each with an empty span to be widened.
void start_rows(std::int64_t begin, std::int64_t end, const PixelWindow& clip, std::vector<PixelSpan>& out) {
  begin = std::max<std::int64_t>(begin, clip.row);
  end = std::min<std::int64_t>(end, std::int64_t{clip.row} + clip.height);
  for (std::int64_t row = begin; row < end; ++row) {
    out.push_back({static_cast<std::int32_t>(row), std::int32_t{1} << 30, -(std::int32_t{1} << 30)});
  }
}

void clip_columns(const PixelWindow& clip, std::vector<PixelSpan>& out) {
  const auto last = static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{clip.column} + clip.width, 1 << 30));
  for (PixelSpan& s : out) {
    s.column_begin = std::max(s.column_begin, clip.column);
    s.column_end = std::min(s.column_end, last);
  }
  out.erase(std::remove_if(out.begin(), out.end(), [](const PixelSpan& s) { return s.column_begin >= s.column_end; }),
            out.end());
}

}  // namespace

void pixels_inside(std::span<const Vector2d> convex, const PixelWindow& clip, std::vector<PixelSpan>& out) {
  out.clear();
  if (convex.size() < 3) return;
  start_rows(first_centre(highest_row_coordinate(convex)), first_centre(lowest_row_coordinate(convex)), clip, out);
  if (out.empty()) return;
  const std::int32_t first = out.front().row;
  const std::int32_t last = out.back().row;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Side side(convex[i], convex[(i + 1) % convex.size()]);
    const std::int32_t begin = std::max(first_centre(side.upper.y()), first);
    const std::int32_t end = std::min(first_centre(side.lower.y()), last + 1);
    for (std::int32_t row = begin; row < end; ++row) {
      const std::int32_t column = first_centre(side.x_at(row + 0.5));
      PixelSpan& s = out[row - first];
      s.column_begin = std::min(s.column_begin, column);
      s.column_end = std::max(s.column_end, column);
    }
  }
  clip_columns(clip, out);
}

void pixels_touched(std::span<const Vector2d> convex, const PixelWindow& clip, std::vector<PixelSpan>& out) {
  out.clear();
  if (convex.empty()) return;
  start_rows(cell_below(highest_row_coordinate(convex)), std::int64_t{cell_below(lowest_row_coordinate(convex))} + 1,
             clip, out);
  if (out.empty()) return;
  const std::int32_t first = out.front().row;
  const std::int32_t last = out.back().row;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Side side(convex[i], convex[(i + 1) % convex.size()]);
    const std::int32_t begin = std::max(cell_below(side.upper.y()), first);
    const std::int32_t end = std::min(cell_below(side.lower.y()), last) + 1;
    const double low_x = std::min(side.upper.x(), side.lower.x());
    const double high_x = std::max(side.upper.x(), side.lower.x());
    for (std::int32_t row = begin; row < end; ++row) {
      // A side that ends in this row ends at its corner.
      const double enter = side.upper.y() >= row ? side.upper.x() : std::clamp(side.x_at(row), low_x, high_x);
      const double leave =
          side.lower.y() <= row + 1.0 ? side.lower.x() : std::clamp(side.x_at(row + 1.0), low_x, high_x);
      PixelSpan& s = out[row - first];
      s.column_begin = std::min(s.column_begin, cell_below(std::min(enter, leave)));
      s.column_end = std::max(s.column_end, cell_below(std::max(enter, leave)) + 1);
    }
  }
  clip_columns(clip, out);
}

std::array<Vector2d, 4> thick_segment(const Vector2d& from, const Vector2d& to, double half_width) {
  const Vector2d along = to - from;
  const double length = along.norm();
  const Vector2d unit = length > 0 ? Vector2d(along / length) : Vector2d(1, 0);
  const Vector2d across = half_width * Vector2d(-unit.y(), unit.x());
  return {from + across, to + across, to - across, from - across};
}

}  // namespace isobath

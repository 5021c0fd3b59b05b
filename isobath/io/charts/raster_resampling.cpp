#include <algorithm>
#include <isobath/io/charts/raster_resampling.hpp>

namespace isobath {
namespace {

RasterSpot spot_at(const RasterPiece& piece, int c, int r) {
  const auto sigma = static_cast<double>(piece.sigma[piece.at(c, r)]);
  return {static_cast<double>(piece.value[piece.at(c, r)]), sigma * sigma};
}

}  // namespace

RasterSpot spot_of_area(const RasterPiece& piece, const Eigen::Vector2d& cell, const Eigen::Vector2d& half, Merge merge,
                        int sign) {
  double count = 0, sum = 0, squares = 0, variance = 0, known = 0;
  RasterSpot shoalest;
  const int c0 = static_cast<int>(std::ceil(cell.x() - half.x() - 0.5)),
            c1 = static_cast<int>(std::floor(cell.x() + half.x() - 0.5));
  const int r0 = static_cast<int>(std::ceil(cell.y() - half.y() - 0.5)),
            r1 = static_cast<int>(std::floor(cell.y() + half.y() - 0.5));
  double base = NAN;
  for (int r = r0; r <= r1; ++r) {
    for (int c = c0; c <= c1; ++c) {
      if (!piece.holds(c, r)) continue;
      const RasterSpot s = spot_at(piece, c, r);
      if (count == 0) base = s.depth;
      ++count;
      sum += s.depth - base;
      squares += (s.depth - base) * (s.depth - base);
      if (std::isfinite(s.variance)) {
        variance += s.variance;
        ++known;
      }
      if (std::isnan(shoalest.depth) || sign * s.depth < sign * shoalest.depth) shoalest = s;
    }
  }
  if (count == 0 || merge == Merge::kShoalest) return shoalest;
  const double mean = sum / count, spread = std::max(0.0, squares / count - mean * mean);
  return {base + mean, (known > 0 ? variance / known : NAN) + spread};
}

RasterSpot spot_between(const RasterPiece& piece, const Eigen::Vector2d& cell, Merge merge, int sign) {
  const int c = static_cast<int>(std::floor(cell.x() - 0.5)), r = static_cast<int>(std::floor(cell.y() - 0.5));
  const double right = cell.x() - 0.5 - c, down = cell.y() - 0.5 - r;
  const int c_own = static_cast<int>(std::floor(cell.x())), r_own = static_cast<int>(std::floor(cell.y()));
  if (!piece.holds(c_own, r_own)) return {};
  RasterSpot mixed{0, 0}, shoalest = spot_at(piece, c_own, r_own);
  for (int k = 0; k < 4; ++k) {
    const int dc = k & 1, dr = k >> 1;
    const double weight = (dc ? right : 1 - right) * (dr ? down : 1 - down);
    if (weight <= 0) continue;
    if (!piece.holds(c + dc, r + dr)) {
      if (merge == Merge::kMean) return spot_at(piece, c_own, r_own);
      continue;
    }
    const RasterSpot s = spot_at(piece, c + dc, r + dr);
    mixed.depth += weight * s.depth;
    mixed.variance += weight * s.variance;
    if (sign * s.depth < sign * shoalest.depth) shoalest = s;
  }
  return merge == Merge::kShoalest ? shoalest : mixed;
}

}  // namespace isobath

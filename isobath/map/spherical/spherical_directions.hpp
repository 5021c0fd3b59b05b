// Directions of a spherical grid: buckets of equal angles, and the two tables that find the contents of a bucket
// (Auran, Silven 1995, 4.2; ledger S4-02, S4-03, S4-07, S4-09, S4-10, S4-21, S4-E02).
//
// Grid axes x', y', z' (up): x' = r cos eps cos alpha, y' = r cos eps sin alpha, z' = r sin eps; azimuth alpha in
// (-pi, pi] first, elevation eps second. Bucket 0 of azimuth begins at -pi, bucket 0 of elevation at -pi / 2.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/angle.hpp>
#include <limits>
#include <optional>
#include <vector>

namespace isobath {

struct SphericalDirection {
  int azimuth = 0, elevation = 0;
  auto operator<=>(const SphericalDirection&) const = default;  ///< the order of beams: elevation within azimuth
};

/// Converts between angles and buckets. Immutable. `at` calls no trigonometric inverse: it compares pseudo-angles with
/// those of the edges, which a table locates to within one or two buckets.
class DirectionBuckets {
 public:
  /// Throws Error if half a turn is not a multiple of the step, or the step is not within 0.25 and 30 degrees.
  explicit DirectionBuckets(Angle step);

  [[nodiscard]] Angle step() const { return step_; }
  [[nodiscard]] int azimuths() const { return azimuths_; }
  [[nodiscard]] int elevations() const { return azimuths_ / 2; }
  [[nodiscard]] int count() const { return azimuths() * elevations(); }
  /// The bucket of a point in grid axes at any distance but 0.
  [[nodiscard]] SphericalDirection at(const Eigen::Vector3d& p) const {
    return at(p.x(), p.y(), p.z(), std::sqrt(p.x() * p.x() + p.y() * p.y()));
  }
  /// The same; `level` is the length of (x, y).
  [[nodiscard]] SphericalDirection at(double x, double y, double z, double level) const {
    const double span = std::abs(x) + std::abs(y) + std::numeric_limits<double>::min();
    const double share = x / span, turn = y <= 0 ? 1 + share : 3 - share;
    return {azimuth_.find(turn), elevation_.find(1 + z / (level + std::abs(z)))};
  }
  /// Lower edge of a bucket; one past the last bucket gives the end.
  [[nodiscard]] Angle azimuth_edge(int bucket) const { return step_ * bucket - Angle::degrees(180); }
  [[nodiscard]] Angle elevation_edge(int bucket) const { return step_ * bucket - Angle::degrees(90); }
  /// Unit vector of the middle of a bucket.
  [[nodiscard]] Eigen::Vector3d middle(const SphericalDirection& d) const {
    const double level = cos_elevation_[static_cast<std::size_t>(d.elevation)];
    return {level * cos_azimuth_[static_cast<std::size_t>(d.azimuth)],
            level * sin_azimuth_[static_cast<std::size_t>(d.azimuth)],
            sin_elevation_[static_cast<std::size_t>(d.elevation)]};
  }
  [[nodiscard]] double cos_elevation(int bucket) const { return cos_elevation_[static_cast<std::size_t>(bucket)]; }
  /// Distance from a point of a bucket to the nearer side in azimuth (two planes) or in elevation (two cones).
  [[nodiscard]] double to_azimuth_edge(int bucket, double x, double y) const {
    const auto i = static_cast<std::size_t>(bucket);
    return std::min(y * azimuth_sides_[i].x() - x * azimuth_sides_[i].y(),
                    x * azimuth_sides_[i + 1].y() - y * azimuth_sides_[i + 1].x());
  }
  [[nodiscard]] double to_elevation_edge(int bucket, double level, double z) const {
    const auto i = static_cast<std::size_t>(bucket);
    return std::min(z * elevation_sides_[i].x() - level * elevation_sides_[i].y(),
                    level * elevation_sides_[i + 1].y() - z * elevation_sides_[i + 1].x());
  }
  /// Solid angle of a bucket, d_alpha (sin eps2 - sin eps1), sr.
  [[nodiscard]] double solid_angle(int elevation) const;

 private:
  /// Pseudo-angles of the bucket edges in azimuth or in elevation.
  struct Scale {
    std::vector<double> edges;  ///< the last one is infinite
    std::vector<std::uint16_t> first;
    double steps = 0;  ///< of `first` a unit: so fine that a step holds at most one edge, and one more by rounding
    void index(double top);
    [[nodiscard]] int find(double at) const {
      std::size_t i = first[static_cast<std::size_t>(at * steps)];
      i += at >= edges[i + 1] ? 1 : 0;  // branch-free, because the branches would be unpredictable
      i += at >= edges[i + 1] ? 1 : 0;
      return static_cast<int>(i);
    }
  };
  Angle step_;
  int azimuths_;
  Scale azimuth_, elevation_;
  std::vector<Eigen::Vector2d> azimuth_sides_, elevation_sides_;  ///< cosine and sine of each edge
  std::vector<double> cos_azimuth_, sin_azimuth_, cos_elevation_, sin_elevation_;
};

/// Maps directions to ids: a table of azimuths, and a table of elevations for each azimuth in use. Nothing is linked:
/// each table has a bit for every entry, so that a walk goes from one used entry to the next without reading empty
/// entries. A turn about the polar axis by whole buckets changes one number.
class DirectionTable {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  DirectionTable(int azimuths, int elevations);

  [[nodiscard]] std::uint32_t find(const SphericalDirection& d) const {
    const std::int32_t second = first_[place(d.azimuth)];
    return second < 0 ? kNone : ids_[entry(second, d.elevation)];
  }
  /// `id` must not be kNone.
  void set(const SphericalDirection& d, std::uint32_t id);
  void erase(const SphericalDirection& d);
  void clear();

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int second_tables() const { return static_cast<int>(used_.size() - free_.size()); }
  [[nodiscard]] std::size_t bytes() const;

  [[nodiscard]] std::optional<SphericalDirection> first() const;
  [[nodiscard]] std::optional<SphericalDirection> after(const SphericalDirection& d) const;

  /// Moves the contents of azimuth k to azimuth k + buckets.
  void turn(int buckets) { shift_ = wrap(shift_ + buckets); }
  /// Buckets turned since construction, in [0, azimuths).
  [[nodiscard]] int turned() const { return shift_; }

 private:
  [[nodiscard]] int wrap(int azimuth) const { return (azimuth % azimuths_ + azimuths_) % azimuths_; }
  [[nodiscard]] std::size_t place(int azimuth) const {
    const int p = azimuth - shift_;
    return static_cast<std::size_t>(p < 0 ? p + azimuths_ : p);
  }
  [[nodiscard]] int azimuth_of(int place) const {
    return place + shift_ < azimuths_ ? place + shift_ : place + shift_ - azimuths_;
  }
  [[nodiscard]] std::size_t entry(std::int32_t second, int elevation) const {
    return static_cast<std::size_t>(second) * static_cast<std::size_t>(elevations_) +
           static_cast<std::size_t>(elevation);
  }
  [[nodiscard]] const std::uint64_t* bits_of(std::int32_t second) const {
    return bits_.data() + static_cast<std::size_t>(second) * words_;
  }
  [[nodiscard]] int next_azimuth(int from) const;
  [[nodiscard]] std::optional<SphericalDirection> first_of(int azimuth) const;

  int azimuths_, elevations_;
  std::size_t words_;  ///< 64-bit words per second table
  int shift_ = 0, size_ = 0;
  std::vector<std::int32_t> first_;        ///< second table of each azimuth, -1: none
  std::vector<std::uint64_t> first_bits_;  ///< azimuths in use
  std::vector<std::uint32_t> ids_;         ///< of all second tables
  std::vector<std::uint64_t> bits_;        ///< of all second tables: elevations in use
  std::vector<std::uint16_t> used_;        ///< number of entries of each second table
  std::vector<std::int32_t> free_;         ///< second tables that no azimuth uses
};

}  // namespace isobath

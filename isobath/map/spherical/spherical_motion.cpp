// Re-binning of SphericalGrid's cells after a motion: every content moves, is split where it is wider than its new
// cell, and merges with contents that it meets there (S4-23, S4-24).
#include <algorithm>
#include <cmath>
#include <isobath/map/spherical/spherical_grid.hpp>
#include <limits>

namespace isobath {
namespace {

// A content is split where it is wider than its cell and one of its halves, a quarter of its length to either side of
// its middle, lies in another cell. So no cell between two contents that touch stays empty: each extends less than half
// a cell into it. The limit is less than the width, because merged contents are not boxes.
constexpr float kWider = 0.8f * 0.8f;
// Cells narrow towards the poles; contents are not split finer than cells at this cosine of the elevation.
constexpr float kMinCosine = 0.26f;
constexpr int kMaxRounds = 6;  // of halving one content in one motion

/// Converts l to Lambda = -ln(1 - P), the expected number of objects in a cell, and back.
double number_of(double log_odds) { return log_odds > 30 ? log_odds : std::log1p(std::exp(log_odds)); }
double log_odds_of_number(double number) { return number > 30 ? number : std::log(std::expm1(number)); }

}  // namespace

// Free of branches: they would be unpredictable, and the processor could not work on several contents at once.
SphericalGrid::Fit SphericalGrid::fit(const SphericalCell& content) const {
  const float x = content.mean[0], y = content.mean[1], z = content.mean[2];
  const std::array<float, 6>& c = content.spread;
  const float level2 = x * x + y * y + std::numeric_limits<float>::min(), range2 = level2 + z * z;
  const float level = std::sqrt(level2), range = std::sqrt(range2);
  const bool beyond = static_cast<double>(range) > config_.range_m;
  const int layer = layers_.layer_at(static_cast<double>(beyond ? 0 : range));
  const SphericalDirection d =
      buckets_.at(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z), static_cast<double>(level));
  const float along = x * (c[0] * x + 2 * (c[1] * y + c[2] * z)) + y * (c[3] * y + 2 * c[4] * z) + c[5] * z * z;
  const float round = c[0] * y * y - 2 * c[1] * x * y + c[3] * x * x;
  const float in_range = along / range2, in_azimuth = round / level2;
  const float in_elevation = std::max(0.0f, c[0] + c[3] + c[5] - in_range - in_azimuth);
  // a uniform content of length L has the variance L^2 / 12
  const float step = static_cast<float>(config_.bucket.radians()), unit = kWider / 12;
  const float high = unit * step * step * range2;
  const float nearest_edge =
      std::min(range - static_cast<float>(layers_.inner(layer)), static_cast<float>(layers_.outer(layer)) - range);
  const auto side =
      static_cast<float>(buckets_.to_azimuth_edge(d.azimuth, static_cast<double>(x), static_cast<double>(y)));
  const auto slope =
      static_cast<float>(buckets_.to_elevation_edge(d.elevation, static_cast<double>(level), static_cast<double>(z)));
  constexpr float kToHalf = 4.0f / 3;  // the centres of the halves are sqrt(3/4 variance) from the middle
  const float wide = std::max(unit * step * step * level2, kMinCosine * kMinCosine * high);
  const std::array<float, 3> room{
      std::max(unit * room_of_layer_[static_cast<std::size_t>(layer)], kToHalf * nearest_edge * nearest_edge),
      std::max(wide, kToHalf * side * side), std::max(high, kToHalf * slope * slope)};
  const std::array<float, 3> has{in_range, in_azimuth, in_elevation};
  // which of the three ratios of variance to room is the largest
  const unsigned across = has[1] * room[2] > has[2] * room[1] ? 1 : 2;
  const unsigned widest = static_cast<unsigned>(has[0] * room[across] <= has[across] * room[0]) * across;
  const unsigned fits = static_cast<unsigned>(has[widest] <= room[widest]);
  Fit f;
  f.direction = static_cast<std::uint32_t>(d.azimuth * buckets_.elevations() + d.elevation);
  f.layer = static_cast<std::uint16_t>(layer);
  f.variance = has[widest];
  f.widest = static_cast<Fit::Axis>(widest + fits * (Fit::kFits - widest));
  if (beyond) f.widest = Fit::kBeyond;
  return f;
}

// Splits a content with the variance lambda along the unit vector e. Halves with the means m -+ C e sqrt(3 / (4
// lambda)) and the covariance C - 3/4 C e e^T C / lambda together have its moments; for a uniform content they are its
// two halves.
SphericalCell SphericalGrid::halve(SphericalCell& content, const Fit& f) const {
  const float x = content.mean[0], y = content.mean[1], z = content.mean[2];
  const float level = std::hypot(x, y), range = std::hypot(level, z);
  const float cosine = level / range, sine = z / range;
  const float to_east = level > 0 ? x / level : 1, to_north = level > 0 ? y / level : 0;
  std::array<float, 3> e{x / range, y / range, sine};
  if (f.widest == Fit::kAzimuth) e = {-to_north, to_east, 0};
  if (f.widest == Fit::kElevation) e = {-sine * to_east, -sine * to_north, cosine};
  std::array<float, 6>& c = content.spread;
  const float scale = std::sqrt(0.75f / f.variance);
  const std::array<float, 3> g{scale * (c[0] * e[0] + c[1] * e[1] + c[2] * e[2]),
                               scale * (c[1] * e[0] + c[3] * e[1] + c[4] * e[2]),
                               scale * (c[2] * e[0] + c[4] * e[1] + c[5] * e[2])};
  c = {c[0] - g[0] * g[0], c[1] - g[0] * g[1], c[2] - g[0] * g[2],
       c[3] - g[1] * g[1], c[4] - g[1] * g[2], c[5] - g[2] * g[2]};
  content.weight *= 0.5f;
  if (config_.merging == SphericalGridConfig::Merging::kDensity && !content.locked) {
    const double number = 0.5 * number_of(static_cast<double>(content.log_odds));
    content.log_odds = static_cast<float>(clamped(log_odds_of_number(number)));
  }
  SphericalCell other = content;
  other.echoes = content.echoes / 2;
  content.echoes -= other.echoes;
  for (std::size_t i = 0; i < 3; ++i) {
    content.mean[i] += g[i];
    other.mean[i] -= g[i];
  }
  return other;
}

// Works in rounds: each round checks the halved contents and their halves again.
void SphericalGrid::split_wide() {
  fits_.resize(contents_.size());
  for (std::size_t i = 0; i < contents_.size(); ++i) fits_[i] = fit(contents_[i]);
  halved_.clear();
  for (std::uint32_t i = 0; i < fits_.size(); ++i) {
    if (fits_[i].widest < Fit::kFits) halved_.push_back(i);
  }
  for (int round = 0; round < kMaxRounds && !halved_.empty(); ++round) {
    for (std::size_t k = halved_.size(); k-- > 0;) {
      SphericalCell other = halve(contents_[halved_[k]], fits_[halved_[k]]);
      halved_.push_back(static_cast<std::uint32_t>(contents_.size()));
      contents_.push_back(other);
    }
    fits_.resize(contents_.size());
    for (const std::uint32_t i : halved_) fits_[i] = fit(contents_[i]);
    halved_.erase(
        std::remove_if(halved_.begin(), halved_.end(), [&](std::uint32_t i) { return fits_[i].widest >= Fit::kFits; }),
        halved_.end());
  }
}

// Combines the moments of both, and the state as configured (S4-50).
void SphericalGrid::merge(SphericalCell& into, const SphericalCell& other) const {
  const float weight = into.weight + other.weight, share = other.weight / weight, both = share * (1 - share);
  std::array<float, 3> apart;
  for (std::size_t i = 0; i < 3; ++i) {
    apart[i] = other.mean[i] - into.mean[i];
    into.mean[i] += share * apart[i];
  }
  constexpr std::array<std::size_t, 6> kRow{0, 0, 0, 1, 1, 2}, kColumn{0, 1, 2, 1, 2, 2};
  for (std::size_t i = 0; i < 6; ++i) {
    into.spread[i] += share * (other.spread[i] - into.spread[i]) + both * apart[kRow[i]] * apart[kColumn[i]];
  }
  into.weight = weight;
  const bool density = config_.merging == SphericalGridConfig::Merging::kDensity && !into.locked && !other.locked;
  if (into.locked != other.locked) {
    into.log_odds = into.locked ? into.log_odds : other.log_odds;
  } else if (density) {
    const double number =
        number_of(static_cast<double>(into.log_odds)) + number_of(static_cast<double>(other.log_odds));
    into.log_odds = static_cast<float>(clamped(log_odds_of_number(number)));
  } else {
    into.log_odds = std::max(into.log_odds, other.log_odds);
  }
  if (other.echoes > 0) {
    into.first_echo = into.echoes > 0 ? std::min(into.first_echo, other.first_echo) : other.first_echo;
    into.last_echo = into.echoes > 0 ? std::max(into.last_echo, other.last_echo) : other.last_echo;
    into.scans = std::max(into.scans, other.scans);
    into.last_scan = std::max(into.last_scan, other.last_scan);
  }
  into.echoes += other.echoes;
  into.locked = into.locked || other.locked;
  into.prior = into.prior || other.prior;
}

void SphericalGrid::add_content(const Eigen::Vector3d& p_G, const SphericalCell& other) {
  const Eigen::Vector3d p = to_table(p_G);
  const auto place = place_at(p);
  if (!place) return;
  bool made = false;
  SphericalCell& cell = cells_.at(place->direction, place->layer, made);
  if (made) fill(cell, *place);
  SphericalCell moved = other;
  moved.mean = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
  moved.log_odds = cell.log_odds;
  moved.locked = false;
  merge(cell, moved);
  cells_.mark_occupied(place->direction, place->layer, static_cast<double>(cell.log_odds) >= occupied_);
}

// Sorts by direction (counting sort) and then by layer; contents of one cell merge in the order of their arrival.
void SphericalGrid::gather() {
  starts_.assign(static_cast<std::size_t>(buckets_.count()) + 1, 0);
  for (std::size_t i = 0; i < fits_.size(); ++i) {
    contents_[i].layer = fits_[i].layer;
    if (fits_[i].widest != Fit::kBeyond) {
      ++starts_[fits_[i].direction + 1];
    } else if (dropped_) {
      dropped_(contents_[i], from_table(contents_[i].point()));
    }
  }
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  order_.resize(starts_.back());
  for (std::uint32_t i = 0; i < fits_.size(); ++i) {
    if (fits_[i].widest != Fit::kBeyond) order_[starts_[fits_[i].direction]++] = i;
  }
  cells_.begin_again();
  std::size_t begin = 0;
  while (begin < order_.size()) {
    const std::uint32_t direction = fits_[order_[begin]].direction;
    const std::size_t end = starts_[direction];  // by now the start of the next direction
    for (std::size_t i = begin + 1; i < end; ++i) {
      const std::uint32_t at = order_[i];
      std::size_t k = i;
      for (; k > begin && fits_[order_[k - 1]].layer > fits_[at].layer; --k) order_[k] = order_[k - 1];
      order_[k] = at;
    }
    const int elevations = buckets_.elevations();
    cells_.begin_beam(turned({static_cast<int>(direction) / elevations, static_cast<int>(direction) % elevations}));
    while (begin < end) {
      SphericalCell& cell = contents_[order_[begin]];
      for (++begin; begin < end && fits_[order_[begin]].layer == cell.layer; ++begin) {
        merge(cell, contents_[order_[begin]]);
      }
      cells_.append(cell, static_cast<double>(cell.log_odds) >= occupied_);
    }
  }
}

void SphericalGrid::rebin(const Eigen::Vector3d& t) {
  views_.move(t);
  offset_.setZero();
  const Eigen::Vector3f t_f = t.cast<float>();
  contents_.clear();
  cells_.each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    contents_.insert(contents_.end(), beam.begin(), beam.end());
  });
  for (SphericalCell& content : contents_) {
    for (std::size_t i = 0; i < 3; ++i) content.mean[i] += t_f[static_cast<Eigen::Index>(i)];
  }
  split_wide();
  gather();
}

}  // namespace isobath

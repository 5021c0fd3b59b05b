#include <algorithm>
#include <bit>
#include <isobath/base/error.hpp>
#include <isobath/map/spherical/spherical_directions.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

/// First set bit in [from, end), or -1.
int next_bit(const std::uint64_t* words, int from, int end) {
  while (from < end) {
    const std::uint64_t rest = words[from / 64] >> (from % 64);
    if (rest != 0) {
      const int at = from + std::countr_zero(rest);
      return at < end ? at : -1;
    }
    from = (from / 64 + 1) * 64;
  }
  return -1;
}

}  // namespace

DirectionBuckets::DirectionBuckets(Angle step)
    : step_(step), azimuths_(2 * static_cast<int>(std::lround(std::numbers::pi / step.radians()))) {
  const double off = std::abs(azimuths_ * step.radians() - 2 * std::numbers::pi);
  if (!(step.degrees() >= 0.25 && step.degrees() <= 30) || off > 1e-6) {
    throw Error("half a turn is not a multiple of the bucket width", {{}, {}, {}, {}, "bucket_deg"},
                "0.25 .. 30 degrees, a divisor of 180");
  }
  for (int i = 0; i < azimuths_; ++i) {
    const double a = azimuth_edge(i).radians() + 0.5 * step.radians();
    cos_azimuth_.push_back(std::cos(a));
    sin_azimuth_.push_back(std::sin(a));
  }
  for (int i = 0; i < elevations(); ++i) {
    const double e = elevation_edge(i).radians() + 0.5 * step.radians();
    cos_elevation_.push_back(std::cos(e));
    sin_elevation_.push_back(std::sin(e));
  }
  // The same expressions as in `at`, for points on the edges.
  for (int i = 0; i <= azimuths_; ++i) {
    const double a = 2 * std::numbers::pi * i / azimuths_ - std::numbers::pi, x = std::cos(a), y = std::sin(a);
    const double span = std::abs(x) + std::abs(y);
    azimuth_sides_.emplace_back(x, y);
    azimuth_.edges.push_back(2 * i <= azimuths_ ? 1 + x / span : 3 - x / span);
  }
  azimuth_.edges.front() = 0;
  azimuth_.edges.back() = 4;
  for (int i = 0; i <= elevations(); ++i) {
    const double e = std::numbers::pi * i / elevations() - std::numbers::pi / 2;
    elevation_sides_.emplace_back(std::cos(e), std::sin(e));
    elevation_.edges.push_back(1 + std::sin(e) / (std::abs(std::cos(e)) + std::abs(std::sin(e))));
  }
  elevation_.edges.front() = 0;
  elevation_.edges.back() = 2;
  azimuth_.index(4);
  elevation_.index(2);
}

void DirectionBuckets::Scale::index(double top) {
  steps = 2 * static_cast<double>(edges.size()) / top;
  std::uint16_t bucket = 0;
  for (int k = 0; k <= static_cast<int>(top * steps) + 1; ++k) {
    while (bucket + 2u < edges.size() && k / steps >= edges[bucket + 1u]) ++bucket;
    // one step early, because k / steps and at * steps round independently
    first.push_back(k == 0 ? std::uint16_t{0} : bucket);
  }
  for (std::size_t k = first.size() - 1; k > 0; --k) {
    if (static_cast<double>(k) / steps <= edges[first[k]] * (1 + 1e-12) && first[k] > 0) --first[k];
  }
  edges.back() = std::numeric_limits<double>::infinity();
}

double DirectionBuckets::solid_angle(int elevation) const {
  return step_.radians() * (sin(elevation_edge(elevation + 1)) - sin(elevation_edge(elevation)));
}

DirectionTable::DirectionTable(int azimuths, int elevations)
    : azimuths_(azimuths),
      elevations_(elevations),
      words_((static_cast<std::size_t>(elevations) + 63) / 64),
      first_(static_cast<std::size_t>(azimuths), -1),
      first_bits_((static_cast<std::size_t>(azimuths) + 63) / 64) {}

void DirectionTable::set(const SphericalDirection& d, std::uint32_t id) {
  ISOBATH_ASSERT(id != kNone);
  std::int32_t& second = first_[place(d.azimuth)];
  if (second < 0) {
    if (free_.empty()) {
      free_.push_back(static_cast<std::int32_t>(used_.size()));
      used_.push_back(0);
      ids_.resize(ids_.size() + static_cast<std::size_t>(elevations_), kNone);
      bits_.resize(bits_.size() + words_);
    }
    second = free_.back();
    free_.pop_back();
    first_bits_[place(d.azimuth) / 64] |= std::uint64_t{1} << (place(d.azimuth) % 64);
  }
  std::uint32_t& held = ids_[entry(second, d.elevation)];
  if (held == kNone) {
    ++used_[static_cast<std::size_t>(second)];
    ++size_;
    bits_[static_cast<std::size_t>(second) * words_ + static_cast<std::size_t>(d.elevation) / 64] |=
        std::uint64_t{1} << (d.elevation % 64);
  }
  held = id;
}

void DirectionTable::erase(const SphericalDirection& d) {
  std::int32_t& second = first_[place(d.azimuth)];
  if (second < 0 || ids_[entry(second, d.elevation)] == kNone) return;
  ids_[entry(second, d.elevation)] = kNone;
  bits_[static_cast<std::size_t>(second) * words_ + static_cast<std::size_t>(d.elevation) / 64] &=
      ~(std::uint64_t{1} << (d.elevation % 64));
  --size_;
  if (--used_[static_cast<std::size_t>(second)] > 0) return;
  first_bits_[place(d.azimuth) / 64] &= ~(std::uint64_t{1} << (place(d.azimuth) % 64));
  free_.push_back(second);
  second = -1;
}

void DirectionTable::clear() {
  std::fill(first_.begin(), first_.end(), -1);
  std::fill(first_bits_.begin(), first_bits_.end(), 0);
  std::fill(ids_.begin(), ids_.end(), kNone);
  std::fill(bits_.begin(), bits_.end(), 0);
  std::fill(used_.begin(), used_.end(), std::uint16_t{0});
  free_.clear();
  for (std::size_t i = used_.size(); i-- > 0;) free_.push_back(static_cast<std::int32_t>(i));
  size_ = 0;
}

std::size_t DirectionTable::bytes() const {
  return first_.size() * sizeof(first_[0]) + first_bits_.size() * sizeof(first_bits_[0]) +
         ids_.size() * sizeof(ids_[0]) + bits_.size() * sizeof(bits_[0]) + used_.size() * sizeof(used_[0]);
}

// Azimuths in order are places shift_ .. end, then 0 .. shift_: place p has azimuth p + shift_, wrapped.
int DirectionTable::next_azimuth(int from) const {
  if (from >= azimuths_) return -1;
  const int start = static_cast<int>(place(from)), turn = azimuths_ - shift_;  // azimuth 0 is at place `turn`
  if (start >= turn) {
    const int at = next_bit(first_bits_.data(), start, azimuths_);
    if (at >= 0) return azimuth_of(at);
    const int low = next_bit(first_bits_.data(), 0, turn);
    return low < 0 ? -1 : azimuth_of(low);
  }
  const int at = next_bit(first_bits_.data(), start, turn);
  return at < 0 ? -1 : azimuth_of(at);
}

std::optional<SphericalDirection> DirectionTable::first_of(int azimuth) const {
  if (azimuth < 0) return {};
  return SphericalDirection{azimuth, next_bit(bits_of(first_[place(azimuth)]), 0, elevations_)};
}

std::optional<SphericalDirection> DirectionTable::first() const { return first_of(next_azimuth(0)); }

std::optional<SphericalDirection> DirectionTable::after(const SphericalDirection& d) const {
  if (const std::int32_t second = first_[place(d.azimuth)]; second >= 0) {
    const int elevation = next_bit(bits_of(second), d.elevation + 1, elevations_);
    if (elevation >= 0) return SphericalDirection{d.azimuth, elevation};
  }
  return first_of(next_azimuth(d.azimuth + 1));
}

}  // namespace isobath

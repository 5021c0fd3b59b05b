#include <algorithm>
#include <cmath>
#include <isobath/base/split_work.hpp>
#include <isobath/sim/fan_fluctuations.hpp>
#include <isobath/sim/fan_loops.hpp>
#include <isobath/sim/gamma_quantiles.hpp>
#include <isobath/sim/random_at.hpp>
#include <numbers>

namespace isobath {
namespace {

using std::numbers::pi;

constexpr int kMaxTaps = 64;          // on each side of a beam, or over a pulse
constexpr double kMainLobe = 0.06;    // amplitude below which the pattern is truncated: side lobes are left out
constexpr double kMinTap = 0.01;      // smallest tap kept, as a share of the largest
constexpr double kTextureStep = 0.5;  // m: spacing of the ranges at which the texture is evaluated
constexpr int kTextureNodes = 40;     // largest number from the sonar to its range
constexpr double kWaveSpeed = 0.046;  // rms vertical speed of the surface, as a share of the wind speed

float energy_of(const std::vector<float>& taps) {
  float energy = 0;
  for (const float tap : taps) energy += tap * tap;
  return energy;
}

void to_unit_energy(std::vector<float>& taps) {
  const float scale = 1 / std::sqrt(energy_of(taps));
  for (float& tap : taps) tap *= scale;
}

/// Amplitude pattern of a beam.
double amplitude(const BeamPattern& pattern, double off_axis) { return std::sqrt(pattern.gain(off_axis)); }

/// R(d): correlation of two beams at this angle.
double overlap(const BeamPattern& pattern, double width, double angle) {
  const double step = width / 64, reach = 3 * width;
  double both = 0, one = 0;
  for (double t = -reach; t <= reach; t += step) {
    both += amplitude(pattern, t) * amplitude(pattern, t + angle);
    one += amplitude(pattern, t) * amplitude(pattern, t);
  }
  return both / one;
}

/// Symmetric filter over beams whose output correlates as the beams overlap. Beams spaced by at most half their width
/// sample the pattern well enough to serve as taps; otherwise the filter's spectrum is the square root of that of R.
std::vector<float> taps_across(const BeamPattern& pattern, double width, double spacing) {
  if (spacing <= 0 || spacing > 3 * width) return {1};
  std::vector<double> half{1};
  double least = kMainLobe;
  if (spacing <= width / 2) {
    for (int j = 1; j <= kMaxTaps; ++j) half.push_back(amplitude(pattern, j * spacing));
  } else {
    constexpr int kAngles = 64;
    least = kMinTap;
    std::vector<double> correlation(kAngles);
    for (int k = 0; k < kAngles; ++k) correlation[static_cast<std::size_t>(k)] = overlap(pattern, width, k * spacing);
    half.assign(kMaxTaps / 4, 0);
    for (int m = 0; m < 2 * kAngles; ++m) {
      const double at = pi * m / kAngles;
      double spectrum = correlation[0];
      for (int k = 1; k < kAngles; ++k) spectrum += 2 * correlation[static_cast<std::size_t>(k)] * std::cos(at * k);
      for (std::size_t j = 0; j < half.size(); ++j) {
        half[j] += std::sqrt(std::max(spectrum, 0.0)) * std::cos(at * static_cast<double>(j));
      }
    }
  }
  while (half.size() > 1 && std::abs(half.back()) < least * half.front()) half.pop_back();
  std::vector<float> taps;
  for (std::size_t j = half.size(); j-- > 1;) taps.push_back(static_cast<float>(half[j]));
  for (const double tap : half) taps.push_back(static_cast<float>(tap));
  to_unit_energy(taps);
  return taps;
}

/// A pulse of `length` bins; the last tap is the fractional remainder.
std::vector<float> taps_in_range(double length) {
  std::vector<float> taps{1};
  for (double left = length - 1; left > 1e-6 && taps.size() < kMaxTaps; left -= 1) {
    taps.push_back(static_cast<float>(std::min(left, 1.0)));
  }
  to_unit_energy(taps);
  return taps;
}

std::uint64_t place_of(int north, int east) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(north)) << 32 | static_cast<std::uint32_t>(east);
}

}  // namespace

FanFluctuations::FanFluctuations(const SonarConfig& c, double wind, std::uint64_t seed)
    : beams_(c.beams),
      bins_(c.bins),
      bin_m_(c.range_m / c.bins),
      spacing_(c.beams > 1 ? c.sector.radians() / (c.beams - 1) : 0),
      first_azimuth_(-0.5 * c.sector.radians()),
      still_(c.still),
      noise_seed_(random_at(seed, 1, 0).bits()),
      speckle_seed_(random_at(seed, 2, 0).bits()),
      texture_seed_(random_at(seed, 3, 0).bits()) {
  const BeamPattern pattern(c.pattern, c.width, c.side_lobe_db);
  const double wavelength = c.sound_speed / c.frequency;
  forgets_m_ = 0.5 * wavelength / c.width.radians();
  surface_forgets_s_ = wavelength / (4 * pi * kWaveSpeed * std::max(wind, 0.1));
  beam_taps_ = taps_across(pattern, c.width.radians(), spacing_);
  range_taps_ = taps_in_range(std::max(1.0, c.resolution_m / bin_m_));
  rows_ = beams_ + static_cast<int>(beam_taps_.size()) - 1;
  columns_ = bins_ + static_cast<int>(range_taps_.size()) - 1;
  const auto size = static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_);
  for (std::vector<float>* field : {&noise_.re, &noise_.im, &speckle_.re, &speckle_.im}) field->resize(size);
  speckle_before_ = speckle_;
  if (c.noise != BackgroundLaw::kK) return;
  texture_.quantiles = gamma_quantiles(c.noise_shape);
  texture_.cell_m = std::max(kTexture_m, c.range_m / kTextureNodes);
  texture_.size = 2 * static_cast<int>(std::ceil(c.range_m / texture_.cell_m)) + 3;
}

// From ping to ping --------------------------------------------------------------------------------------------------

/// Motion in the plane of the fan; if the fan also tilts, in its plane at the previous ping.
void FanFluctuations::follow(const Pose& X_WS) {
  turned_before_ = turned_;
  place_before_ = place_;
  if (begun_) {
    const Rotation back = X_WS_.rotation.inverse();
    const Eigen::Vector3d ahead = back * (X_WS.rotation * Eigen::Vector3d::UnitX());
    const Eigen::Vector3d step = back * (X_WS.translation - X_WS_.translation);
    const double turn = std::atan2(ahead.y(), ahead.x());
    const double c = std::cos(turned_), s = std::sin(turned_);
    place_ += Eigen::Vector2d(c * step.x() - s * step.y(), s * step.x() + c * step.y());
    turned_ += turn;
  }
  X_WS_ = X_WS;
}

FanFluctuations::Passage FanFluctuations::passage(int row) const {
  if (!begun_) return {};
  const auto beams = [this](double turned) { return spacing_ > 0 ? std::lround(turned / spacing_) : 0; };
  const auto bins = [this](double distance) { return std::lround(distance / bin_m_); };
  const long now = beams(turned_), before = beams(turned_before_);
  // The direction of the row, rounded to multiples of the beam spacing, so that scatterers keep theirs from ping to
  // ping.
  const std::size_t taps_aside = (beam_taps_.size() - 1) / 2;
  const auto margin = static_cast<double>(taps_aside);
  const double look = first_azimuth_ + (row - margin) * spacing_ + static_cast<double>(now) * spacing_;
  const Eigen::Vector2d u(std::cos(look), std::sin(look));
  const Eigen::Vector2d step = place_ - place_before_;
  const double across = std::abs(u.x() * step.y() - u.y() * step.x());
  const long from = row + now - before, nearer = bins(place_.dot(u)) - bins(place_before_.dot(u));
  if (from < 0 || from >= rows_ || std::abs(nearer) >= columns_) return {};
  return {static_cast<int>(from), static_cast<int>(nearer), std::exp(-across / forgets_m_)};
}

void FanFluctuations::carry_on(int row, const Passage& from, double surface_keep, const EchoImage& image) {
  const auto columns = static_cast<std::size_t>(columns_);
  float* re = speckle_.re.data() + static_cast<std::size_t>(row) * columns;
  float* im = speckle_.im.data() + static_cast<std::size_t>(row) * columns;
  const float* old_re = speckle_before_.re.data() + static_cast<std::size_t>(from.row) * columns;
  const float* old_im = speckle_before_.im.data() + static_cast<std::size_t>(from.row) * columns;
  const int beam = std::clamp(row - static_cast<int>(beam_taps_.size() - 1) / 2, 0, beams_ - 1);
  const EchoLabel* labels = image.labels.data() + static_cast<std::size_t>(beam) * static_cast<std::size_t>(bins_);
  const auto keep = static_cast<float>(from.keep), fresh = std::sqrt(1 - keep * keep);
  const auto sea_keep = static_cast<float>(from.keep * surface_keep), sea_fresh = std::sqrt(1 - sea_keep * sea_keep);
  const int first = std::max(0, -from.bins), last = std::min(columns_, columns_ - from.bins);
  for (int k = first; k < last; ++k) {
    const bool sea = k < bins_ && labels[k].target() == kSurface;
    const float a = sea ? sea_keep : keep, b = sea ? sea_fresh : fresh;
    re[k] = a * old_re[k + from.bins] + b * re[k];
    im[k] = a * old_im[k + from.bins] + b * im[k];
  }
}

void FanFluctuations::draw_row(int row, std::uint64_t number, double surface_keep, const EchoImage& image) {
  const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
  const auto stream = static_cast<std::uint64_t>(row);
  draw_normals(seed_at(noise_seed_, number, stream), noise_.re.data() + at, noise_.im.data() + at, columns_);
  if (still_ && begun_) return;
  draw_normals(seed_at(speckle_seed_, still_ ? 0 : number, stream), speckle_.re.data() + at, speckle_.im.data() + at,
               columns_);
  if (still_) return;
  const Passage from = passage(row);
  if (from.row >= 0 && from.keep > 1e-3) carry_on(row, from, surface_keep, image);
}

void FanFluctuations::advance(std::uint64_t number, Time time, const Pose& X_WS, const EchoImage& image, int threads) {
  follow(X_WS);
  const double since_s = begun_ ? std::max(0.0, to_seconds(time - time_)) : 0;
  const double surface_keep = std::exp(-since_s / surface_forgets_s_);
  if (!still_) std::swap(speckle_, speckle_before_);
  split_work(rows_, threads, [&](int first, int last) {
    for (int row = first; row < last; ++row) draw_row(row, number, surface_keep, image);
  });
  if (!texture_.quantiles.empty()) draw_texture(time, X_WS);
  time_ = time;
  begun_ = true;
}

// Reading ------------------------------------------------------------------------------------------------------------

void FanFluctuations::filter(const std::vector<float>& white, int beam, std::vector<float>& out) const {
  const auto columns = static_cast<std::size_t>(columns_);
  out.resize(columns);
  std::array<const float*, 2 * kMaxTaps + 1> rows{};
  for (std::size_t j = 0; j < beam_taps_.size(); ++j) {
    rows[j] = white.data() + (static_cast<std::size_t>(beam) + j) * columns;
  }
  sum_rows(rows.data(), beam_taps_.data(), static_cast<int>(beam_taps_.size()), columns_, out.data());
  if (range_taps_.size() == 1) return;
  for (std::size_t k = 0; k < static_cast<std::size_t>(bins_); ++k) {  // in place: a bin needs only later bins
    float sum = 0;
    for (std::size_t i = 0; i < range_taps_.size(); ++i) sum += range_taps_[i] * out[k + i];
    out[k] = sum;
  }
}

void FanFluctuations::read(int beam, Row& row) const {
  filter(noise_.re, beam, row.noise_re);
  filter(noise_.im, beam, row.noise_im);
  filter(speckle_.re, beam, row.speckle_re);
  filter(speckle_.im, beam, row.speckle_im);
  if (!texture_.quantiles.empty()) read_texture(beam, row.texture);
}

// Texture ------------------------------------------------------------------------------------------------------------

void FanFluctuations::draw_texture(Time time, const Pose& X_WS) {
  Texture& t = texture_;
  const double steps = to_seconds(time) / kTexture_s, step = std::floor(steps);
  t.share = steps - step;
  t.north = static_cast<int>(std::floor(X_WS.translation.x() / t.cell_m)) - (t.size - 1) / 2;
  t.east = static_cast<int>(std::floor(X_WS.translation.y() / t.cell_m)) - (t.size - 1) / 2;
  for (int later = 0; later < 2; ++later) {
    std::vector<double>& nodes = t.nodes[later];
    nodes.clear();
    const auto when = static_cast<std::uint64_t>(static_cast<std::int64_t>(step) + later);
    for (int n = 0; n < t.size; ++n) {
      for (int e = 0; e < t.size; ++e) {
        nodes.push_back(random_at(texture_seed_, place_of(t.north + n, t.east + e), when).normal());
      }
    }
  }
}

/// Interpolates between independent nodes; weights of unit energy keep the distribution exact everywhere.
void FanFluctuations::read_texture(int beam, std::vector<float>& out) const {
  const Texture& t = texture_;
  const double azimuth = first_azimuth_ + beam * spacing_;
  const Eigen::Vector3d along = X_WS_.rotation * Eigen::Vector3d(std::cos(azimuth), std::sin(azimuth), 0);
  const int step = std::max(1, static_cast<int>(kTextureStep / bin_m_));
  const double in_time = std::hypot(t.share, 1 - t.share);
  out.resize(static_cast<std::size_t>(bins_));
  for (int first = 0; first < bins_; first += step) {
    const int last = std::min(bins_, first + step);
    const Eigen::Vector3d p = X_WS_.translation + 0.5 * (first + last) * bin_m_ * along;
    const double north = p.x() / t.cell_m - t.north, east = p.y() / t.cell_m - t.east;
    const int n = std::clamp(static_cast<int>(north), 0, t.size - 2),
              e = std::clamp(static_cast<int>(east), 0, t.size - 2);
    const double a = std::clamp(north - n, 0.0, 1.0), b = std::clamp(east - e, 0.0, 1.0);
    const double weights[4] = {(1 - a) * (1 - b), (1 - a) * b, a * (1 - b), a * b};
    double sum = 0, energy = 0;
    for (int i = 0; i < 4; ++i) {
      const int node = (n + i / 2) * t.size + e + i % 2;
      const auto at = static_cast<std::size_t>(node);
      sum += weights[i] * ((1 - t.share) * t.nodes[0][at] + t.share * t.nodes[1][at]);
      energy += weights[i] * weights[i];
    }
    const float value = gamma_quantile(t.quantiles, sum / (std::sqrt(energy) * in_time));
    std::fill(out.begin() + first, out.begin() + last, value);
  }
}

}  // namespace isobath

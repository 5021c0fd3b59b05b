#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/sim/beam_pattern.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr int kTable = 1 << 14;  // steps over pi
constexpr double kFirstLobeDb = 13.2615;

double sinc(double z) { return std::abs(z) < 1e-6 ? 1 : std::sin(z) / z; }

/// A circular piston that transmits and receives: (2 J1(z) / z)^4.
double piston(double z) {
  if (std::abs(z) < 1e-6) return 1;
  const double one_way = 2 * std::cyl_bessel_j(1, std::abs(z)) / std::abs(z);
  return one_way * one_way * one_way * one_way;
}

}  // namespace

BeamPattern::BeamPattern(PatternKind kind, Angle width, double side_lobe_db)
    : kind_(kind), half_width_(width.radians() / 2) {
  ISOBATH_ASSERT(half_width_ > 0 && half_width_ <= std::numbers::pi);
  power_ = std::max(1.0, side_lobe_db / kFirstLobeDb);
  // An array's pattern is a function of the sine of the angle; very wide beams use the angle itself.
  scale_ = half_power_point() / (half_width_ < 0.6 ? std::sin(half_width_) : half_width_);
  table_.resize(kTable + 2);
  for (int i = 0; i < kTable + 2; ++i) {
    const double angle = std::numbers::pi * i / kTable;
    table_[static_cast<std::size_t>(i)] = static_cast<float>(exact_gain(angle));
  }
  envelope_ = table_;
  for (std::size_t i = envelope_.size() - 1; i > 0; --i) envelope_[i - 1] = std::max(envelope_[i - 1], envelope_[i]);
}

double BeamPattern::envelope(double off_axis) const {
  const double at = std::min(std::abs(off_axis), std::numbers::pi) * (kTable / std::numbers::pi);
  return static_cast<double>(envelope_[static_cast<std::size_t>(at)]);
}

double BeamPattern::aperture_gain(double z) const {
  return kind_ == PatternKind::kPiston ? piston(z) : std::pow(std::abs(sinc(z)), 2 * power_);
}

double BeamPattern::half_power_point() const {
  double low = 0, high = std::numbers::pi;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (aperture_gain(middle) > 0.5 ? low : high) = middle;
  }
  return low;
}

double BeamPattern::exact_gain(double off_axis) const {
  const double a = std::abs(off_axis);
  if (kind_ == PatternKind::kIdeal) return a <= half_width_ ? 1 : 0;
  if (kind_ == PatternKind::kGaussian) return std::exp2(-(a / half_width_) * (a / half_width_));
  if (half_width_ >= 0.6) return aperture_gain(std::min(scale_ * a, 0.999 * std::numbers::pi));
  const double behind = a > std::numbers::pi / 2 ? 0.01 : 1;  // a baffle: 20 dB
  return behind * aperture_gain(scale_ * std::sin(std::min(a, std::numbers::pi / 2)));
}

double BeamPattern::gain(double off_axis) const {
  const double a = std::abs(off_axis);
  if (kind_ == PatternKind::kIdeal) return a <= half_width_ ? 1 : 0;
  const double at = std::min(a, std::numbers::pi) * (kTable / std::numbers::pi);
  const auto i = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(i);
  return table_[i] * (1 - share) + table_[i + 1] * share;
}

double BeamPattern::reach(double level) const {
  if (kind_ == PatternKind::kIdeal) return half_width_;
  for (int i = kTable; i > 0; --i) {
    if (table_[static_cast<std::size_t>(i)] > level) return std::numbers::pi * std::min(i + 1, kTable) / kTable;
  }
  return std::numbers::pi / kTable;
}

}  // namespace isobath

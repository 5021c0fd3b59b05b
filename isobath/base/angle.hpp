// Angle: a separate type, because degrees, gradians and radians are confused in practice. Only named functions convert
// from and to numbers. Bearings, azimuths and headings are clockwise from forward (or north) seen from above (ledger:
// Shared notation).
#pragma once

#include <cmath>
#include <compare>
#include <numbers>

namespace isobath {

class Angle {
 public:
  constexpr Angle() = default;
  static constexpr Angle radians(double value) { return Angle(value); }
  static constexpr Angle degrees(double value) { return Angle(value * (std::numbers::pi / 180)); }
  static constexpr Angle gradians(double value) { return Angle(value * (std::numbers::pi / 200)); }

  [[nodiscard]] constexpr double radians() const { return radians_; }
  [[nodiscard]] constexpr double degrees() const { return radians_ * (180 / std::numbers::pi); }

  /// The same direction in (-pi, pi].
  [[nodiscard]] Angle wrapped() const {
    double r = std::remainder(radians_, 2 * std::numbers::pi);
    return Angle(r <= -std::numbers::pi ? r + 2 * std::numbers::pi : r);
  }
  /// The same direction in [0, 2 pi): compass bearings for people.
  [[nodiscard]] Angle wrapped_positive() const {
    double r = wrapped().radians_;
    if (r < 0) r += 2 * std::numbers::pi;
    return Angle(r >= 2 * std::numbers::pi ? 0.0 : r);
  }

  constexpr Angle operator-() const { return Angle(-radians_); }
  constexpr Angle operator+(Angle other) const { return Angle(radians_ + other.radians_); }
  constexpr Angle operator-(Angle other) const { return Angle(radians_ - other.radians_); }
  constexpr Angle operator*(double factor) const { return Angle(radians_ * factor); }
  constexpr Angle operator/(double divisor) const { return Angle(radians_ / divisor); }
  constexpr double operator/(Angle other) const { return radians_ / other.radians_; }
  constexpr Angle& operator+=(Angle other) { return *this = *this + other; }
  constexpr Angle& operator-=(Angle other) { return *this = *this - other; }
  constexpr auto operator<=>(const Angle&) const = default;

 private:
  explicit constexpr Angle(double value) : radians_(value) {}
  double radians_ = 0;
};

inline double sin(Angle a) { return std::sin(a.radians()); }
inline double cos(Angle a) { return std::cos(a.radians()); }
inline Angle abs(Angle a) { return Angle::radians(std::abs(a.radians())); }

}  // namespace isobath

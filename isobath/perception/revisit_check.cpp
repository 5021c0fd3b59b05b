#include <cmath>
#include <isobath/perception/revisit_check.hpp>

namespace isobath {
namespace {

constexpr auto kApart = static_cast<std::uint32_t>(RevisitRecord::kApartMin);

/// Moves a frozen window to the place of the map's; tiles that it gains are those of the map.
void move_along(DepthWindow& frozen, const DepthWindow& window) {
  const Pixel first = window.first_tile();
  if (frozen.first_tile() == first) return;
  frozen.move_to(first);
  for (int row = 0; row < window.tiles(); ++row) {
    for (int column = 0; column < window.tiles(); ++column) {
      const Pixel at{first.column + column, first.row + row};
      if (!frozen.tile(at)) frozen.tile(at) = window.tile(at);
    }
  }
}

}  // namespace

bool IndependentSoundings::counts(const Eigen::Vector2d& north_east, double radius_m, double minute) {
  for (const Place& place : recent_) {
    const double apart = minute - place.minute;
    if (apart >= 0 && apart < RevisitRecord::kApartMin && (place.north_east - north_east).norm() < radius_m)
      return false;
  }
  recent_[next_] = {north_east, minute};
  next_ = (next_ + 1) % recent_.size();
  return true;
}

void RevisitCheck::follow(const DepthWindow& window, std::uint32_t minute) {
  if (!begun_) {
    begun_ = true;
    before_ = since_ = window;
    frozen_ = minute;
    return;
  }
  move_along(before_, window);
  move_along(since_, window);
  if (minute >= frozen_ && minute - frozen_ < kApart) return;
  before_ = since_;
  since_ = window;
  frozen_ = minute;
}

void RevisitCheck::sounding(const DepthWindow& window, const Eigen::Vector3d& p_W, double radius_m,
                            std::uint32_t minute) {
  follow(window, minute);
  if (minute < kApart) return;
  const auto read = [this](const PixelWindow& wanted, std::span<DepthPixel> out) {
    std::size_t i = 0;
    for (int row = wanted.row; row < wanted.row + wanted.height; ++row) {
      for (int column = wanted.column; column < wanted.column + wanted.width; ++column, ++i) {
        const Pixel pixel{column, row};
        out[i] = before_.contains(pixel) ? before_.at(pixel) : DepthPixel{};
      }
    }
  };
  const auto map = comparison_.at(read, p_W.head<2>(), radius_m, minute - kApart);
  const bool measured = map && (map->flags & kSeenByDepth) != 0;  // a chart is no earlier pass
  if (!measured || !independent_.counts(p_W.head<2>(), radius_m, minute)) return;
  const auto gradient = comparison_.gradient(read, p_W.head<2>());
  record_.add({.difference_m = p_W.z() - map->depth_m,
               .margin_m = agreement_margin(margin_m_, margin_share_, p_W.z()),
               .confidence = static_cast<int>(std::lround(map->confidence)),
               .slope = gradient ? std::optional(gradient->norm()) : std::nullopt,
               .apart_min = minute - map->minute});
}

}  // namespace isobath

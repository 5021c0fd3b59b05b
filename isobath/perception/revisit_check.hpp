// RevisitCheck: compares the depth soundings of a run with what the map knew before their pass, for the RevisitRecord
// of the map (IHO S-44, 3.2.3; ledger S1-76).
//
// A pass overwrites the pixels that it is about to meet, for footprints overlap. So a sounding is compared with a
// frozen window of 5 to 10 minutes before, which is a copy of pointers (depth_tile.hpp), and there with pixels that are
// at least as old. Neighbouring soundings share pixels and errors: of those of 5 minutes, one a footprint counts.
//
// Frames: W of the map. One thread, that of the mapper. Allocates nothing after warm-up; some 2 us a sounding.
#pragma once

#include <array>
#include <isobath/map/depth/depth_tile.hpp>
#include <isobath/map/depth/revisit_record.hpp>
#include <isobath/perception/sounding_comparison.hpp>

namespace isobath {

/// Keeps the soundings that share no footprint with a recent one.
class IndependentSoundings {
 public:
  /// Whether no sounding that counted in the last RevisitRecord::kApartMin minutes lies within `radius_m`. If so, this
  /// one counts.
  bool counts(const Eigen::Vector2d& north_east, double radius_m, double minute);

 private:
  struct Place {
    Eigen::Vector2d north_east{0, 0};
    double minute = -1e9;
  };
  std::array<Place, 256> recent_;
  std::size_t next_ = 0;
};

class RevisitCheck {
 public:
  /// Soundings agree within max(margin_m, margin_share times the depth).
  RevisitCheck(const PixelGrid& grid, double margin_m, double margin_share)
      : comparison_(grid), margin_m_(margin_m), margin_share_(margin_share) {}

  /// A bottom at p_W with a footprint of this radius; `window`: of the map, before the sounding changes it.
  void sounding(const DepthWindow& window, const Eigen::Vector3d& p_W, double radius_m, std::uint32_t minute);
  [[nodiscard]] const RevisitRecord& record() const { return record_; }

 private:
  void follow(const DepthWindow& window, std::uint32_t minute);

  SoundingComparison comparison_;
  double margin_m_, margin_share_;
  DepthWindow before_{1}, since_{1};  ///< of 5 to 10, and of 0 to 5 minutes ago
  std::uint32_t frozen_ = 0;          ///< minute of `since_`
  bool begun_ = false;
  IndependentSoundings independent_;
  RevisitRecord record_;
};

}  // namespace isobath

// OpeningView: which part of an opening a pair of forward-looking fans has seen, so that it is known to be free (Horner
// et al. c. 2009, 3 and 6; ledger S5-40, S5-46).
//
// One fan is horizontal, one vertical. Each measures range and one angle, but not where a point lies across its own
// plane (S5-05): an echo of the bed in the horizontal fan, or of a pylon in the vertical one, may stand for any water
// at that range. A point that both fans see in one look is known in all three coordinates (S5-09): here, water that
// both fans have looked at from within `range_m` in the same look is known to be free. A straight approach leaves the
// edges of the opening unknown, because the common beam is narrow.
//
// Pure geometry in open water: no echo, no shadow, no noise, and the opening is flat. The opening's face is divided
// into square cells, judged by their centres. Costs about 5 ns per cell and look. Nothing allocates after construction.
#pragma once

#include <cstdint>
#include <isobath/planning/helix.hpp>
#include <vector>

namespace isobath {

/// Both fans are at the vehicle's reference point; the horizontal one looks straight ahead.
struct FanPair {
  Angle horizontal_sector = Angle::degrees(90);  ///< full, in azimuth
  Angle vertical_sector = Angle::degrees(46);    ///< full, in elevation
  Angle thickness = Angle::degrees(15);          ///< full, across the plane of each
  Angle vertical_pitch = Angle::degrees(-5);     ///< of the middle of the vertical fan, up
  double range_m = 60;                           ///< at which a degree is a metre wide
};

std::vector<Field> fields(FanPair& pair);

/// Whether a direction (components in B, any length) is in the horizontal fan, or in the vertical one.
bool in_horizontal_fan(const FanPair& pair, const Eigen::Vector3d& u_B);
bool in_vertical_fan(const FanPair& pair, const Eigen::Vector3d& u_B);

class OpeningView {
 public:
  explicit OpeningView(const Opening& opening, const FanPair& pair = {}, double cell_m = 0.25);

  void look(const Pose& X_WB);
  /// Share of all cells that both fans have seen in one look.
  [[nodiscard]] double known_share() const;
  [[nodiscard]] int columns() const { return columns_; }  ///< from port to starboard
  [[nodiscard]] int rows() const { return rows_; }        ///< from the surface down
  /// 0: never known; n: known since the n-th look.
  [[nodiscard]] int known_since(int row, int column) const {
    return known_since_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                        static_cast<std::size_t>(column)];
  }
  [[nodiscard]] int looks() const { return looks_; }

 private:
  Opening opening_;
  FanPair pair_;
  int columns_, rows_;
  int looks_ = 0;
  std::size_t known_ = 0;
  std::vector<int> known_since_;
};

/// The angles that an opening subtends at the vehicle (S5-43).
struct OpeningAngles {
  Angle horizontal, vertical;
};
/// From the bearings of the two sides and the elevations of surface and bed: starboard less port (S5-E06), surface less
/// bed (S5-E04), both wrapped, so that north may lie between.
OpeningAngles opening_angles(Angle port, Angle starboard, Angle surface, Angle bed);
/// From a place: compass bearings of the middles of the sides, elevations of the middles of upper and lower edge.
OpeningAngles opening_angles(const Opening& opening, const Eigen::Vector3d& p_W);

/// Cost and benefit of a helix (S5-46): its stretch, and the share of an opening that a pair of fans knows after one
/// turn of it, flown about the opening's middle line and ended `nearest_m` before it. B = C = 0 is the straight line.
struct HelixWorth {
  double stretch = 1;
  double known_share = 0;
};
HelixWorth helix_worth(const EllipticHelix& helix, const Opening& opening, double nearest_m, const FanPair& pair = {});

}  // namespace isobath

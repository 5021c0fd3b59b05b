#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/planning/opening_view.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;

int cells_along(double size_m, double cell_m) { return std::max(1, static_cast<int>(std::lround(size_m / cell_m))); }

/// Whether a direction is in a fan that lies in the x-y plane of its frame.
bool in_fan(const Vector3d& u_S, Angle sector, Angle thickness) {
  const double level = u_S.head<2>().norm();
  return std::abs(std::atan2(u_S.y(), u_S.x())) <= sector.radians() / 2 &&
         std::abs(std::atan2(u_S.z(), level)) <= thickness.radians() / 2;
}

}  // namespace

std::vector<Field> fields(FanPair& p) {
  return {Field::degrees("horizontal_sector_deg", &p.horizontal_sector, {1, 180}, "Sector of the horizontal fan."),
          Field::degrees("vertical_sector_deg", &p.vertical_sector, {1, 180}, "Sector of the vertical fan."),
          Field::degrees("thickness_deg", &p.thickness, {0.1, 90}, "Thickness of both fans, across their planes."),
          Field::degrees("vertical_pitch_deg", &p.vertical_pitch, {-90, 90},
                         "Pitch of the middle of the vertical fan, up."),
          Field::real("range", &p.range_m, {1, 1000}, "m", "Maximum distance from which a look counts.")};
}

bool in_horizontal_fan(const FanPair& pair, const Vector3d& u_B) {
  return in_fan(u_B, pair.horizontal_sector, pair.thickness);
}

bool in_vertical_fan(const FanPair& pair, const Vector3d& u_B) {
  const double c = cos(pair.vertical_pitch), s = sin(pair.vertical_pitch);
  // Pitched, then rolled by a quarter turn: its plane is vertical.
  const Vector3d u_S(c * u_B.x() - s * u_B.z(), s * u_B.x() + c * u_B.z(), -u_B.y());
  return in_fan(u_S, pair.vertical_sector, pair.thickness);
}

OpeningView::OpeningView(const Opening& opening, const FanPair& pair, double cell_m)
    : opening_(opening),
      pair_(pair),
      columns_(cells_along(opening.width_m, cell_m)),
      rows_(cells_along(opening.height_m, cell_m)),
      known_since_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {
  if (!(opening.width_m > 0) || !(opening.height_m > 0) || !(cell_m > 0)) throw Error("an opening without a size");
}

void OpeningView::look(const Pose& X_WB) {
  ++looks_;
  const Pose X_BO = X_WB.inverse() * opening_.X_WO;
  const Vector3d aside = opening_.width_m / columns_ * (X_BO.rotation * Vector3d::UnitY());
  const Vector3d down = opening_.height_m / rows_ * (X_BO.rotation * Vector3d::UnitZ());
  const Vector3d corner = X_BO.translation + (0.5 - 0.5 * columns_) * aside + (0.5 - 0.5 * rows_) * down;
  const double far2 = pair_.range_m * pair_.range_m;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      int& since = known_since_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(column)];
      if (since != 0) continue;
      const Vector3d u_B = corner + column * aside + row * down;
      if (u_B.squaredNorm() > far2 || !in_horizontal_fan(pair_, u_B) || !in_vertical_fan(pair_, u_B)) continue;
      since = looks_;
      ++known_;
    }
  }
}

double OpeningView::known_share() const {
  return static_cast<double>(known_) / static_cast<double>(known_since_.size());
}

OpeningAngles opening_angles(Angle port, Angle starboard, Angle surface, Angle bed) {
  return {(starboard - port).wrapped(), (surface - bed).wrapped()};
}

OpeningAngles opening_angles(const Opening& opening, const Vector3d& p_W) {
  const auto to = [&](double aside, double down) {
    return Vector3d(opening.X_WO * Vector3d(0, aside * opening.width_m / 2, down * opening.height_m / 2) - p_W);
  };
  const auto bearing = [](const Vector3d& u) { return Angle::radians(std::atan2(u.y(), u.x())).wrapped_positive(); };
  const auto elevation = [](const Vector3d& u) { return Angle::radians(std::atan2(-u.z(), u.head<2>().norm())); };
  return opening_angles(bearing(to(-1, 0)), bearing(to(1, 0)), elevation(to(0, -1)), elevation(to(0, 1)));
}

HelixWorth helix_worth(const EllipticHelix& helix, const Opening& opening, double nearest_m, const FanPair& pair) {
  OpeningView view(opening, pair, 0.5);
  constexpr int kLooks = 72;
  const double start = -nearest_m - helix.turn_m();
  for (int i = 0; i <= kLooks; ++i) {
    const double phase = 2 * std::numbers::pi * i / kLooks;
    // The view begins at starboard.
    const CurveJet jet = helix.at(phase - std::numbers::pi / 2);
    const Vector3d p_O(start + helix.advance_m * phase, jet.p.y(), jet.p.z());
    const Angle heading = Angle::radians(std::atan2(jet.d1.y(), jet.d1.x()));
    const Angle pitch = Angle::radians(std::atan2(-jet.d1.z(), jet.d1.head<2>().norm()));
    view.look(opening.X_WO * Pose{Rotation::from_heading_pitch_roll(heading, pitch, Angle()), p_O});
  }
  return {helix.stretch(), view.known_share()};
}

}  // namespace isobath

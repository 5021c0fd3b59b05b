#include <algorithm>
#include <cmath>
#include <Eigen/Geometry>
#include <isobath/sim/small_bodies.hpp>
#include <numbers>
#include <optional>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kLoudestSurface = 16;  ///< largest sigma of a glint
constexpr double kSmall = 4;            ///< a body smaller than so many cells in one direction gets cells of its own

struct Window {
  double left, right, low, high, nearest;
};

/// The angles that a box spans as seen from the sonar; empty within 5 cm of it, or if it spans more than 90 degrees
/// of azimuth.
std::optional<Window> window_of(const EchoPaths& paths, const Eigen::AlignedBox3d& box) {
  if (box.exteriorDistance(paths.X_WS.translation) < 0.05) return std::nullopt;
  const Vector3d middle = paths.R_WS.transpose() * (box.center() - paths.X_WS.translation);
  const double centre = std::atan2(middle.y(), middle.x());
  Window w{1e9, -1e9, 1e9, -1e9, box.exteriorDistance(paths.X_WS.translation)};
  const auto include = [&](const Vector3d& p_W) {
    const Vector3d c = paths.R_WS.transpose() * (p_W - paths.X_WS.translation);
    const double azimuth = centre + std::remainder(std::atan2(c.y(), c.x()) - centre, 2 * std::numbers::pi);
    const double elevation = std::atan2(-c.z(), std::hypot(c.x(), c.y()));
    w.left = std::min(w.left, azimuth);
    w.right = std::max(w.right, azimuth);
    w.low = std::min(w.low, elevation);
    w.high = std::max(w.high, elevation);
  };
  for (int i = 0; i < 8; ++i) include(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  // The elevation of a broad box is extreme at its nearest point, between its corners.
  Vector3d nearest = paths.X_WS.translation.cwiseMax(box.min()).cwiseMin(box.max());
  for (const double z : {box.min().z(), box.max().z()}) {
    nearest.z() = z;
    include(nearest);
  }
  if (w.right - w.left > std::numbers::pi / 2) return std::nullopt;
  return w;
}

/// Whether it could give an echo: it is within range and elevation, and near enough to the beams for its size.
bool can_echo(const EchoPaths& paths, const Window& w) {
  if (w.nearest > paths.config.range_m || w.low > paths.view.edges.back() || w.high < paths.view.edges.front())
    return false;
  const double aside = std::max({0.0, w.left - paths.view.beams.back(), paths.view.beams.front() - w.right});
  if (aside > paths.view.hearing) return false;
  const double size = (w.right - w.left) * (w.high - w.low);
  return kLoudestSurface * size / (w.nearest * w.nearest) * paths.view.across.envelope(aside) > 0.1 * paths.floor;
}

/// Traces cells around one body. `mirror_z`: over the horizontal mirror at that depth, or NaN for the direct path.
void look_at(const EchoPaths& paths, int target, Window w, double mirror_z, int mirror_target,
             std::vector<BodyEcho>& echoes) {
  const double pad_across = 0.02 * (w.right - w.left) + 1e-6, pad_up = 0.02 * (w.high - w.low) + 1e-6;
  w.left -= pad_across;
  w.right += pad_across;
  w.low = std::max(w.low - pad_up, paths.view.edges.front());
  w.high = std::min(w.high + pad_up, paths.view.edges.back());
  if (w.high <= w.low) return;
  const auto count = [mirror_z](double extent, double cell) {
    const int least = std::isnan(mirror_z) ? 16 : 8;  // mirror images need not be exact
    return std::clamp(static_cast<int>(std::ceil(8 * extent / cell)), least, 24);
  };
  const int columns = count(w.right - w.left, paths.view.cell_across),
            lines = count(w.high - w.low, paths.view.cell_up);
  std::vector<PathEcho> of_column;
  for (int c = 0; c < columns; ++c) {
    const double width = (w.right - w.left) / columns, azimuth = w.left + (c + 0.5) * width;
    of_column.clear();
    for (int l = 0; l < lines; ++l) {
      const double step = (w.high - w.low) / lines;
      const ViewCell cell = cell_of(azimuth, width, w.low + l * step, w.low + (l + 1) * step, paths.view.height);
      double open = 0;
      if (std::isnan(mirror_z)) {
        paths.trace(cell, target, open, of_column);
      } else {
        paths.over_mirror(cell, target, mirror_z, mirror_target, of_column);
      }
    }
    for (const PathEcho& echo : of_column) echoes.push_back({azimuth, echo});
  }
}

/// Traces a body over a horizontal mirror: the surface, or the bottom, taken as level at its depth below the sonar.
void look_over(const EchoPaths& paths, int target, const Eigen::AlignedBox3d& box, double mirror_z, int mirror_target,
               std::vector<BodyEcho>& echoes) {
  Eigen::AlignedBox3d image = box;
  image.min().z() = 2 * mirror_z - box.max().z();
  image.max().z() = 2 * mirror_z - box.min().z();
  if (const auto w = window_of(paths, image); w && can_echo(paths, *w))
    look_at(paths, target, *w, mirror_z, mirror_target, echoes);
}

}  // namespace

void trace_small_bodies(EchoPaths& paths, std::vector<BodyEcho>& echoes) {
  echoes.clear();
  const auto bodies = paths.world.bodies();
  paths.small.assign(bodies.size(), false);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Eigen::AlignedBox3d box = bodies[i].box;
    box.translate(bodies[i].moved);
    const auto w = window_of(paths, box);
    paths.small[i] =
        w && (w->right - w->left < kSmall * paths.view.cell_across || w->high - w->low < kSmall * paths.view.cell_up);
  }
  const double floor_z = paths.world.bottom_depth(paths.X_WS.translation.x(), paths.X_WS.translation.y()).value_or(-1);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!paths.small[i]) continue;
    const int target = kFirstBody + static_cast<int>(i);
    Eigen::AlignedBox3d box = bodies[i].box;
    box.translate(bodies[i].moved);
    if (const auto w = window_of(paths, box); w && can_echo(paths, *w))
      look_at(paths, target, *w, std::nan(""), kNothing, echoes);
    if (paths.config.surface_bounce && paths.X_WS.translation.z() > 0)
      look_over(paths, target, box, 0, kSurface, echoes);
    if (paths.config.bottom_bounce && floor_z > paths.X_WS.translation.z())
      look_over(paths, target, box, floor_z, kBottom, echoes);
  }
}

}  // namespace isobath

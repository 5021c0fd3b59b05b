#include <algorithm>
#include <cmath>
#include <isobath/base/angle.hpp>
#include <isobath/mission/safety/near_echoes.hpp>
#include <iterator>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

constexpr std::int64_t kCellsAcross = 3;  // per `confirm_m`: the places of echoes must be resolved finer than that
constexpr double kFarthest = 1e8;         // m from the origin: farther places are invalid
constexpr double kStraight = 1e-6;        // 1/m
constexpr double kBeamHigh_m = 1;         // above and below its axis: where a beam is as high, it looks at an echo

/// Whether the beams that look at a place, and those within `apart_m` of it, were silent up to `apart_m` beyond it.
bool is_silent(const SonarEchoes& look, const Eigen::Vector2d& place_L, double apart_m) {
  const Eigen::Vector2d way = place_L - look.sonar_L;
  const double range = way.norm();
  if (!(range > look.blanking_m && range * std::tan(0.5 * look.fan->height.radians()) > kBeamHigh_m)) return false;
  const double azimuth = (Angle::radians(std::atan2(way.y(), way.x())) - look.boresight_L).wrapped().radians();
  const double aside = std::asin(std::min(1.0, apart_m / range));
  const std::vector<Angle>& beams = look.fan->azimuth;
  bool looked = false;
  const auto after = [](double value, Angle angle) { return value < angle.radians(); };
  auto beam = std::upper_bound(beams.begin(), beams.end(), azimuth - aside, after);
  for (; beam != beams.end() && beam->radians() < azimuth + aside; ++beam) {
    const auto b = static_cast<std::size_t>(beam - beams.begin());
    if (static_cast<double>(look.silent_m[b]) < range + apart_m) return false;
    looked = looked || std::abs(beam->radians() - azimuth) <= 0.5 * look.fan->width[b].radians();
  }
  return looked;
}

}  // namespace

void NearEchoes::add(std::span<const Eigen::Vector2d> echoes_L, const Pose& X_WL, double reach_m,
                     const SafetyConfig& config, double now_s) {
  if (!X_WL.is_finite()) return;
  cell_m_ = config.confirm_m / kCellsAcross;
  for (const Eigen::Vector2d& echo : echoes_L) {
    if (!echo.allFinite() || !(echo.norm() <= reach_m)) continue;
    const Eigen::Vector2d place = (X_WL * Eigen::Vector3d(echo.x(), echo.y(), 0)).head<2>();
    if (place.allFinite() && place.cwiseAbs().maxCoeff() < kFarthest) put(place, config, now_s);
  }
  if (cells_.size() > kMax) forget(now_s - std::max(config.confirm_s, config.memory_s));
  while (cells_.size() > kMax) {
    cells_.erase(std::min_element(cells_.begin(), cells_.end(),
                                  [](const auto& a, const auto& b) { return a.second.heard_s < b.second.heard_s; }));
  }
}

void NearEchoes::put(const Eigen::Vector2d& place_W, const SafetyConfig& config, double now_s) {
  const Key key{static_cast<std::int64_t>(std::floor(place_W.x() / cell_m_)),
                static_cast<std::int64_t>(std::floor(place_W.y() / cell_m_))};
  Echo echo{place_W, now_s, now_s};
  for (std::int64_t i = key.first - kCellsAcross; i <= key.first + kCellsAcross; ++i) {
    const Key last{i, key.second + kCellsAcross};
    for (auto other = cells_.lower_bound({i, key.second - kCellsAcross}); other != cells_.end(); ++other) {
      if (other->first > last) break;
      // Echoes of the same ping do not confirm each other.
      if (!(other->second.heard_s < now_s) || now_s - other->second.heard_s > config.confirm_s) continue;
      other->second.confirmed = true;
      echo.confirmed = true;
    }
  }
  const auto known = cells_.find(key);
  if (known != cells_.end()) echo.confirmed = echo.confirmed || known->second.confirmed;
  cells_[key] = echo;
}

void NearEchoes::hear_silence(const SonarEchoes& look, const SafetyConfig& config, double now_s) {
  const bool valid = look.fan && look.fan->width.size() == look.silent_m.size() &&
                     look.fan->azimuth.size() == look.silent_m.size() && look.X_WL.is_finite();
  if (!valid) return;
  const Pose X_LW = look.X_WL.inverse();
  for (auto cell = cells_.begin(); cell != cells_.end();) {
    Echo& echo = cell->second;
    const Eigen::Vector3d place_W(echo.place_W.x(), echo.place_W.y(), look.X_WL.translation.z());
    if (is_silent(look, (X_LW * place_W).head<2>(), config.confirm_m)) ++echo.silent_looks;
    const bool gone = echo.silent_looks >= kSilentLooks && now_s - echo.heard_s >= kSilent_s;
    cell = gone ? cells_.erase(cell) : std::next(cell);
  }
}

void NearEchoes::shift(const Eigen::Vector2d& by_W) {
  std::map<Key, Echo> moved;
  for (const auto& [key, echo] : cells_) {
    Echo there = echo;
    there.place_W += by_W;
    if (!there.place_W.allFinite() || there.place_W.cwiseAbs().maxCoeff() >= kFarthest) continue;
    moved[{static_cast<std::int64_t>(std::floor(there.place_W.x() / cell_m_)),
           static_cast<std::int64_t>(std::floor(there.place_W.y() / cell_m_))}] = there;
  }
  cells_ = std::move(moved);
}

void NearEchoes::forget(double before_s) {
  std::erase_if(cells_, [&](const auto& cell) { return cell.second.counts_s < before_s; });
}

std::span<const NearEcho> NearEchoes::confirmed(const Pose& X_WL, double blanking_m, const SafetyConfig& config,
                                                double now_s) {
  found_.clear();
  const Pose X_LW = X_WL.inverse();
  for (auto& [key, echo] : cells_) {
    const Eigen::Vector2d place =
        (X_LW * Eigen::Vector3d(echo.place_W.x(), echo.place_W.y(), X_WL.translation.z())).head<2>();
    if (place.norm() < blanking_m) echo.counts_s = now_s;
    if (echo.confirmed && now_s - echo.counts_s <= config.memory_s)
      found_.push_back({place, now_s - echo.heard_s, key});
  }
  forget(now_s - std::max(config.confirm_s, config.memory_s));
  return found_;
}

double free_way(std::span<const Eigen::Vector2d> points, double curvature, double half_width_m, double bow_m,
                double reach_m) {
  double nearest = std::numeric_limits<double>::infinity();
  const bool straight = std::abs(curvature) < kStraight;
  const double radius = straight ? 0 : 1 / std::abs(curvature);
  const double reach = straight ? reach_m : std::min(reach_m, std::numbers::pi * radius);
  for (const Eigen::Vector2d& p : points) {
    double along = p.x(), beside = p.y();
    if (!straight) {  // polar coordinates about the centre of the turn, which lies abeam
      const double y = curvature > 0 ? p.y() : -p.y();
      along = radius * std::atan2(p.x(), radius - y);
      beside = std::hypot(p.x(), radius - y) - radius;
    }
    if (!(std::abs(beside) <= half_width_m) || !(along > 0)) continue;
    const double way = std::max(0.0, along - bow_m);
    if (way <= reach) nearest = std::min(nearest, way);
  }
  return nearest;
}

}  // namespace isobath

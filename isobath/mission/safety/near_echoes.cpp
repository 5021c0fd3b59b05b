#include <algorithm>
#include <array>
#include <cmath>
#include <isobath/base/angle.hpp>
#include <isobath/mission/safety/near_echoes.hpp>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

constexpr std::int64_t kCellsAcross = 3;   // per `confirm_m`: the places of echoes must be resolved finer than that
constexpr double kFarthest = 1e8;          // m from the origin: farther places are invalid
constexpr double kStraight = 1e-6;         // 1/m
constexpr double kBeamHigh_m = 1;          // above and below its axis: where a beam is as high, it looks at an echo
constexpr double kClearly = 4;             // times the chance of noise: what a body gives at least
constexpr double kAlways = 0.95;           // largest share of the looks
constexpr std::size_t kMaxSectors = 2000;  // bounds the memory of looks
constexpr double kCounted_s = 120;         // in which the counts of false echoes fall to 1 / e

/// How the beams of one ping look at a place.
struct Look {
  int beams = 0;        ///< that look within `apart_m` of it, and that nothing nearer blocks
  bool silent = false;  ///< the beams that look at it, and those within `apart_m`, hear nothing up to `apart_m` beyond
};

bool has_beams(const SonarEchoes& ping) {
  return ping.fan && ping.fan->width.size() == ping.silent_m.size() &&
         ping.fan->azimuth.size() == ping.silent_m.size() && ping.X_WL.is_finite();
}

Look look_at(const SonarEchoes& ping, const Eigen::Vector2d& place_L, double apart_m) {
  const Eigen::Vector2d way = place_L - ping.sonar_L;
  const double range = way.norm();
  Look look;
  if (!(range > ping.blanking_m)) return look;
  const double azimuth = (Angle::radians(std::atan2(way.y(), way.x())) - ping.boresight_L).wrapped().radians();
  const double aside = std::asin(std::min(1.0, apart_m / range));
  const std::vector<Angle>& beams = ping.fan->azimuth;
  bool aimed = false, heard = false;
  const auto after = [](double value, Angle angle) { return value < angle.radians(); };
  auto beam = std::upper_bound(beams.begin(), beams.end(), azimuth - aside, after);
  for (; beam != beams.end() && beam->radians() < azimuth + aside; ++beam) {
    const auto b = static_cast<std::size_t>(beam - beams.begin());
    const auto silent_m = static_cast<double>(ping.silent_m[b]);
    if (silent_m >= range - apart_m) ++look.beams;
    heard = heard || silent_m < range + apart_m;
    aimed = aimed || std::abs(beam->radians() - azimuth) <= 0.5 * ping.fan->width[b].radians();
  }
  // A beam that is not as high may pass above or below what is there.
  look.silent = aimed && !heard && range * std::tan(0.5 * ping.fan->height.radians()) > kBeamHigh_m;
  return look;
}

using Evidence = NearEchoes::Evidence;

constexpr Evidence kUnknownLook{NearEchoes::kMostEvidence, NearEchoes::kMostEvidence, NearEchoes::kMostEvidence};

/// The chance that noise gives so many echoes or more, of which `mean` are expected.
double chance_of(int echoes, double mean) {
  double none_to_fewer = 0, of_k = std::exp(-mean);
  for (int k = 0; k < echoes; ++k) {
    none_to_fewer += of_k;
    of_k *= mean / (k + 1);
  }
  return echoes == 1 ? -std::expm1(-mean) : std::max(0.0, 1 - none_to_fewer);
}

/// What `echoes` in a look, and a look without one, add to the evidence of each kind of body.
struct Gains {
  Gains(int beams, int echoes, double false_per_m, double apart_m) {
    const double mean = beams * false_per_m * 0.5 * std::numbers::pi * apart_m;
    const double any = chance_of(1, mean), noise = chance_of(echoes, mean);
    for (std::size_t i = 0; i < echo.size(); ++i) {
      const double body = std::min(kAlways, std::max(NearEchoes::kBodies[i], kClearly * any));
      echo[i] = noise > 0 ? std::min(NearEchoes::kMostEvidence, std::log(body / noise)) : NearEchoes::kMostEvidence;
      silence[i] = std::min(0.0, std::log1p(-body) - std::log1p(-std::min(kAlways, any)));
    }
  }
  Evidence echo{}, silence{};
};

int echoes_near(const SonarEchoes& ping, const Eigen::Vector2d& place_L, double apart_m) {
  const auto is_near = [&](const Eigen::Vector2d& echo) { return (echo - place_L).norm() <= apart_m; };
  return static_cast<int>(std::ranges::count_if(ping.echoes_L, is_near));
}

Evidence greater(const Evidence& a, const Evidence& b) {
  Evidence most = a;
  for (std::size_t i = 0; i < b.size(); ++i) most[i] = std::max(most[i], b[i]);
  return most;
}

/// The logarithm of the mean of the likelihood ratios.
double total(const Evidence& evidence) {
  const double most = *std::ranges::max_element(evidence);
  double sum = 0;
  for (const double e : evidence) sum += std::exp(e - most);
  return most + std::log(sum / static_cast<double>(evidence.size()));
}

}  // namespace

void NearEchoes::add(const SonarEchoes& ping, double reach_m, const SafetyConfig& config, double now_s) {
  if (!ping.X_WL.is_finite()) return;
  const bool looks = has_beams(ping);
  if (looks) note_sector(ping, config.confirm_s, now_s);
  for (const Eigen::Vector2d& echo : ping.echoes_L) {
    const int beams = looks && echo.allFinite() ? look_at(ping, echo, config.confirm_m).beams : 0;
    Evidence gain = kUnknownLook;
    if (beams > 0) {
      const int echoes = echoes_near(ping, echo, config.confirm_m);
      gain = Gains(beams, echoes, false_echoes_per_m(), config.confirm_m).echo;
    }
    take(echo, ping.X_WL, reach_m, gain, beams > 0 ? looks_at(ping, echo, config.confirm_m) : 0, config, now_s);
  }
  if (looks) look(ping, reach_m, config, now_s);
  bound(config, now_s);
}

void NearEchoes::add(const Eigen::Vector2d& echo_L, const Pose& X_WL, double reach_m, const SafetyConfig& config,
                     double now_s) {
  if (!X_WL.is_finite()) return;
  take(echo_L, X_WL, reach_m, kUnknownLook, 0, config, now_s);
  bound(config, now_s);
}

void NearEchoes::note_sector(const SonarEchoes& ping, double within_s, double now_s) {
  const auto is_over = [&](const Sector& sector) { return sector.time_s < now_s - within_s || sector.time_s > now_s; };
  while (!sectors_.empty() && (sectors_.size() >= kMaxSectors || is_over(sectors_.front()))) sectors_.pop_front();
  const std::vector<Angle>& beams = ping.fan->azimuth;
  if (beams.empty()) return;
  const double first = beams.front().radians() - 0.5 * ping.fan->width.front().radians();
  const double last = beams.back().radians() + 0.5 * ping.fan->width.back().radians();
  const double ahead = (ping.X_WL.rotation.heading() + ping.boresight_L).radians();
  sectors_.push_back({now_s, ahead + 0.5 * (first + last), 0.5 * (last - first)});
}

/// The pings of the last `confirm_s`, this one with them, that had a beam within `apart_m` of the echo.
int NearEchoes::looks_at(const SonarEchoes& ping, const Eigen::Vector2d& echo_L, double apart_m) const {
  const Eigen::Vector2d way = echo_L - ping.sonar_L;
  const double azimuth = std::atan2(way.y(), way.x()) + ping.X_WL.rotation.heading().radians();
  const double aside = std::asin(std::min(1.0, apart_m / std::max(way.norm(), apart_m)));
  return static_cast<int>(std::ranges::count_if(sectors_, [&](const Sector& sector) {
    return std::abs(std::remainder(azimuth - sector.middle, 2 * std::numbers::pi)) <= sector.half + aside;
  }));
}

void NearEchoes::take(const Eigen::Vector2d& echo_L, const Pose& X_WL, double reach_m, const Evidence& gain, int looks,
                      const SafetyConfig& config, double now_s) {
  cell_m_ = config.confirm_m / kCellsAcross;
  if (!echo_L.allFinite() || !(echo_L.norm() <= reach_m)) return;
  const Eigen::Vector2d place = (X_WL * Eigen::Vector3d(echo_L.x(), echo_L.y(), 0)).head<2>();
  if (place.allFinite() && place.cwiseAbs().maxCoeff() < kFarthest) put(place, gain, looks, config, now_s);
}

/// Removes the oldest where there are too many.
void NearEchoes::bound(const SafetyConfig& config, double now_s) {
  if (cells_.size() > kMax) forget(now_s - std::max(config.confirm_s, config.memory_s));
  while (cells_.size() > kMax) {
    cells_.erase(std::min_element(cells_.begin(), cells_.end(),
                                  [](const auto& a, const auto& b) { return a.second.heard_s < b.second.heard_s; }));
  }
}

void NearEchoes::put(const Eigen::Vector2d& place_W, const Evidence& gain, int looks, const SafetyConfig& config,
                     double now_s) {
  const Key key{static_cast<std::int64_t>(std::floor(place_W.x() / cell_m_)),
                static_cast<std::int64_t>(std::floor(place_W.y() / cell_m_))};
  Echo echo{place_W, now_s, now_s};
  std::vector<Echo*> near;
  for (std::int64_t i = key.first - kCellsAcross; i <= key.first + kCellsAcross; ++i) {
    const Key last{i, key.second + kCellsAcross};
    for (auto other = cells_.lower_bound({i, key.second - kCellsAcross}); other != cells_.end(); ++other) {
      if (other->first > last) break;
      // Echoes of the same ping do not confirm each other.
      if (!(other->second.heard_s < now_s) || now_s - other->second.heard_s > config.confirm_s) continue;
      if (!((other->second.place_W - place_W).norm() <= config.confirm_m)) continue;
      near.push_back(&other->second);
      echo.evidence = greater(echo.evidence, other->second.evidence);
    }
  }
  const auto known = cells_.find(key);
  const double needed = kEnough + std::log(std::max(1.0, looks / kFewLooks));
  for (std::size_t i = 0; i < gain.size(); ++i)
    echo.evidence[i] = std::min(echo.evidence[i] + gain[i], needed + kMostEvidence);
  if (known != cells_.end()) {
    echo.evidence = greater(echo.evidence, known->second.evidence);
    echo.confirmed = known->second.confirmed;
  }
  const bool enough = total(echo.evidence) >= needed;
  echo.confirmed = echo.confirmed || enough;
  if (enough) {
    for (Echo* other : near) {
      if (!std::exchange(other->confirmed, true)) false_echoes_ = std::max(0.0, false_echoes_ - 1);
    }
  }
  if (!echo.confirmed) ++false_echoes_;
  cells_[key] = echo;
}

/// The metres of beam in which the ping could have heard a false echo, and the ageing of the counts.
void NearEchoes::count_metres(const SonarEchoes& ping, double reach_m, double now_s) {
  const double kept = std::exp(-std::max(0.0, now_s - counted_s_) / kCounted_s);
  counted_s_ = now_s;
  false_echoes_ *= kept;
  looked_m_ *= kept;
  for (const float silent_m : ping.silent_m) {
    const double metres = std::min(static_cast<double>(silent_m), reach_m) - ping.blanking_m;
    if (metres > 0) looked_m_ += metres;
  }
}

void NearEchoes::look(const SonarEchoes& ping, double reach_m, const SafetyConfig& config, double now_s) {
  count_metres(ping, reach_m, now_s);
  const double false_per_m = false_echoes_per_m();
  const Pose X_LW = ping.X_WL.inverse();
  for (auto cell = cells_.begin(); cell != cells_.end();) {
    Echo& echo = cell->second;
    const Eigen::Vector3d place_W(echo.place_W.x(), echo.place_W.y(), ping.X_WL.translation.z());
    const Look looked = look_at(ping, (X_LW * place_W).head<2>(), config.confirm_m);
    if (looked.beams > 0 && echo.heard_s < now_s) {
      const Evidence less = Gains(looked.beams, 1, false_per_m, config.confirm_m).silence;
      for (std::size_t i = 0; i < less.size(); ++i) echo.evidence[i] = std::max(0.0, echo.evidence[i] + less[i]);
    }
    if (looked.silent) ++echo.silent_looks;
    const bool gone = echo.silent_looks >= kSilentLooks && now_s - echo.heard_s >= kSilent_s;
    if (gone && echo.confirmed) ++false_echoes_;
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

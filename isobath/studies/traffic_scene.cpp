#include <algorithm>
#include <cmath>
#include <isobath/base/random.hpp>
#include <isobath/studies/traffic_scene.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

constexpr double kLowX = -20, kHighX = 160, kLowY = -60, kHighY = 60, kFreeStart_m = 15;

void reflect(double& position, double& velocity, double low, double high) {
  if (position < low) {
    position = 2 * low - position;
    velocity = -velocity;
  } else if (position > high) {
    position = 2 * high - position;
    velocity = -velocity;
  }
}

}  // namespace

TrafficScene::TrafficScene(std::uint64_t run, int discs, double max_speed) {
  Random random(run * 1000003 + static_cast<std::uint64_t>(discs) * 7919 +
                static_cast<std::uint64_t>(static_cast<int>(100 * max_speed)));
  for (int i = 0; i < discs; ++i) {
    MovingBody disc;
    disc.number = i;
    do {
      const double x = random.uniform(kLowX, kHighX), y = random.uniform(kLowY, kHighY);
      disc.p_W = {x, y};
      disc.radius_m = random.uniform(0.5, 3);
    } while (disc.p_W.norm() < kFreeStart_m + disc.radius_m);
    const double speed = max_speed * random.uniform(0.2, 1), direction = random.uniform(0, 2 * std::numbers::pi);
    disc.velocity_W = speed * Eigen::Vector2d(std::cos(direction), std::sin(direction));
    discs_.push_back(disc);
  }
}

void TrafficScene::step() {
  now_ += seconds(kStep_s);
  for (MovingBody& disc : discs_) {
    disc.p_W += kStep_s * disc.velocity_W;
    reflect(disc.p_W.x(), disc.velocity_W.x(), kLowX, kHighX);
    reflect(disc.p_W.y(), disc.velocity_W.y(), kLowY, kHighY);
    disc.time = now_;
  }
}

void TrafficScene::sense(const Eigen::Vector2d& p, std::vector<MovingBody>& seen) const {
  seen.clear();
  for (const MovingBody& disc : discs_) {
    if ((disc.p_W - p).norm() <= kReach_m) seen.push_back(disc);
  }
}

double TrafficScene::gap(const Eigen::Vector2d& p) const {
  double least = std::numeric_limits<double>::infinity();
  for (const MovingBody& disc : discs_) least = std::min(least, (disc.p_W - p).norm() - disc.radius_m - kRadius_m);
  return least;
}

}  // namespace isobath

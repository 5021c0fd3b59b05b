#include <algorithm>
#include <cmath>
#include <isobath/base/angle.hpp>
#include <isobath/perception/aspect_law.hpp>

namespace isobath {
namespace {

constexpr double kPlainDetect = 0.8;  // p_D at which `share` is exact

/// Of one look: 1 - R.
double silent(double p_detect, double false_alarm, double weight) {
  const double missed = std::clamp((1 - p_detect) / (1 - false_alarm), 1e-6, 1.0);
  return 1 - std::pow(missed, weight);
}

}  // namespace

std::vector<Field> fields(AspectConfig& c) {
  return {
      Field::real("aspect_visibility", &c.visibility, {0.01, 0.99}, "1",
                  "Rule aspects: share of the directions from which an occupied voxel can echo at all.")
          .was("aspect_answers"),
      Field::real("aspect_renewal", &c.renewal, {0, 1}, "1",
                  "Rule aspects: share of the looks that count as from a new direction."),
      Field::real("aspect_no_echo_weight", &c.no_echo_weight, {0.01, 1}, "1",
                  "Rule aspects: weight of a ping without an echo, in independent looks.")
          .was("aspect_silence"),
      Field::real("aspect_max_log_odds", &c.max_log_odds, {0, 30}, "1",
                  "Rule aspects: log-odds that echoes from one direction can give at most.")
          .was("aspect_limit"),
      Field::real("aspect_turn_deg", &c.turn_deg, {0.1, 360}, "deg",
                  "Rule aspects: once the line of sight has turned by so much, the direction is another."),
  };
}

double AspectLaw::answering(double evidence) const {
  const double a = config_.visibility, k = config_.renewal;
  return std::clamp(1 - (1 - a) * std::exp(-evidence), k * a, 1 - k * (1 - a));
}

double AspectLaw::silence(double p_detect, double false_alarm) const {
  return std::log1p(-config_.visibility * silent(p_detect, false_alarm, config_.no_echo_weight));
}

double AspectLaw::share(double evidence) const {
  const double s = silent(kPlainDetect, 0, config_.no_echo_weight);
  return std::log1p(-answering(evidence) * s) / std::log1p(-config_.visibility * s);
}

double AspectLaw::echo(double evidence, double ratio, double turned) const {
  const double gain = std::log1p(answering(evidence) * std::max(ratio - 1, 0.0));
  const double free = std::clamp(config_.max_log_odds - evidence, 0.0, gain);
  return free + (gain - free) * turned;
}

double AspectLaw::turned(const Eigen::Vector3d& p, const Eigen::Vector3d& moved, double near_m) const {
  const double angle = p.cross(moved).norm() / std::max(p.squaredNorm(), near_m * near_m);
  return std::min(1.0, angle / Angle::degrees(config_.turn_deg).radians());
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <tests/run/simple_reservoir.hpp>

namespace isobath::test {
namespace {

// The sonar of the thesis (S6-01): 3 x 35 degrees, 90 degree sector in steps of 3, 44 bins to 50 m, 9 of them blind.
constexpr int kSteps = 31, kBins = 44, kBlindBins = 9;
constexpr double kRange = 50, kBin = kRange / kBins, kPingInterval = 0.1, kWidthDeg = 3, kDepth = 0.5;

/// Two-way gain of the beam at an angle off its axis.
double beam_gain(Angle off_axis) {
  const double half_widths = off_axis.degrees() / (kWidthDeg / 2);
  return std::exp2(-half_widths * half_widths);
}

std::shared_ptr<const BeamFan> one_beam(Angle azimuth) {
  return std::make_shared<BeamFan>(BeamFan{{azimuth}, {Angle::degrees(kWidthDeg)}, Angle::degrees(35)});
}

void add(std::vector<double>& profile, double range, double amplitude) {
  const auto bin = static_cast<long>(range / kBin);
  if (range > 0 && bin < kBins) profile[static_cast<std::size_t>(bin)] += amplitude;
}

/// Where the ray from p along d (unit) meets the segment, as range and cosine of incidence.
std::optional<std::pair<double, double>> meet(const Eigen::Vector2d& p, const Eigen::Vector2d& d,
                                              const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double cross = d.x() * along.y() - d.y() * along.x();
  if (std::abs(cross) < 1e-12) return std::nullopt;
  const Eigen::Vector2d to = a - p;
  const double range = (to.x() * along.y() - to.y() * along.x()) / cross;
  const double share = (to.x() * d.y() - to.y() * d.x()) / cross;
  if (range <= 0 || share < 0 || share > 1) return std::nullopt;
  return std::pair(range, std::abs(cross) / along.norm());
}

}  // namespace

const std::vector<Eigen::Vector2d>& SimpleReservoir::buoys() {
  static const std::vector<Eigen::Vector2d> kBuoys{{45, 4}, {58, -12}};
  return kBuoys;
}

const std::vector<Eigen::Vector2d>& SimpleReservoir::embankment() {
  static const std::vector<Eigen::Vector2d> kLine{{-20, 26}, {60, 24}, {90, 14}, {110, -10}, {120, -60}};
  return kLine;
}

SimpleReservoir::SimpleReservoir(const SimpleReservoirConfig& config)
    : config_(config), random_(static_cast<std::uint64_t>(config.seed)) {
  for (int i = 0; i < kSteps; ++i) fans_.push_back(one_beam(Angle::degrees(-45 + 3 * i)));
}

Pose SimpleReservoir::body_at(double t) const {
  // North at first, then a slow turn to port that keeps off the far embankment.
  const double turn = std::clamp((t - 25) / 20, 0.0, 1.0);
  const double heading = -1.2 * turn;
  const double straight = std::min(t, 25.0) * config_.speed;
  Eigen::Vector3d p(straight, 0, kDepth);
  constexpr double kStep = 0.05;
  for (double u = 25; u < t; u += kStep) {  // the turn, by small steps of the same law
    const double h = -1.2 * std::clamp((u - 25) / 20, 0.0, 1.0);
    const double ds = std::min(kStep, t - u) * config_.speed;
    p += Eigen::Vector3d(std::cos(h), std::sin(h), 0) * ds;
  }
  return {Rotation::from_heading(Angle::radians(heading)), p};
}

void SimpleReservoir::add_buoys(const Pose& X_WB, Angle azimuth, std::vector<double>& profile) const {
  const double amplitude = config_.noise_sigma * std::pow(10, config_.snr_db / 20);
  for (const Eigen::Vector2d& buoy : buoys()) {
    const Eigen::Vector3d seen = X_WB.inverse() * Eigen::Vector3d(buoy.x(), buoy.y(), kDepth);
    const Angle off = Angle::radians(std::atan2(seen.y(), seen.x())) - azimuth;
    add(profile, seen.norm(), amplitude * beam_gain(off.wrapped()));
  }
}

void SimpleReservoir::add_embankment(const Pose& X_WB, Angle azimuth, std::vector<double>& profile) const {
  constexpr int kRays = 9;
  const double amplitude = 2 * config_.noise_sigma * std::pow(10, config_.snr_db / 20);
  const Eigen::Vector2d p = X_WB.translation.head<2>();
  for (int i = 0; i < kRays; ++i) {
    const Angle off = Angle::degrees(kWidthDeg * (-1 + 2.0 * i / (kRays - 1)));
    const double bearing = (X_WB.rotation.heading() + azimuth + off).radians();
    const Eigen::Vector2d d(std::cos(bearing), std::sin(bearing));
    double nearest = kRange, cosine = 0;
    for (std::size_t s = 0; s + 1 < embankment().size(); ++s) {
      const auto hit = meet(p, d, embankment()[s], embankment()[s + 1]);
      if (hit && hit->first < nearest) std::tie(nearest, cosine) = *hit;
    }
    if (nearest < kRange) add(profile, nearest, amplitude * beam_gain(off) * cosine / (kRays / 3.0));
  }
}

std::optional<std::pair<Navigation, Ping>> SimpleReservoir::step() {
  const double t = ping_ * kPingInterval;
  if (t > config_.duration_s) return std::nullopt;
  const int cycle = ping_ % (2 * kSteps - 2);  // there and back, the ends once each
  const auto& fan = fans_[static_cast<std::size_t>(cycle < kSteps ? cycle : 2 * kSteps - 2 - cycle)];
  ++ping_;

  const Pose X_WB = body_at(t);
  std::vector<double> profile(kBins, 0.0);
  add_buoys(X_WB, fan->azimuth[0], profile);
  add_embankment(X_WB, fan->azimuth[0], profile);
  if (random_.uniform() < config_.spurious_share) {
    add(profile, random_.uniform(kBlindBins * kBin, kRange), 5 * config_.noise_sigma);
  }
  auto samples = std::make_shared<std::vector<std::uint8_t>>(kBins);
  for (int k = 0; k < kBins; ++k) {
    const double echo =
        config_.noise_mean + config_.noise_sigma * random_.normal() + profile[static_cast<std::size_t>(k)];
    const double ringing = k < kBlindBins ? 220 * std::exp(-k / 3.0) : 0;
    (*samples)[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(std::clamp(echo + ringing, 0.0, 255.0));
  }

  Navigation fix;
  fix.time = Time(seconds(t));
  fix.X_WB = X_WB;
  fix.v_WB = X_WB.rotation * Eigen::Vector3d(config_.speed, 0, 0);
  Ping ping;
  ping.time = fix.time;
  ping.fan = fan;
  ping.window = {0, kBin, kBins};
  ping.blanking_m = kBlindBins * kBin;
  ping.intensity = {samples->data(), SampleType::kU8, 1, kBins, kBins, 1};
  ping.storage = samples;
  return std::pair(fix, ping);
}

}  // namespace isobath::test

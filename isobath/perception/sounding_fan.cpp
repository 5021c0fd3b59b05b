#include <algorithm>
#include <cmath>
#include <isobath/base/angle.hpp>
#include <isobath/perception/sounding_fan.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kBeam = std::numbers::pi / 180;
constexpr double kRangeStep = 5, kFarthest = 500;  // m: the window reaches to a multiple of the step
constexpr int kBins = 200;
// A sounding is the strongest echo of a narrow beam, decided by the sonar. Chosen, not measured.
constexpr float kDetect = 0.7F;
constexpr double kFalse = 0.1;

}  // namespace

bool SoundingFan::update(const Swath& swath, const Pose& X_WB) {
  if (swath.frame != Swath::Frame::kBody) return false;
  gather(swath, X_WB);
  begun_ = begun_ || std::any_of(heard_.begin(), heard_.end(), [](const Heard& h) { return h.in_band; });
  if (heard_.empty() || !begun_) return false;
  fit();
  ping_.time = swath.time;
  decide();
  return true;
}

void SoundingFan::gather(const Swath& swath, const Pose& X_WB) {
  heard_.clear();
  const Rotation tilt = level(X_WB).rotation.inverse() * X_WB.rotation;  // of the body against the level frame
  for (const Sounding& s : swath.soundings) {
    if (s.kind != Sounding::Kind::kWater) continue;
    const Eigen::Vector3d p = tilt * s.point.cast<double>();
    const double range = p.head<2>().norm();
    if (!(range > 0 && range < kFarthest)) continue;
    const double off = std::abs(p.z());
    heard_.push_back(
        {std::atan2(p.y(), p.x()), range, range * std::min(1.0, band_m_ / std::max(off, 1e-9)), off <= band_m_});
  }
}

/// The fan and the window stay as they are while all soundings lie within them.
void SoundingFan::fit() {
  double first = heard_.front().azimuth, last = first, farthest = 0;
  for (const Heard& h : heard_) {
    first = std::min(first, h.azimuth);
    last = std::max(last, h.azimuth);
    farthest = std::max(farthest, h.range_m);
  }
  const bool fits = ping_.fan && first >= ping_.fan->azimuth.front().radians() - kBeam / 2 &&
                    last <= ping_.fan->azimuth.back().radians() + kBeam / 2;
  if (!fits) {
    const int from = static_cast<int>(std::floor(first / kBeam)), to = static_cast<int>(std::ceil(last / kBeam));
    auto fan = std::make_shared<BeamFan>();
    for (int k = from; k <= std::min(to, from + 359); ++k) fan->azimuth.push_back(Angle::radians(k * kBeam));
    fan->width.assign(fan->azimuth.size(), Angle::radians(kBeam));
    fan->height = Angle::degrees(2);
    ping_.fan = std::move(fan);
  }
  if (farthest <= ping_.window.end_m()) return;
  const double reach = kRangeStep * std::ceil(farthest / kRangeStep);
  ping_.window = {0, reach / kBins, kBins};
}

int SoundingFan::beam_of(double azimuth) const {
  const double first = ping_.fan->azimuth.front().radians();
  return std::clamp(static_cast<int>(std::lround((azimuth - first) / kBeam)), 0, ping_.fan->beams() - 1);
}

void SoundingFan::decide() {
  decisions_.reset(ping_.fan->beams(), kBins);
  std::fill(decisions_.p_detect.begin(), decisions_.p_detect.end(), kDetect);
  decisions_.false_alarm = kFalse;
  const auto bin_of = [&](double range_m) {
    return std::clamp(static_cast<int>(range_m / ping_.window.bin_m), 0, kBins - 1);
  };
  clear_to_.assign(static_cast<std::size_t>(ping_.fan->beams()), 0);
  for (const Heard& h : heard_) {
    const int beam = beam_of(h.azimuth);
    int& clear_to = clear_to_[static_cast<std::size_t>(beam)];
    if (h.in_band) {
      decisions_.set_hit(beam, bin_of(h.range_m));
    } else {
      clear_to = std::max(clear_to, bin_of(h.clear_m));
    }
  }
  for (int beam = 0; beam < decisions_.beams(); ++beam) {
    int nearest = 0;
    while (nearest < kBins && !decisions_.hit(beam, nearest)) ++nearest;
    const int first = nearest < kBins ? nearest : clear_to_[static_cast<std::size_t>(beam)];
    for (int bin = first; bin < kBins; ++bin) {
      if (!decisions_.hit(beam, bin)) decisions_.set_blind(beam, bin);
    }
  }
}

}  // namespace isobath

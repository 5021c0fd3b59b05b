#include <algorithm>
#include <cmath>
#include <isobath/perception/object_label.hpp>

namespace isobath {
namespace {

bool vanished(std::span<const AttributeEntry> looks, int misses) {
  int missed = 0;
  for (auto look = looks.rbegin(); look != looks.rend() && missed < misses; ++look) {
    const auto* seen = std::get_if<double>(&look->value);
    if (seen == nullptr) continue;
    if (*seen != 0) return false;
    ++missed;
  }
  return missed >= misses;
}

}  // namespace

const char* to_text(ObjectLabel label) {
  switch (label) {
    case ObjectLabel::kUnknown: return "unknown";
    case ObjectLabel::kStatic: return "static";
    case ObjectLabel::kMoving: return "moving";
    case ObjectLabel::kVanished: return "vanished";
  }
  return "";
}

ObjectLabel label_object(const ObjectLabelConfig& config, std::span<const AttributeEntry> positions,
                         std::span<const AttributeEntry> looks) {
  if (vanished(looks, config.misses)) return ObjectLabel::kVanished;
  double n = 0, t_mean = 0;
  Eigen::Vector3d p_mean = Eigen::Vector3d::Zero();
  const auto each = [&](const auto& act) {
    for (const AttributeEntry& e : positions) {
      if (const auto* p = std::get_if<Eigen::Vector3d>(&e.value))
        act(to_seconds(e.time) - to_seconds(positions.back().time), *p);
    }
  };
  each([&](double t, const Eigen::Vector3d& p) {
    ++n;
    t_mean += t;
    p_mean += p;
  });
  if (n < 3) return ObjectLabel::kUnknown;
  t_mean /= n;
  p_mean /= n;
  double tt = 0;
  Eigen::Vector3d tp = Eigen::Vector3d::Zero();
  each([&](double t, const Eigen::Vector3d& p) {
    tt += (t - t_mean) * (t - t_mean);
    tp += (t - t_mean) * (p - p_mean);
  });
  if (!(tt > 0)) return ObjectLabel::kUnknown;
  const Eigen::Vector3d v = tp / tt;
  double left = 0;
  each([&](double t, const Eigen::Vector3d& p) { left += (p - p_mean - (t - t_mean) * v).squaredNorm(); });
  const double variance = std::max(config.position_sigma * config.position_sigma, left / (3 * n - 6));
  const bool moves = v.squaredNorm() * tt / variance > config.moving_gate && v.norm() >= config.min_speed;
  return moves ? ObjectLabel::kMoving : ObjectLabel::kStatic;
}

}  // namespace isobath

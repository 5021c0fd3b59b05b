#include <algorithm>
#include <cmath>
#include <isobath/studies/opening_map.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kWaterVoxel = 1;  // m, of a voxel
constexpr double kMaxEcho = 1.9;   // log-odds of an echo: one image alone, of two fans, makes no voxel occupied

}  // namespace

std::vector<Field> fields(FanEchoes& e) {
  return {Field::real("p_detect", &e.p_detect, {0.01, 0.99}, "",
                      "Probability that a look of a fan at a rock gives an echo."),
          Field::real("false_alarm", &e.false_alarm, {0, 0.5}, "", "Probability that a look at water gives an echo."),
          Field::integer("seed", &e.seed, {0, 1000000000}, "", "Seed of the echoes.")};
}

OpeningMap::OpeningMap(const Opening& opening, const Vector3d& start_W, const FanPair& fans, const FanEchoes& echoes,
                       const std::optional<Rock>& rock)
    : fans_(fans),
      echoes_(echoes),
      rock_(rock),
      map_({kWaterVoxel, 0.5, 0.98, 0.2, 6.9}),
      random_(static_cast<std::uint64_t>(echoes.seed)) {
  const Pose& X_WO = opening.X_WO;
  const double from_m = (X_WO.translation - start_W).norm();
  water_ = {{X_WO.rotation, start_W + X_WO.rotation * Vector3d(from_m / 2, 0, 0)},
            {from_m, opening.width_m, opening.height_m}};
  face_ = {{X_WO.rotation, X_WO * Vector3d(-kWaterVoxel / 2, 0, 0)}, {kWaterVoxel, opening.width_m, opening.height_m}};
}

/// Whether a rock stands between the sonar and a point.
bool OpeningMap::is_hidden(const Vector3d& sonar_W, const Vector3d& p_W) const {
  const Vector3d line = p_W - sonar_W;
  const double far = line.norm();
  const double before = (rock_->p_W - sonar_W).dot(line) / far;  // where the line passes the rock's centre
  if (before <= 0 || before >= far - rock_->radius_m) return false;
  return (sonar_W + line * before / far - rock_->p_W).norm() < rock_->radius_m;
}

void OpeningMap::look(const Pose& X_WB) {
  const Pose X_BW = X_WB.inverse();
  const double p_detect = echoes_.p_detect, false_alarm = echoes_.false_alarm;
  const LogOdds16 echo = to_evidence(std::min(kMaxEcho, std::log(p_detect / false_alarm)));
  const LogOdds16 silence = to_evidence(std::log((1 - p_detect) / (1 - false_alarm)));
  VoxelBlocks* layers[] = {&map_.layer("horizontal"), &map_.layer("vertical")};
  for_each_voxel(map_, water_, [&](const VoxelIndex& v) {
    const Vector3d p_W = map_.centre_of(v), u_B = X_BW * p_W;
    if (u_B.norm() > fans_.range_m || !in_horizontal_fan(fans_, u_B) || !in_vertical_fan(fans_, u_B)) return;
    if (rock_ && is_hidden(X_WB.translation, p_W)) return;
    const bool solid = rock_ && (p_W - rock_->p_W).norm() <= rock_->radius_m + kWaterVoxel / 2;
    const double p_echo = solid ? p_detect : false_alarm;
    for (VoxelBlocks* layer : layers) layer->add(v, p_echo > 0 && random_.uniform() < p_echo ? echo : silence);
  });
}

}  // namespace isobath

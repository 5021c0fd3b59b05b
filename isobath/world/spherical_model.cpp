#include <algorithm>
#include <cmath>
#include <isobath/world/spherical_model.hpp>

namespace isobath {
namespace {

constexpr Angle kSoundingWidth = Angle::degrees(2.5);  // of a beam, where the sonar does not state it

SphericalModelConfig resolved(SphericalModelConfig config) {
  if (config.sonar.empty()) return config;
  const SphericalGridConfig grid = grid_for(listed_resolution(config.sonar));
  config.grid.range_m = grid.range_m;
  config.grid.min_layer_m = grid.min_layer_m;
  config.grid.bucket = grid.bucket;
  return config;
}

}  // namespace

std::vector<Field> fields(SphericalModelConfig& c) {
  std::vector<Field> all{
      Field::flag("keep", &c.keep, "Whether echoes are kept by direction and range around the vehicle."),
      Field::text("sonar", &c.sonar,
                  "Range, layers and directions of a listed sonar: em_1000_shallow, wesmar_ss150 or simulated_2_5. "
                  "Empty: those below."),
  };
  for (Field& field : fields(c.grid)) all.push_back(std::move(field));
  for (Field& field : fields(c.mapper)) all.push_back(std::move(field));
  return all;
}

SphericalModel::SphericalModel(const SphericalModelConfig& config)
    : config_(resolved(config)), grid_(config_.grid), mapper_(config_.mapper, grid_), snapshots_(config_.grid) {}

Pose SphericalModel::without_jumps(const Pose& X_WB) const { return {X_WB.rotation, X_WB.translation - jumped_}; }

void SphericalModel::note(Time time, const Pose& X_WB) {
  last_ = time;
  X_WB_ = X_WB;
  // Sensors tell of different times in turn. A time before the scan began is that of a clock that was set back.
  if (!std::exchange(scanning_, true) || time < scan_began_) scan_began_ = time;
  if (time - scan_began_ >= kScan) end_scan();
}

void SphericalModel::end_scan() {
  if (!std::exchange(scanning_, false)) return;
  ++counts_.scans;
  snapshots_.publish(grid_, last_, X_WB_);
  mapper_.begin_scan();
}

void SphericalModel::compare(const SonarResolution& sonar) {
  if (counts_.coarser.empty()) counts_.coarser = coarser_than_sonar(grid_.config(), sonar);
}

void SphericalModel::update(const PosedPing& posed) {
  if (!config_.keep) return;
  const Ping& ping = posed.ping;
  const auto& azimuth = ping.fan->azimuth;
  const Angle spacing = azimuth.size() > 1 ? abs(azimuth[1] - azimuth[0]) : ping.fan->width[0];
  compare({{}, ping.window.end_m(), ping.window.bin_m, ping.fan->width[0], spacing, ping.fan->beams()});
  ++counts_.pings;
  mapper_.update(ping, posed.decisions, without_jumps(posed.X_WB));
  note(ping.time, posed.X_WB);
}

void SphericalModel::update(const RangeReading& reading, const Pose& X_WB) {
  if (!config_.keep) return;
  ++counts_.ranges;
  mapper_.update(reading, without_jumps(X_WB));
  note(reading.time, X_WB);
}

/// The nearest of the soundings in one direction counts.
void SphericalModel::update(const Swath& swath, const Pose& X_WB) {
  if (!config_.keep || swath.frame != Swath::Frame::kBody || swath.is_flat() || swath.soundings.empty()) return;
  mapper_.move_to(without_jumps(X_WB), swath.time);
  nearest_.clear();
  for (const Sounding& s : swath.soundings) {
    if (s.point.squaredNorm() == 0) continue;
    const SphericalDirection d =
        grid_.direction_of(mapper_.to_grid(X_WB.rotation * s.point.cast<double>()).normalized());
    const auto key = static_cast<std::uint32_t>(d.azimuth * grid_.buckets().elevations() + d.elevation);
    const Sounding*& nearest = nearest_[key];
    if (!nearest || s.range_m < nearest->range_m) nearest = &s;
  }
  chosen_.clear();
  for (const auto& [direction, sounding] : nearest_) chosen_.push_back(sounding);
  std::sort(chosen_.begin(),
            chosen_.end());  // in the order of the swath, so that the grid does not depend on the table
  const Angle width = swath.beam_width > Angle{} ? swath.beam_width : kSoundingWidth;
  for (const Sounding* s : chosen_) {
    const Eigen::Vector3d p_B = s->point.cast<double>();
    const double far = p_B.norm();
    mapper_.add({Eigen::Vector3d::Zero(), mapper_.to_grid(X_WB.rotation * (p_B / far)), width, far,
                 static_cast<double>(s->range_m), swath.time, static_cast<double>(s->sigma_range_m)});
  }
  ++counts_.swaths;
  note(swath.time, X_WB);
}

SphericalOutcome SphericalModel::outcome(double radius_m) const {
  SphericalOutcome outcome = counts_;
  outcome.range_m = grid_.config().range_m;
  outcome.bytes = grid_.bytes();
  grid_.cells().each_beam([&](const SphericalDirection&, std::span<const SphericalCell> beam) {
    for (const SphericalCell& cell : beam) {
      ++outcome.cells;
      outcome.locked += cell.locked ? 1 : 0;
      outcome.occupied += static_cast<double>(cell.log_odds) >= grid_.occupied_log_odds() ? 1 : 0;
    }
  });
  const int around = static_cast<int>(std::lround(360 / grid_.buckets().step().degrees()));
  int empty = 0;
  for (int i = 0; i < around; ++i) {
    const Angle azimuth = grid_.buckets().step() * (i + 0.5);
    empty += grid_.is_empty({cos(azimuth), sin(azimuth), 0}) ? 1 : 0;
  }
  outcome.empty_directions = static_cast<double>(empty) / around;
  const Eigen::Vector3d ahead = level(X_WB_).rotation * Eigen::Vector3d::UnitX();
  outcome.ahead = way_ahead(grid_, mapper_.to_grid(ahead), grid_.config().range_m, radius_m);
  return outcome;
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/round_step.hpp>
#include <isobath/io/exports/voxel_vdb.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <isobath/sonar/fan_stance.hpp>
#include <isobath/world/voxel_model.hpp>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace isobath {
namespace {

constexpr const char* kSoundings = "soundings";  ///< layer of soundings, which have a height of their own
/// Two fans whose sizes differ by less than this share are of one sonar, which steers its beams anew for each ping.
constexpr double kAlike = 0.5;
constexpr double kSameHeading_deg = 15, kSameMount_m = 0.5;
constexpr double kSteep = 0.5;  // level part of an axis that is too steep to have a heading
// Log-odds of a sounding, which the sonar itself has picked as the strongest echo of a narrow beam: two soundings are
// enough for an occupied voxel even with a low prior (0.05). Chosen, not measured.
constexpr double kSoundingHit = 1.5, kSoundingMiss = -0.5;
constexpr double kVoxelsOfRange = 200;      // from a sonar to the end of its range
constexpr double kSureSigmas = 2;           // so far before its end the ray of a sounding shows that the water is free
constexpr double kFarthestSounding = 4096;  // voxels: a swath that long fills some hundred megabytes

constexpr const char* kTooFarOff = "too far from the origin for voxels of this size";
constexpr const char* kLongSounding = "soundings of more than 4096 voxels";

constexpr Duration kHeldFor = std::chrono::minutes(2), kNoted = std::chrono::seconds(1);

/// Edge of voxels that hold the ends of most rays: the median standard deviation of the ranges. 0: they state none.
double edge_for(const Swath& swath) {
  std::vector<double> sigmas;
  for (const Sounding& s : swath.soundings) sigmas.push_back(static_cast<double>(s.sigma_range_m));
  const auto middle = sigmas.begin() + static_cast<std::ptrdiff_t>(sigmas.size() / 2);
  std::nth_element(sigmas.begin(), middle, sigmas.end());
  return *middle > 0 ? round_step(*middle, {1, 2.5, 5}) : 0;
}

/// Probability that a range with this standard deviation ends within half a voxel of where it is measured.
double share_in_voxel(double edge, double sigma_m) {
  return sigma_m > 0 ? std::erf(edge / (2 * std::numbers::sqrt2 * sigma_m)) : 1;
}

/// Whether a map with such voxels covers everything within `range_m` of a position.
bool holds(double voxel_m, const Eigen::Vector3d& p_W, double range_m) {
  return p_W.cwiseAbs().maxCoeff() + range_m < (VoxelBlocks::kFarthest - 1) * voxel_m;
}

}  // namespace

std::vector<Field> fields(VoxelModelConfig& c) {
  using Sonars = VoxelModelConfig::Sonars;
  std::vector<Field> all{
      Field::choice("sonars", &c.sonars, {{"none", Sonars::kNone}, {"fans", Sonars::kFans}, {"all", Sonars::kAll}},
                    "Sonars that are mapped: none, those with several beams (fans), or all."),
      Field::flag("fit", &c.fit,
                  "The edge of the voxels follows from the sonar's range, about 200 of them; false: it is voxel_m."),
      Field::flag("surface", &c.surface,
                  "A sonar below the datum is below the water surface: there is no water above the datum."),
      Field::real("window_m", &c.window_m, {0, 100'000}, "m",
                  "Voxels farther from the vehicle than this, along north, east or down, are forgotten; 0: none are."),
      Field::flag("spill", &c.spill,
                  "Voxels that leave the window go to voxels.sqlite and can come back; false: they are forgotten."),
      Field::integer("memory_mb", &c.memory_mb, {0, 1'000'000}, "MB",
                     "Maximum memory of the voxels; beyond it, those that changed longest ago go to voxels.sqlite. "
                     "0: no bound."),
      Field::flag("vdb", &c.vdb,
                  "Also writes voxels.vdb, a grid for readers of OpenVDB, if the program was built with OpenVDB."),
  };
  for (Field& field : fields(c.map)) all.push_back(std::move(field));
  return all;
}

VoxelModel::VoxelModel(const VoxelModelConfig& config, std::filesystem::path spill_file)
    : config_(config), spill_file_(std::move(spill_file)) {
  if (!config.vdb || has_openvdb()) return;
  throw Error("this program was built without OpenVDB, or isobath_vdb.so is not found", {{}, {}, {}, {}, "voxels.vdb"},
              "false", kVdbRemedy);
}

double VoxelModel::voxel_for(double range_m) const {
  if (map_) return map_->voxel_m();
  return config_.fit ? round_step(range_m / kVoxelsOfRange, {1, 2.5, 5}) : config_.map.voxel_m;
}

void VoxelModel::begin(double range_m) {
  config_.map.voxel_m = voxel_for(range_m);
  map_ = std::make_unique<VoxelMap>(config_.map);
  if (config_.memory_mb > 0 || (config_.window_m > 0 && config_.spill)) map_->spill_to(spill_file_);
}

VoxelModel::Sonar& VoxelModel::sonar_of(const Ping& ping) {
  const BeamFan& fan = *ping.fan;
  const bool flat = lies_flat(ping);
  const Angle span = fan.azimuth.back() - fan.azimuth.front();
  const auto near = [](Angle a, Angle b) {
    return std::abs(a.radians() - b.radians()) <= kAlike * std::max(a.radians(), b.radians());
  };
  const Eigen::Vector2d axis_B = (ping.X_BS.rotation * Eigen::Vector3d::UnitX()).head<2>();
  const Eigen::Vector3d& at_B = ping.X_BS.translation;
  const auto same_heading = [&](const Eigen::Vector2d& other) {
    if (std::min(axis_B.norm(), other.norm()) < kSteep) return true;
    return axis_B.dot(other) >= cos(Angle::degrees(kSameHeading_deg)) * axis_B.norm() * other.norm();
  };
  int alike = 1;
  for (const auto& s : sonars_) {
    if (s->flat != flat) continue;
    const bool same_fan = near(s->width, fan.width.front()) && near(s->height, fan.height) && near(s->span, span);
    const bool same_mount = same_heading(s->axis_B) && (s->at_B - at_B).norm() <= kSameMount_m;
    if (s->beams == fan.beams() && same_fan && same_mount) return *s;
    ++alike;
  }
  std::string name = flat ? "flat" : "upright";
  if (alike > 1) name += fmt::format(" {}", alike);
  VoxelBlocks& layer = map_->layer(name);
  sonars_.push_back(std::make_unique<Sonar>(
      Sonar{name, flat, fan.beams(), fan.width.front(), fan.height, span, axis_B, at_B, 0,
            FanMapper(config_.fans, config_.map.voxel_m, log_odds_of(config_.map.prior)), &layer}));
  return *sonars_.back();
}

void VoxelModel::update(const PosedPing& posed) {
  using Sonars = VoxelModelConfig::Sonars;
  const Ping& ping = posed.look_ping();
  if (config_.sonars == Sonars::kNone || (config_.sonars == Sonars::kFans && ping.fan->beams() < 2)) return;
  if (config_.window_m > 0 && config_.window_m < ping.window.end_m()) {
    throw Error(
        fmt::format("the map's window reaches {:g} m, and the sonar {:g} m", config_.window_m, ping.window.end_m()),
        {{}, {}, {}, {}, "voxels.window_m"}, "0, or at least the sonar's range");
  }
  const double range_m = ping.window.end_m(), voxel_m = voxel_for(range_m);
  const char* fault = FanMapper::fault_of(ping, voxel_m);
  const double about_m = std::max(range_m, config_.window_m) + ping.X_BS.translation.norm();
  if (!fault && !holds(voxel_m, posed.X_WB.translation, about_m)) fault = kTooFarOff;
  if (fault) {
    ++refused_[fault];
    return;
  }
  if (!map_) begin(range_m);
  Sonar& sonar = sonar_of(ping);
  note(ping.time);
  const bool submerged = config_.surface && (posed.X_WB * ping.X_BS).translation.z() > 0;
  sonar.mapper.set_surface(submerged ? 0 : -std::numeric_limits<double>::infinity());
  sonar.mapper.update(ping, posed.look_decisions(), posed.X_WB, *sonar.layer);
  ++sonar.pings;
  move_to(posed.X_WB.translation);
}

void VoxelModel::update(const Swath& swath, const Pose& X_WB) {
  if (config_.sonars == VoxelModelConfig::Sonars::kNone || swath.frame != Swath::Frame::kBody || swath.is_flat())
    return;
  double farthest = 0;
  for (const Sounding& s : swath.soundings) {
    if (s.kind == Sounding::Kind::kWater) farthest = std::max<double>(farthest, s.range_m);
  }
  if (farthest == 0) return;
  const double edge = map_ || !config_.fit ? voxel_for(farthest) : std::max(voxel_for(farthest), edge_for(swath));
  if (!holds(edge, X_WB.translation, config_.window_m)) {
    ++refused_[kTooFarOff];
    return;
  }
  if (!map_) begin(edge * kVoxelsOfRange);
  note(swath.time);
  VoxelBlocks& layer = map_->layer(kSoundings);
  const LogOdds16 miss = to_evidence(kSoundingMiss);
  VoxelBlocks met;  // voxels of this swath: negative where rays pass, the evidence of the surest end where any ends
  std::vector<std::pair<VoxelIndex, LogOdds16>> ends;
  for (const Sounding& s : swath.soundings) {
    const Eigen::Vector3d p_B = s.point.cast<double>(), to = X_WB * p_B / edge;
    const double far = p_B.norm();
    if (s.kind != Sounding::Kind::kWater || far <= 0) continue;
    if (!(far < kFarthestSounding * edge && s.range_m < kFarthestSounding * edge)) {
      ++refused_[kLongSounding];
      continue;
    }
    if (to.cwiseAbs().maxCoeff() >= VoxelBlocks::kFarthest - 1) continue;
    const double sure_m = std::max(0.0, s.range_m - kSureSigmas * static_cast<double>(s.sigma_range_m));
    const Eigen::Vector3d from_B = p_B * (1 - s.range_m / far);
    met.insert_ray(X_WB * from_B / edge, X_WB * Eigen::Vector3d(from_B + p_B * (sure_m / far)) / edge, -1, 0);
    const double hit = kSoundingHit * share_in_voxel(edge, static_cast<double>(s.sigma_range_m));
    ends.emplace_back(floor_of(to), std::max(to_evidence(hit), LogOdds16{1}));
  }
  for (const auto& [v, hit] : ends) {
    LogOdds16& at = met.touch(v)[VoxelBlocks::offset(v)];
    at = at == kUnseen ? hit : std::max(at, hit);
  }
  met.for_each(0, [&](const VoxelBlocks::Block& block) {
    LogOdds16* evidence = layer.touch(block.corner);
    for (int i = 0; i < VoxelBlocks::kVolume; ++i) {
      if (block.evidence[i] != kUnseen)
        evidence[i] = layer.sum(evidence[i], block.evidence[i] > 0 ? block.evidence[i] : miss);
    }
  });
  ++shots_;
  move_to(X_WB.translation);
}

/// Begins a new revision for the evidence from now on, and notes its time.
void VoxelModel::note(Time time) {
  const std::uint64_t before = map_->revision();
  map_->advance();
  if (!heard_.empty() && time < heard_.back().time) heard_.clear();  // the clock was set back
  if (heard_.empty() || time - heard_.back().time >= kNoted) heard_.push_back({time, before});
  while (time - heard_.front().time > kHeldFor) heard_.pop_front();
}

void VoxelModel::move_along(const Eigen::Vector3d& jump_W) {
  if (!map_) return;
  constexpr double kOutOfTheMap = 2.0 * VoxelBlocks::kFarthest;
  const Eigen::Array3d voxels = (jump_W / map_->voxel_m()).array().max(-kOutOfTheMap).min(kOutOfTheMap);
  const std::uint64_t held = heard_.empty() ? map_->revision() : heard_.front().revision;
  map_->advance();
  map_->move(floor_of(voxels + 0.5), std::min(held, last_moved_));
  for (const auto& s : sonars_) s->mapper.move_along(jump_W);
  last_moved_ = map_->revision();
  ++moved_;
}

void VoxelModel::move_to(const Eigen::Vector3d& at_W) {
  vehicle_depth_m_ = at_W.z();
  const Eigen::Vector3d window = Eigen::Vector3d::Constant(config_.window_m);
  if (config_.window_m > 0 && config_.spill) {
    map_->spill_outside(at_W, window);
  } else if (config_.window_m > 0) {
    map_->keep_within(at_W, window);
  }
  if (config_.memory_mb > 0) map_->spill_beyond(static_cast<std::size_t>(config_.memory_mb) * 1'000'000);
}

bool VoxelModel::save() const {
  if (!map_ || !map_->spills()) return false;
  map_->save();
  return true;
}

VoxelOutcome VoxelModel::outcome() const {
  VoxelOutcome outcome;
  if (!map_) return outcome;
  outcome.voxel_m = map_->voxel_m();
  outcome.vehicle_depth_m = vehicle_depth_m_;
  outcome.megabytes = map_->bytes() / 1'000'000;
  for (const auto& s : sonars_) outcome.layers.push_back({s->name, s->pings});
  if (shots_ > 0) outcome.layers.push_back({kSoundings, shots_});
  outcome.blocks = map_->changed_after(0).size();
  outcome.moved = moved_;
  if (map_->spills()) outcome.spilled = map_->spilled();
  for_each_seen(*map_, [&](const VoxelIndex& v) {
    ++outcome.seen;
    const Space space = map_->space(v);
    outcome.occupied += space == Space::kOccupied ? 1 : 0;
    outcome.free += space == Space::kFree ? 1 : 0;
  });
  return outcome;
}

std::vector<std::string> VoxelModel::height_layers() const {
  std::vector<std::string> names;
  for (const auto& s : sonars_) {
    if (!s->flat) names.push_back(s->name);
  }
  if (shots_ > 0) names.push_back(kSoundings);
  return names;
}

std::vector<ColumnTop> VoxelModel::tops() const {
  std::vector<ColumnTop> tops;
  if (!map_ || height_layers().empty()) return tops;
  const auto less = [](const VoxelIndex& a, const VoxelIndex& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::vector<VoxelIndex> solid;
  for_each_seen(*map_, [&](const VoxelIndex& v) {
    if (map_->space(v) == Space::kOccupied) solid.push_back(v);
  });
  std::sort(solid.begin(), solid.end(), less);
  const auto index_of = [&](const VoxelIndex& v) {
    const auto found = std::lower_bound(solid.begin(), solid.end(), v, less);
    return found != solid.end() && *found == v ? found - solid.begin() : -1;
  };
  // Bodies of voxels that touch, corners included.
  std::vector<std::uint8_t> met(solid.size(), 0), large(solid.size(), 0);
  std::vector<std::size_t> body;
  for (std::size_t first = 0; first < solid.size(); ++first) {
    if (met[first] != 0) continue;
    met[first] = 1;
    body.assign(1, first);
    for (std::size_t k = 0; k < body.size(); ++k) {
      for (int i = 0; i < 27; ++i) {
        const auto next = index_of(solid[body[k]] + VoxelIndex(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1));
        if (next < 0 || std::exchange(met[static_cast<std::size_t>(next)], 1) != 0) continue;
        body.push_back(static_cast<std::size_t>(next));
      }
    }
    if (body.size() < kSmallestBody) continue;
    for (const std::size_t k : body) large[k] = 1;
  }
  // In order of x, y, z the first of a column is the highest.
  const VoxelIndex* last = nullptr;
  for (std::size_t k = 0; k < solid.size(); ++k) {
    if (large[k] == 0 || (last && last->head<2>() == solid[k].head<2>())) continue;
    last = &solid[k];
    const Eigen::Vector3d centre = map_->centre_of(solid[k]);
    tops.push_back({centre.head<2>(), centre.z() - map_->voxel_m() / 2});
  }
  return tops;
}

std::shared_ptr<const OccupancySnapshot> VoxelModel::space_around(const ScanResult& scan, double reach_m) {
  const std::vector<std::string> heights = height_layers();
  std::uint64_t told = shots_;
  for (const auto& s : sonars_) told += s->flat ? 0 : s->pings;
  const Eigen::Vector3d& centre = scan.detection.X_WB.translation;
  if (told == heights_told_ || !scan.posed || centre.cwiseAbs().maxCoeff() + reach_m > map_->reach_m()) return nullptr;
  heights_told_ = told;
  return std::make_shared<const OccupancySnapshot>(*map_, heights, centre, reach_m);
}

}  // namespace isobath

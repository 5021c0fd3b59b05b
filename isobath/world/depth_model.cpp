#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/perception/depth_update.hpp>
#include <isobath/world/depth_model.hpp>
#include <isobath/world/map_features.hpp>
#include <map>
#include <utility>

namespace isobath {
namespace {

constexpr Duration kTrackGap = std::chrono::seconds(10);
constexpr double kTrackStep = 1;  // m between the points of a track

}  // namespace

DepthModel::DepthModel(const WorldConfiguration& configuration, const std::filesystem::path& folder,
                       std::string settings)
    : configuration_(configuration), settings_(std::move(settings)), learning_(configuration.depth.evidence) {
  fill_level();
  if (folder.empty()) return;
  folder_ = std::make_unique<MapFolder>(folder);
  if (!folder_->holds_map()) return;
  stored_.emplace(folder_->open());
  facts_ = stored_->facts;
  damages_ = stored_->damages;
}

DepthModel::~DepthModel() = default;

std::optional<GeoOrigin> DepthModel::stored_origin() const { return continues() ? facts_.origin : std::nullopt; }

/// At the first positioned reading, which fixes where and when the map begins.
void DepthModel::begin(Time time, const Pose& X_WB) {
  const Eigen::Vector2d start = X_WB.translation.head<2>();
  DepthMapConfig& config = configuration_.depth_map;
  if (stored_) {
    if (facts_.origin.has_value() != origin_.has_value()) {
      throw Error(facts_.origin ? "the input has no geographic origin, and the map has one"
                                : "the map has no geographic origin, and the input has one",
                  {folder_->path().string()}, {}, "use another folder for --map");
    }
    refuse_far(start);
    config.pixel_m = facts_.area.grid.pixel_m;
    map_ = std::make_unique<DepthMap>(config, facts_.area, std::move(stored_->trees), start);
    stored_.reset();
    continued_ = true;
  } else {
    facts_.origin = origin_;
    facts_.area = area_of(config);
    facts_.epoch = time;
    facts_.datum = configuration_.prior.datum;
    prior_ = prior_files_.empty()
                 ? DepthPrior{}
                 : read_depth_prior(prior_files_, configuration_.prior, configuration_.depth, facts_.area, origin_);
    facts_.priors = prior_.sources;
    if (folder_) std::filesystem::remove(folder_->objects_file());  // of a map that was never committed
    if (folder_ && !prior_.files.empty()) {
      ObjectStore objects(folder_->objects_file());
      store_features(objects, prior_.files, time);
    }
    map_ = std::make_unique<DepthMap>(config, facts_.area, prior_.trees(facts_.area.levels), start);
  }
  mapper_ = std::make_unique<DepthMapper>(*map_, configuration_.depth, facts_.epoch);
  prediction_ = std::make_unique<MapPrediction>(configuration_.depth.evidence, map_->grid());
  evaluator_ = std::make_unique<StateEvaluator>(configuration_.state, WorldLevel::watched(), time);
}

/// A run may begin outside the area, but not farther away than the area is wide: then the map is the wrong one.
void DepthModel::refuse_far(const Eigen::Vector2d& start) const {
  const DepthArea& area = facts_.area;
  const Eigen::AlignedBox2d covered = box_of(area);
  const double side = covered.sizes().x();
  const double away = covered.exteriorDistance(start);
  if (away <= side) return;
  throw Error(fmt::format("the input begins {:.0f} km from the area of the map, which is {:.0f} km wide", away / 1000,
                          side / 1000),
              {folder_->path().string()}, {}, "use another folder for --map");
}

// The six parts ------------------------------------------------------------------------------------------------------

void DepthModel::fill_level() {
  level_.update = [this](const LevelInput& input) { write(input); };
  level_.serve = [this] { return map_ ? map_->snapshot() : nullptr; };
  level_.predict = [this](const RangeReading& reading, const Pose& X_WB) {
    return prediction_ ? (*prediction_)(map_->window(), reading, X_WB) : std::nullopt;
  };
  level_.learn = [this](const RangeReading& reading, const auto& expected) { learning_(reading, expected); };
  level_.evaluate = [this](Time now, unsigned worked) { return watch(now, worked); };
  level_.store = [this](const MapVisit& visit) { keep(visit); };
}

void DepthModel::write(const LevelInput& input) {
  if (input.range) return mapper_->update(*input.range, input.pose.X_WB, input.pose.sigma_m);
  if (input.swath) return mapper_->update(*input.swath, input.pose.X_WB, input.pose.sigma_m);
  mapper_->passed(input.time, input.pose.X_WB);
}

std::span<const ModuleStatus> DepthModel::watch(Time now, unsigned worked) {
  if (!evaluator_) return {};
  for (std::size_t part = 0; part < WorldLevel::watched().size(); ++part) {
    if ((worked >> part & 1U) != 0) evaluator_->beat(part, now);
  }
  return evaluator_->evaluate(now, flags_);
}

/// Commits the trees first: an object that they do not hold would count as gone.
void DepthModel::keep(const MapVisit& visit) {
  facts_.visits.push_back(visit);
  facts_.configuration = settings_;
  folder_->commit(facts_, map_->trees());
  if (changes_.obstacles() == 0 && !std::filesystem::exists(folder_->objects_file())) return;
  ObjectStore objects(folder_->objects_file());
  found_ = store_found(objects, changes_, facts_, *last_);
}

// Readings -----------------------------------------------------------------------------------------------------------

void DepthModel::on_range(const RangeReading& reading, const PoseEstimate& pose) {
  if (!mapper_) begin(reading.time, pose.X_WB);
  if (!first_) first_ = reading.time;
  last_ = reading.time;
  // No BeamCone: readings are not checked yet, and it takes no cone of a half-space.
  const double down = (pose.X_WB.rotation * (reading.X_BS.rotation * Eigen::Vector3d::UnitX())).z();
  if (std::abs(down) < std::cos(configuration_.depth.evidence.depth_within.radians())) looked_ahead_ = reading.time;
  level_.on_input({reading.time, pose, &reading, nullptr});
}

void DepthModel::on_swath(const Swath& swath, const PoseEstimate& pose) {
  if (!mapper_) begin(swath.time, pose.X_WB);
  if (!first_) first_ = swath.time;
  last_ = swath.time;
  level_.on_input({swath.time, pose, nullptr, &swath});
}

void DepthModel::on_passage(Time time, const Pose& X_WB) {
  const Eigen::Vector2d place = X_WB.translation.head<2>();
  const bool gap = !last_passage_ || time - *last_passage_ > kTrackGap || time < *last_passage_;
  last_passage_ = time;
  if (gap) tracks_.push_back({place});
  if ((place - tracks_.back().back()).norm() >= kTrackStep) tracks_.back().push_back(place);
  if (mapper_) level_.on_input({time, {X_WB, 0}, nullptr, nullptr});
}

std::optional<double> DepthModel::bottom_depth(const Eigen::Vector2d& north_east) const {
  if (!map_) return std::nullopt;
  const Pixel place = map_->grid().at(north_east);
  if (!map_->window().extent().contains(place)) return std::nullopt;
  const DepthPixel& pixel = map_->window().at(place);
  return vouched(pixel) ? std::optional(pixel.depth_m()) : std::nullopt;
}

/// A sounding says where the bottom is, not what stands between it and the vehicle. A path that is clear by soundings
/// must not lead through a wall that the voxels show.
void DepthModel::raise(std::span<const ColumnTop> tops) {
  const auto before = map_->snapshot();
  const std::uint32_t minute = DepthMapper::minute_of(*last_, facts_.epoch);
  const auto as_word = [](double depth_m) { return DepthPixel::word_of_depth(std::clamp(depth_m, -1e6, 1e6)); };
  std::map<std::array<std::int32_t, 4>, double> shallowest;  // by tile and pixel, as DepthMap::write has it easiest
  for (const ColumnTop& top : tops) {
    const Pixel pixel = map_->grid().at(top.north_east);
    const Pixel tile = DepthWindow::tile_of(pixel);
    const auto [at, is_new] = shallowest.try_emplace({tile.row, tile.column, pixel.row, pixel.column}, top.depth_m);
    if (!is_new) at->second = std::min(at->second, top.depth_m);
  }
  std::vector<std::pair<Pixel, DepthPixel>> raised;
  const int sensor = configuration_.depth.rules.base_sensor;
  for (const auto& [place, depth_m] : shallowest) {
    const Pixel pixel{place[3], place[2]};
    const DepthPixel was = before->at(pixel);
    if (was.known() && !(depth_m < was.depth_m() - configuration_.depth.evidence.margin_m)) continue;
    const unsigned flags = (was.flags() & kTrack) | kSensed | kSeenByObstacle;
    raised.push_back({pixel, {as_word(depth_m), DepthPixel::word_of_state(sensor, flags, minute)}});
  }
  map_->write(raised);
}

void DepthModel::finish(std::span<const ColumnTop> tops) {
  if (!mapper_) return;
  mapper_->finish();
  facts_.revisits += mapper_->revisits();
  if (!tops.empty() && last_) raise(tops);
  map_->flush();
  changes_ = find_changes(map_->trees(), map_->grid(), configuration_.depth.evidence.margin_m);
}

void DepthModel::commit(const std::string& input, const std::string& fingerprint) {
  if (!folder_ || !mapper_ || !level_.store) return;
  const DepthCounts& n = mapper_->counts();
  level_.store({input, *first_, *last_, {{"range readings", n.readings}, {"soundings", n.soundings}}, fingerprint});
}

const DepthCounts& DepthModel::counts() const {
  static const DepthCounts kNone;
  return mapper_ ? mapper_->counts() : kNone;
}

}  // namespace isobath

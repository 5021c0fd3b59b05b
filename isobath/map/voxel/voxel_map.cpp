#include <algorithm>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/map/occupancy/body_grid.hpp>
#include <isobath/map/voxel/voxel_file.hpp>
#include <isobath/map/voxel/voxel_map.hpp>
#include <limits>
#include <tuple>

namespace isobath {
namespace {

int steps(double log_odds) { return static_cast<int>(std::lround(log_odds / kEvidenceUnit)); }

}  // namespace

std::vector<Field> fields(VoxelMapConfig& c) {
  return {
      Field::real("voxel_m", &c.voxel_m, {0.01, 10}, "m", "Edge of a voxel."),
      Field::real("prior", &c.prior, {0.001, 0.999}, "1", "Probability that an unseen voxel is occupied."),
      Field::real("occupied", &c.occupied, {0.05, 0.9999}, "1", "A voxel of at least this probability is occupied."),
      Field::real("free", &c.free, {0.0001, 0.5}, "1", "A voxel of at most this probability is free."),
      Field::real("max_log_odds", &c.max_log_odds, {1, 30}, "1",
                  "Maximum log-odds from one sensor: 6.9 is a probability of 0.001 or 0.999 on even odds.")
          .was("most_log_odds"),
  };
}

VoxelMap::VoxelMap(const VoxelMapConfig& config) : config_(config) {
  const auto refuse = [](const char* key, const char* problem, const char* allowed) {
    Place place;
    place.key = key;
    throw Error(problem, place, allowed);
  };
  if (!(config.voxel_m > 0)) refuse("voxel_m", "a voxel needs a size", "above 0 m");
  if (!(config.prior > 0 && config.prior < 1)) refuse("prior", "a prior of 0 or 1 cannot change", "between 0 and 1");
  if (!(config.free > 0 && config.free < config.occupied && config.occupied < 1)) {
    refuse("free", "free and occupied overlap", "0 < free < occupied < 1");
  }
  if (!(config.max_log_odds > 0 && config.max_log_odds <= 31)) refuse("max_log_odds", "out of range", "0 .. 31");
  prior_ = steps(log_odds_of(config.prior));
  occupied_from_ = steps(log_odds_of(config.occupied));
  free_to_ = steps(log_odds_of(config.free));
  bounds_ = {to_evidence(-config.max_log_odds), to_evidence(config.max_log_odds)};
}

VoxelMap::VoxelMap(VoxelMap&&) noexcept = default;
VoxelMap& VoxelMap::operator=(VoxelMap&&) noexcept = default;
VoxelMap::~VoxelMap() = default;

VoxelIndex VoxelMap::voxel_at(const Eigen::Vector3d& p_W) const {
  ISOBATH_ASSERT(p_W.allFinite() && p_W.cwiseAbs().maxCoeff() <= reach_m());
  return floor_of(p_W / config_.voxel_m);
}

Eigen::Vector3d VoxelMap::centre_of(const VoxelIndex& v) const {
  return (v.cast<double>().array() + 0.5) * config_.voxel_m;
}

// Layers -------------------------------------------------------------------------------------------------------------

VoxelBlocks& VoxelMap::layer(std::string_view sensor) {
  for (const auto& l : layers_) {
    if (l->sensor == sensor) return l->blocks;
  }
  VoxelBlocks made(bounds_);
  made.begin(revision_);
  if (file_) made.spill_to(file_->shelf(sensor));
  layers_.push_back(std::make_unique<Layer>(Layer{std::string(sensor), std::move(made)}));
  return layers_.back()->blocks;
}

const VoxelBlocks* VoxelMap::find_layer(std::string_view sensor) const {
  for (const auto& l : layers_) {
    if (l->sensor == sensor) return &l->blocks;
  }
  return nullptr;
}

std::vector<std::string> VoxelMap::sensors() const {
  std::vector<std::string> names;
  for (const auto& l : layers_) names.push_back(l->sensor);
  return names;
}

// Reading ------------------------------------------------------------------------------------------------------------

VoxelMap::Pooled VoxelMap::pooled(const VoxelIndex& v) const {
  Pooled all{prior_, false};
  for (const auto& l : layers_) {
    const LogOdds16 e = l->blocks.at(v);
    if (e == kUnseen) continue;
    all.evidence += e;
    all.seen = true;
  }
  return all;
}

double VoxelMap::log_odds(const VoxelIndex& v) const { return kEvidenceUnit * pooled(v).evidence; }

double VoxelMap::probability(const VoxelIndex& v) const { return 1 / (1 + std::exp(-log_odds(v))); }

bool VoxelMap::is_seen(const VoxelIndex& v) const { return pooled(v).seen; }

Space VoxelMap::space(const VoxelIndex& v) const {
  const Pooled all = pooled(v);
  if (!all.seen) return Space::kUnknown;
  if (all.evidence >= occupied_from_) return Space::kOccupied;
  return all.evidence <= free_to_ ? Space::kFree : Space::kUnknown;
}

// Changes and memory -------------------------------------------------------------------------------------------------

std::uint64_t VoxelMap::advance() {
  ++revision_;
  for (const auto& l : layers_) l->blocks.begin(revision_);
  return revision_;
}

std::vector<VoxelIndex> VoxelMap::changed_after(std::uint64_t revision) const {
  std::vector<VoxelIndex> corners;
  for (const auto& l : layers_) l->blocks.corners_after(revision, corners);
  const auto less = [](const VoxelIndex& a, const VoxelIndex& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(corners.begin(), corners.end(), less);
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

void VoxelMap::move(const VoxelIndex& by, std::uint64_t after) {
  for (const auto& l : layers_) l->blocks.move(by, after);
}

std::size_t VoxelMap::keep_within(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& half_size_m) {
  const VoxelIndex least = voxel_at(centre_W - half_size_m), most = voxel_at(centre_W + half_size_m);
  std::size_t gone = 0;
  for (const auto& l : layers_) gone += l->blocks.keep_within(least, most);
  return gone;
}

std::size_t VoxelMap::bytes() const {
  std::size_t all = 0;
  for (const auto& l : layers_) all += l->blocks.bytes();
  return all;
}

// The file -----------------------------------------------------------------------------------------------------------

void VoxelMap::spill_to(const std::filesystem::path& file) {
  auto opened = std::make_unique<VoxelFile>(file, config_.voxel_m, bounds_);
  const bool empty = std::all_of(layers_.begin(), layers_.end(), [](const auto& l) { return l->blocks.blocks() == 0; });
  if (opened->revision() > 0 && !empty) {
    throw Error("already holds voxels, and so does the map", {file.string()}, {}, "give another file");
  }
  if (file_) throw Error("the map already has a file", {file.string()});
  revision_ = std::max(revision_, opened->revision());
  file_ = std::move(opened);
  for (const auto& l : layers_) l->blocks.spill_to(file_->shelf(l->sensor));
  for (const std::string& sensor : file_->sensors()) layer(sensor);
  for (const auto& l : layers_) l->blocks.begin(revision_);
}

std::size_t VoxelMap::spill_outside(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& half_size_m) {
  const VoxelIndex least = voxel_at(centre_W - half_size_m), most = voxel_at(centre_W + half_size_m);
  std::size_t gone = 0;
  for (const auto& l : layers_) {
    gone += l->blocks.spill([&](const VoxelBlocks::Block& b) {
      return ((b.corner.array() + VoxelBlocks::kSide - 1) < least.array()).any() ||
             (b.corner.array() > most.array()).any();
    });
  }
  return gone;
}

std::size_t VoxelMap::spill_beyond(std::size_t bytes) {
  constexpr std::size_t kBlockBytes = VoxelBlocks::kVolume * sizeof(LogOdds16);
  std::size_t held = 0;
  for (const auto& l : layers_) held += l->blocks.blocks() - l->blocks.spilled();
  if (held * kBlockBytes <= bytes) return 0;

  // Blocks of equal revision are ordered by place, so that the choice does not depend on the layout of the tables.
  using Age = std::tuple<std::uint64_t, std::uint64_t>;
  const auto age = [](const VoxelBlocks::Block& b) { return Age(b.revision, VoxelBlocks::key_of(b.corner)); };
  std::vector<Age> ages;
  ages.reserve(held);
  for (const auto& l : layers_) {
    l->blocks.for_each_held([&](const VoxelBlocks::Block& b) { ages.push_back(age(b)); });
  }
  const std::size_t kept = (bytes - bytes / 8) / kBlockBytes;
  const auto newest_to_go = ages.begin() + static_cast<std::ptrdiff_t>(held - kept - 1);
  std::nth_element(ages.begin(), newest_to_go, ages.end());
  const Age last = *newest_to_go;
  std::size_t gone = 0;
  for (const auto& l : layers_) {
    gone += l->blocks.spill([&](const VoxelBlocks::Block& b) { return age(b) <= last; });
  }
  return gone;
}

void VoxelMap::save() const {
  for (const auto& l : layers_) l->blocks.save();
}

std::size_t VoxelMap::spilled() const {
  std::size_t all = 0;
  for (const auto& l : layers_) all += l->blocks.spilled();
  return all;
}

}  // namespace isobath

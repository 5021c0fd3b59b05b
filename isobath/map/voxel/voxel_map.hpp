// VoxelMap: the evidence of all sensors about the surrounding space: occupied, free or unknown, with a probability.
//
// Each sensor has one layer of evidence, and reading pools the layers: with n sensors of log-odds l_i and a common
// prior l_0, l = sum l_i - (n - 1) l_0 (ledger S5-27 to S5-30; the paper's rule is the case of prior 0.5). Layers hold
// evidence without the prior, so that l is the sum of the layers plus the prior once. A sensor joins by its name.
//
// Memory is bounded in two ways: by forgetting what is far away (keep_within), or, without loss, by a file to which
// blocks spill and from which they return (VoxelFile). After spill_to the map may be larger than memory, and every
// query gives, bit for bit, the result of a map without a bound. The map never spills during an update: the caller
// spills between two updates; an update brings back the blocks that it touches. After a crash the file opens with the
// blocks of its last spill or save.
//
// Three classes for planning (S5-32, S5-33): occupied from `occupied` on, free up to `free`, else unknown. A voxel that
// was never observed is unknown, whatever the prior.
#pragma once

#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/map/voxel/voxel_blocks.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

class VoxelFile;

struct VoxelMapConfig {
  double voxel_m = 0.25;
  double prior = 0.5;
  double occupied = 0.98;
  double free = 0.2;
  double max_log_odds = 6.9;  ///< of one layer: l_max of S5-15
};
std::vector<Field> fields(VoxelMapConfig& config);

enum class Space : std::uint8_t { kUnknown, kFree, kOccupied };

class VoxelMap {
 public:
  /// Throws Error if a voxel has no size, or the thresholds are out of order.
  explicit VoxelMap(const VoxelMapConfig& config = {});
  VoxelMap(VoxelMap&&) noexcept;
  VoxelMap& operator=(VoxelMap&&) noexcept;
  ~VoxelMap();

  [[nodiscard]] const VoxelMapConfig& config() const { return config_; }
  [[nodiscard]] double voxel_m() const { return config_.voxel_m; }
  /// The voxel that holds a point of W, m; the point must be finite and within `reach_m` of the origin.
  [[nodiscard]] VoxelIndex voxel_at(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] Eigen::Vector3d centre_of(const VoxelIndex& v) const;
  [[nodiscard]] double reach_m() const { return (VoxelBlocks::kFarthest - 1) * config_.voxel_m; }

  /// The layer of a sensor, made at the first request. References are valid as long as the map.
  VoxelBlocks& layer(std::string_view sensor);
  [[nodiscard]] const VoxelBlocks* find_layer(std::string_view sensor) const;
  [[nodiscard]] std::vector<std::string> sensors() const;

  /// All layers pooled: ln P / (1 - P), and P; the prior where no sensor has observed the voxel.
  [[nodiscard]] double log_odds(const VoxelIndex& v) const;
  [[nodiscard]] double probability(const VoxelIndex& v) const;
  /// Whether any sensor has observed the voxel.
  [[nodiscard]] bool is_seen(const VoxelIndex& v) const;
  [[nodiscard]] Space space(const VoxelIndex& v) const;

  /// Corners of the blocks that any sensor has changed after a revision, each once, in order of x, y, z.
  [[nodiscard]] std::vector<VoxelIndex> changed_after(std::uint64_t revision) const;
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Begins the next revision; all later writes belong to it.
  std::uint64_t advance();

  /// Moves by whole voxels, in all layers, the blocks that changed after a revision (VoxelBlocks::move).
  void move(const VoxelIndex& by, std::uint64_t after);

  /// Bounds memory: forgets the blocks that lie wholly outside a box about a point, m.
  std::size_t keep_within(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& half_size_m);
  [[nodiscard]] std::size_t bytes() const;  ///< of memory

  /// Opens a file for blocks, or creates it. If the file holds blocks, they become the map's, which must then be empty.
  /// Throws Error; from here on all functions that read or touch a damaged block, or meet a failing disk, throw it,
  /// too.
  void spill_to(const std::filesystem::path& file);
  [[nodiscard]] bool spills() const { return file_ != nullptr; }
  /// Moves blocks wholly outside a box about a point, m, out of memory. These two return the number of blocks moved.
  std::size_t spill_outside(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& half_size_m);
  /// If the evidence in memory exceeds `bytes`, moves out the least recently changed blocks until it is an eighth
  /// below, so that a spill is not for a block or two.
  std::size_t spill_beyond(std::size_t bytes);
  /// Writes all blocks to the file and keeps those in memory there.
  void save() const;
  [[nodiscard]] std::size_t spilled() const;  ///< blocks in the file only, over all layers

 private:
  struct Layer {
    std::string sensor;
    VoxelBlocks blocks;
  };
  struct Pooled {
    int evidence = 0;
    bool seen = false;
  };
  [[nodiscard]] Pooled pooled(const VoxelIndex& v) const;

  VoxelMapConfig config_;
  int prior_, occupied_from_, free_to_;  ///< in units of evidence
  EvidenceBounds bounds_;
  std::unique_ptr<VoxelFile> file_;  ///< outlives the layers
  std::vector<std::unique_ptr<Layer>> layers_;
  std::uint64_t revision_ = 1;
};

}  // namespace isobath

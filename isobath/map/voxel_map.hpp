// VoxelMap: what all sensors together say of the space around: occupied, free or unknown, with a probability.
//
// One layer of evidence a sensor, pooled when it is read: with n sensors of log-odds l_i and a prior l_0 that all
// share, l = sum l_i - (n - 1) l_0 (ledger S5-27 to S5-30; the paper's rule is the one of prior 0.5). Layers hold
// evidence without the prior, so that the sum of the layers, plus the prior once, is just that. A sensor joins by its
// name and leaves without a trace.
//
// Memory is bounded in two ways: by forgetting what is far away (keep_within), or, without loss, by a file that blocks
// spill to and come back from (VoxelFile): after spill_to the map may be larger than memory, and every answer is bit
// for bit that of a map without bound. Spilling is never done behind the back of an update: the caller says when,
// between two of them; an update brings back what it touches. A file that a killed program left opens with the blocks
// of its last spill or save.
//
// Three classes for planning (S5-32, S5-33): occupied from `occupied` on, free up to `free`, else unknown; what nobody
// has looked at is unknown whatever the prior.
#pragma once

#include <filesystem>
#include <isobath/base/config.hpp>
#include <isobath/map/voxel_blocks.hpp>
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
  double most_log_odds = 6.9;  ///< of one layer: l_max of S5-15
};
std::vector<Field> fields(VoxelMapConfig& config);

enum class Space : std::uint8_t { kUnknown, kFree, kOccupied };
const char* to_text(Space space);

class VoxelMap {
 public:
  /// Throws Error where a voxel has no size, or the thresholds are out of order.
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

  /// The layer of a sensor, made when it is first asked for. References stay good until that layer is removed.
  VoxelBlocks& layer(std::string_view sensor);
  [[nodiscard]] const VoxelBlocks* find_layer(std::string_view sensor) const;
  /// Whether there was one.
  bool remove_layer(std::string_view sensor);
  [[nodiscard]] std::vector<std::string> sensors() const;

  /// Of all layers together: ln P / (1 - P), and P. The prior where nobody has looked.
  [[nodiscard]] double log_odds(const VoxelIndex& v) const;
  [[nodiscard]] double probability(const VoxelIndex& v) const;
  /// Whether any sensor has said anything of it.
  [[nodiscard]] bool is_seen(const VoxelIndex& v) const;
  [[nodiscard]] Space space(const VoxelIndex& v) const;

  /// Corners of the blocks that any sensor has changed after a revision, each once, in order of x, y, z.
  [[nodiscard]] std::vector<VoxelIndex> changed_after(std::uint64_t revision) const;
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// All that is written from now on is of the next revision.
  std::uint64_t advance();

  /// Moves by whole voxels, in all layers, what lies in blocks that changed after a revision (VoxelBlocks::move).
  void move(const VoxelIndex& by, std::uint64_t after);

  /// Bounds memory: forgets the blocks that lie wholly outside of a box about a point, m.
  std::size_t keep_within(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& half_size_m);
  [[nodiscard]] std::size_t bytes() const;  ///< of memory

  /// Opens a file for blocks, or makes it. Where it holds some, they are the map's, which must hold none itself then.
  /// Throws Error, as do, from here on, all that read or touch a damaged block or meet a disk that fails.
  void spill_to(const std::filesystem::path& file);
  [[nodiscard]] bool spills() const { return file_ != nullptr; }
  /// Out of memory what lies wholly outside of a box about a point, m. These two return how many blocks went.
  std::size_t spill_outside(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& half_size_m);
  /// Where memory holds evidence of more than so many bytes: the least recently changed blocks go until it is an eighth
  /// less, so that a spill is not for a block or two.
  std::size_t spill_beyond(std::size_t bytes);
  /// Writes all to the file, and keeps in memory what is there.
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

// VoxelFile: voxel blocks on disk, for maps that are larger than memory; one shelf for each layer of a VoxelMap.
//
// One SQLite database. It holds the edge of a voxel and the bounds of evidence, so that blocks of another map are not
// mistaken for this one's; the layers; and one row a block with its revision, its evidence (deflate, level 1) and a
// CRC-32 over layer, place, revision and plain evidence. So a block is read exactly as it was written, in its own
// place, or not at all. Each call that changes the file is one transaction (sqlite_file.hpp): a crash at any instant,
// or a full disk, leaves the blocks of the last call that returned.
//
// Reading a voxel uses a cache of the last 64 blocks read of a layer, half a megabyte. The index takes about 40 bytes
// of memory per block of 8192.
//
// Cost (one core): 0.06 ms to write a block and 0.04 ms to read it, plus the flushes of a commit, some milliseconds.
// Throws Error, with the file's name, if the file is damaged, belongs to another map, is held by another program, or
// the disk fails. One thread writes; while no thread writes, any number may read.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <isobath/map/storage/sqlite_file.hpp>
#include <isobath/map/voxel/voxel_evidence.hpp>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace isobath {

class VoxelFile;

/// The blocks of one layer.
class VoxelShelf {
 public:
  struct Block {
    std::uint64_t key = 0, revision = 0;
    const LogOdds16* evidence = nullptr;  ///< kBlockVolume of them
  };
  VoxelShelf(VoxelFile& file, std::int64_t layer) : file_(file), layer_(layer) {}

  [[nodiscard]] const std::unordered_map<std::uint64_t, std::uint64_t>& revisions() const { return revisions_; }
  [[nodiscard]] bool holds(std::uint64_t key) const { return revisions_.count(key) != 0; }
  /// The evidence of a voxel of a block; kUnseen if the shelf does not hold the block.
  [[nodiscard]] LogOdds16 at(std::uint64_t key, int offset) const;
  /// Reads a whole block that the shelf holds.
  void read(std::uint64_t key, std::span<LogOdds16> evidence) const;

  /// Each of these changes the file as a whole or, with an Error, not at all.
  void write(std::span<const Block> blocks);
  void erase(std::span<const std::uint64_t> keys);

  [[nodiscard]] std::size_t bytes() const;  ///< of memory

 private:
  friend class VoxelFile;
  struct Copy {
    std::uint64_t key = ~std::uint64_t{0};
    std::array<LogOdds16, kBlockVolume> evidence;
  };
  static constexpr std::size_t kCopies = 64;
  void read_row(std::uint64_t key, std::span<LogOdds16> evidence) const;
  void write_row(const Block& block);
  /// The cache slot of a block.
  [[nodiscard]] std::unique_ptr<Copy>& copy_of(std::uint64_t key) const {
    return copies_[(key * 0x9E3779B97F4A7C15u) >> 58];
  }

  VoxelFile& file_;
  std::int64_t layer_;
  std::unordered_map<std::uint64_t, std::uint64_t> revisions_;  ///< of the blocks in the file, by key
  mutable std::array<std::unique_ptr<Copy>, kCopies> copies_;
};

class VoxelFile {
 public:
  /// Opens the file, or creates it for a map of these voxels. Throws Error if it belongs to another map.
  VoxelFile(const std::filesystem::path& path, double voxel_m, const EvidenceBounds& bounds);
  VoxelFile(const VoxelFile&) = delete;
  VoxelFile& operator=(const VoxelFile&) = delete;

  /// In the order of their creation.
  [[nodiscard]] std::vector<std::string> sensors() const;
  /// Makes the shelf if there is none; its address is stable.
  VoxelShelf& shelf(std::string_view sensor);
  /// The highest revision of all blocks; 0 if there are none.
  [[nodiscard]] std::uint64_t revision() const;

 private:
  friend class VoxelShelf;
  /// Applies `change` to the file as a whole or not at all.
  void transact(const std::function<void()>& change);
  void check_map(double voxel_m, const EvidenceBounds& bounds);
  void read_index();

  SqliteFile file_;
  mutable std::mutex reading_;  ///< guards the connection and the cache
  struct Named {
    std::string sensor;
    std::unique_ptr<VoxelShelf> shelf;
  };
  std::vector<Named> shelves_;
};

}  // namespace isobath

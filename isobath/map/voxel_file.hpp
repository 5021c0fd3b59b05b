// VoxelFile: blocks of voxels on disk, for maps that are larger than memory; one shelf a layer of a VoxelMap.
//
// One SQLite database: the edge of a voxel and the bounds of evidence, so that no other map's blocks are taken for its
// own; the layers; and a row a block with its revision, its evidence (deflate, level 1) and a CRC-32 over layer, place,
// revision and plain evidence. So a block is read as it was written, in its own place, or not at all. Each call that
// changes the file is one transaction (sqlite_file.hpp): who is killed at any instant, or runs out of disk, leaves the
// blocks of the last one that returned.
//
// Reading a voxel goes through the last 64 blocks read of a layer, half a megabyte. Memory for what is on file: about
// 40 bytes a block of 8192.
//
// Cost (one core): 0.06 ms to write a block and 0.04 ms to read it, and the flushes of a commit, some milliseconds.
// Throws Error, with the file's name, where it is damaged, of another map, held by another program, or the disk fails.
// One thread writes; while nobody writes, any number read.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <isobath/map/sqlite_file.hpp>
#include <isobath/map/voxel_evidence.hpp>
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
  /// Of a voxel of a block; kUnseen where the shelf holds none such.
  [[nodiscard]] LogOdds16 at(std::uint64_t key, int offset) const;
  /// All of a block that it holds.
  void read(std::uint64_t key, std::span<LogOdds16> evidence) const;

  /// Each of these changes the file as a whole or, with an Error, not at all.
  void write(std::span<const Block> blocks);
  void erase(std::span<const std::uint64_t> keys);
  /// Every block as `change` leaves it, with a new revision.
  void rewrite(std::uint64_t revision, const std::function<void(LogOdds16* evidence)>& change);

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
  /// Where the copy of a block stands or would stand.
  [[nodiscard]] std::unique_ptr<Copy>& copy_of(std::uint64_t key) const {
    return copies_[(key * 0x9E3779B97F4A7C15u) >> 58];
  }

  VoxelFile& file_;
  std::int64_t layer_;
  std::unordered_map<std::uint64_t, std::uint64_t> revisions_;  ///< of what is on file, by key
  mutable std::array<std::unique_ptr<Copy>, kCopies> copies_;
};

class VoxelFile {
 public:
  /// Opens the file, or makes it for a map of these voxels. Throws Error where it is of another.
  VoxelFile(const std::filesystem::path& path, double voxel_m, const EvidenceBounds& bounds);
  VoxelFile(const VoxelFile&) = delete;
  VoxelFile& operator=(const VoxelFile&) = delete;

  /// In the order in which they were made.
  [[nodiscard]] std::vector<std::string> sensors() const;
  /// Made where there is none; stays where it is until it is removed.
  VoxelShelf& shelf(std::string_view sensor);
  void remove(std::string_view sensor);
  /// The greatest of all blocks; 0 where there are none.
  [[nodiscard]] std::uint64_t revision() const;

 private:
  friend class VoxelShelf;
  /// What `change` does to the file, or nothing of it.
  void transact(const std::function<void()>& change);
  void check_map(double voxel_m, const EvidenceBounds& bounds);
  void read_index();

  SqliteFile file_;
  mutable std::mutex reading_;  ///< of the connection and the copies
  struct Named {
    std::string sensor;
    std::unique_ptr<VoxelShelf> shelf;
  };
  std::vector<Named> shelves_;
};

}  // namespace isobath

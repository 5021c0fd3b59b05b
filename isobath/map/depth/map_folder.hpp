// MapFolder: a depth map on disk, in one folder that the next mission opens again (ledger S1-26, S1-81; design, section
// 5).
//
//   map.json            facts about the map, and the files of its committed state; this is the commit record
//   prior.N.tree sensed.N.tree state.N.tree    region quadtrees of generation N (tree_file.hpp)
//   objects.sqlite      objects, lines and their attributes, with its own transactions (object_store.hpp)
//
// A commit writes the changed trees under new names, flushes them to disk, and then replaces map.json by one rename;
// only then does it remove the files of earlier generations. A crash at any instant leaves the last committed map.
// map.json carries its own checksum and has a copy (map.json.copy), so that one flipped bit loses nothing. A damaged
// block of a tree is reported with file, block and byte; the rest of the map is read.
//
// Errors: throws Error where the folder is not a map, is of another version, or lacks a file, and where it cannot be
// written. One writer a folder: a lock file is held while a map is open for writing. Not thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/base/time.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// One input that went into a map.
struct MapVisit {
  std::string input;
  Time first, last;
  std::map<std::string, std::uint64_t> counts;  ///< "range readings" -> 31000
};

/// Facts about a map, stored with it.
struct MapFacts {
  std::optional<GeoOrigin> origin;  ///< of W; empty: local metres
  DepthArea area;
  Time epoch;         ///< the start of the pixels' minutes
  std::string datum;  ///< the reference of depths: "water surface", "LAT", ...
  std::uint64_t generation = 0;
  std::vector<std::string> priors;  ///< the sources of the prior, for people
  std::vector<MapVisit> visits;     ///< in order
  std::string configuration;        ///< TOML in force at the last commit
};

/// A damaged block of a file, and what was lost with it. The lost pixels of a file are counted with its first block.
struct MapDamage {
  std::string file;
  std::uint64_t block = 0;
  std::uint64_t byte = 0;  ///< where the block begins
  std::uint64_t pixels_lost = 0;
  std::string reason;
};

/// "state.3.tree, block 2 at byte 36864: the checksum does not match; 4096 pixels lost".
std::string to_text(const MapDamage& damage);

struct StoredMap {
  MapFacts facts;
  DepthTrees trees;
  std::vector<MapDamage> damages;
};

/// Whether there is a commit record in this folder.
bool looks_like_map(const std::filesystem::path& folder);
StoredMap open_map(const std::filesystem::path& folder);

class MapFolder {
 public:
  /// Makes the folder if it does not exist, and takes the lock. Throws Error where another program holds the lock, and
  /// where the folder holds something other than a map.
  explicit MapFolder(std::filesystem::path folder);
  ~MapFolder();
  MapFolder(const MapFolder&) = delete;
  MapFolder& operator=(const MapFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  [[nodiscard]] bool holds_map() const { return looks_like_map(folder_); }
  [[nodiscard]] std::filesystem::path objects_file() const { return folder_ / "objects.sqlite"; }
  /// Raises facts.generation and makes this the committed state. The prior keeps its file, because a map keeps its
  /// original prior. Safe against a crash at any instant.
  void commit(MapFacts& facts, const DepthTrees& trees);

 private:
  std::filesystem::path folder_;
  int lock_ = -1;
};

}  // namespace isobath

// MapFolder: a depth map on disk, in one folder that the next mission opens again (ledger S1-26, S1-81; design, section
// 5).
//
//   map.json            facts about the map, and the files of its committed state; this is the commit record
//   map.json.copy       its copy (map_record.hpp)
//   prior.N.tree sensed.N.tree state.N.tree    region quadtrees of generation N (tree_file.hpp)
//   objects.sqlite      objects, lines and their attributes, with its own transactions (object_store.hpp)
//
// A commit writes the changed trees under new names, flushes them to disk, reads them back, and then replaces map.json
// by one rename; only then does it remove the files of earlier generations. A crash or a failing call at any instant
// leaves the last committed map. A damaged block of a tree is reported with file, block and byte; the rest of the map
// is read. MapFolder writes only to a map of which every file could be read; it keeps a file with damaged blocks beside
// its successor, as NAME.damaged.
//
// Errors: throws Error where the folder is not a map or is of another version, where a file exists that cannot be read
// now, and where the folder cannot be written. One writer a folder: a lock file is held while a map is open for
// writing. A reader that meets a commit reads the state before it or after it. Not thread-safe.
#pragma once

#include <filesystem>
#include <isobath/map/depth/depth_trees.hpp>
#include <isobath/map/depth/map_record.hpp>
#include <set>
#include <string>
#include <vector>

namespace isobath {

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
  /// Makes the folder if it does not exist, and takes the lock. Throws Error where another program holds the lock,
  /// where the folder holds something other than a map, and where a link in it could lead a write elsewhere.
  explicit MapFolder(std::filesystem::path folder);
  /// Removes a folder that it made and that has no committed map.
  ~MapFolder();
  MapFolder(const MapFolder&) = delete;
  MapFolder& operator=(const MapFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  /// Throws Error where the system does not tell.
  [[nodiscard]] bool holds_map() const;
  [[nodiscard]] std::filesystem::path objects_file() const { return folder_ / "objects.sqlite"; }
  /// The map, to be continued. Throws Error where a tree cannot be used at all: what is written next would lack it.
  [[nodiscard]] StoredMap open();
  /// Raises facts.generation and makes this the committed state. The prior keeps its file, because a map keeps its
  /// original prior. If it throws, the folder holds the last committed state, or this one.
  void commit(MapFacts& facts, const DepthTrees& trees);

 private:
  void take_lock();
  [[nodiscard]] ReadRecord last_record() const;
  void write_trees(MapRecord& record, const MapRecord& last, const DepthTrees& trees) const;
  void remove_superseded(const MapRecord& record) const;
  void remove_own_files() const;

  std::filesystem::path folder_;
  bool made_ = false;
  int lock_ = -1;
  std::set<std::string> damaged_;  ///< files of which only a part could be read
};

}  // namespace isobath

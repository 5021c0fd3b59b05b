// MapRecord: the commit record of a stored map, map.json: what the map is, and which files are its committed state.
//
// The record carries its own checksum and has a copy (map.json.copy), so that one flipped bit loses nothing. For each
// tree it holds the seal (tree_file.hpp), which tells a file of another map or generation from the committed one.
// Records of earlier versions have no seals.
//
// Every value is checked when it is read: the record is text that anyone may have changed. Errors: throws Error where
// neither of the two can be read as a record, and where a record is whole but not usable here, such as one of another
// version; DiskError where the system refuses to read one that exists.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <isobath/base/time.hpp>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/map/depth/revisit_record.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

/// One input that went into a map.
struct MapVisit {
  std::string input;
  Time first, last;
  std::map<std::string, std::uint64_t> counts;  ///< "range readings" -> 31000
  std::string fingerprint = {};                 ///< of the input's content (fingerprint_of); empty: not known
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
  RevisitRecord revisits;           ///< what later passes showed of earlier ones
};

/// A damaged block of a file, and what was lost with it. The lost pixels of a file are counted with its first block.
struct MapDamage {
  std::string file;
  std::uint64_t block = 0;
  std::uint64_t byte = 0;  ///< where the block begins
  std::uint64_t pixels_lost = 0;
  std::string reason;
  bool whole_file = false;  ///< nothing of the file could be used
};

/// "state.3.tree, block 2 at byte 36864: the checksum does not match; 4096 pixels lost".
std::string to_text(const MapDamage& damage);

struct MapRecord {
  static constexpr const char* kName = "map.json";
  static constexpr const char* kCopy = "map.json.copy";
  static constexpr std::array<const char*, 3> kTrees{"prior", "sensed", "state"};
  static constexpr std::uint64_t kLastGeneration = std::uint64_t{1} << 53;  ///< exact in every reader of JSON

  MapFacts facts;
  std::map<std::string, std::string> files;    ///< "sensed" -> "sensed.7.tree"
  std::map<std::string, std::uint32_t> seals;  ///< "sensed" -> seal of its file
};

/// The generation in the name of a tree's file, "sensed.7.tree"; empty for any other name.
std::optional<std::uint64_t> generation_of(const std::string& file);
std::string text_of(const MapRecord& record);

struct ReadRecord {
  MapRecord record;
  std::array<std::string, 2> texts;  ///< map.json and its copy, as they were read
  std::vector<MapDamage> damages;    ///< of the two
  bool from_copy = false;
};
/// The later of the two records. A copy one generation older is what a commit leaves that is interrupted, not damage.
ReadRecord read_record(const std::filesystem::path& folder);
/// Whether the two records are still those that were read.
bool unchanged(const std::filesystem::path& folder, const ReadRecord& read);

}  // namespace isobath

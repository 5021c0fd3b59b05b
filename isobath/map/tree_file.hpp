// Region quadtrees on disk, one file a tree, as they stand in memory (ledger S1-26; also S1-16).
//
// Words are of the machine that wrote them; a mark tells their order. Format 1:
//   header     72 bytes: magic, order mark, version, generation, levels, value outside, root, pages, blocks, head and
//              count of the free blocks, bytes of metadata, blocks in the crown, CRC of the crown, CRC of header and
//              metadata
//   metadata   the caller's text (UTF-8, JSON say), up to 64 KiB
//   table      a CRC a page
//   crown      index and four words of each block of the five topmost levels, once more
//   pages      from the next multiple of 4096 on: 16 KiB each, to the end of the file
// CRC is that of zlib (CRC-32, ISO 3309).
//
// Writing: into `file`.part, which is flushed to the disk, renamed, and its folder flushed: at any instant the file is
// the old map or the new one, and a map that is mapped from the old file keeps it. Writers only ever rename. A program
// of others that truncates a mapped file in place ends the process that reads it (SIGBUS), which no reader can prevent;
// files below 4 MiB are read into memory, where nothing can happen to them.
//
// Opening trusts nothing. A bad header is an Error. A page with a wrong CRC is reported and not used: the squares
// below links into it read as `lost`, the rest of the map stays; the crown keeps the loss small, for a page that holds
// a block of the top would else take a quarter of the map with it. All links are followed once on opening: in range,
// no deeper than the levels, no block twice; so later traversals need no check, and a map that is open is sound. (To
// check on the way would cost each later traversal, and would let edits meet a list of free blocks that are in use.)
// What hangs below a bad link reads as `lost`, too.
//
// Threads: any, on different files. Cost of opening: 1 GB/s, of it 4 GB/s the checksums and the rest the links.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/map/region_quadtree.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

inline constexpr std::size_t kMostTreeMetadata = 65536;

/// Throws Error: metadata too long; cannot be written or renamed: the file is then the old one; the folder cannot be
/// flushed: it is the new one, and a loss of power may bring back the old.
void write_tree_file(const std::filesystem::path& file, const RegionQuadtree& tree, std::uint64_t generation,
                     const std::string& metadata);

struct TreeFile {
  /// One page that is not what was written, or one link that leads nowhere.
  struct Damage {
    std::uint32_t page = 0;
    std::uint64_t byte = 0;  ///< in the file, of the page or of the link
    bool operator==(const Damage&) const = default;
  };

  RegionQuadtree tree{0};  ///< its pages are in the mapped file until they are written to
  std::uint64_t generation = 0;
  std::string metadata;
  std::vector<Damage> damaged_pages;  ///< ascending
  std::vector<Damage> bad_links;
  /// Bytes at which the second copy of the top, or what should be empty, is not as written: nothing is lost by it.
  std::vector<std::uint64_t> spare_damage;
  std::vector<PixelWindow> lost;  ///< squares that read as the value given for them

  [[nodiscard]] bool sound() const { return damaged_pages.empty() && bad_links.empty() && spare_damage.empty(); }
};

/// `lost`: what pixels read whose page is damaged. Throws Error: not there, cut off, of another format, version or byte
/// order, header damaged.
TreeFile open_tree_file(const std::filesystem::path& file, std::uint32_t lost);
/// The same from bytes in memory, aligned to 4, that `owner` keeps alive; `name` is for messages.
TreeFile parse_tree_file(std::span<const std::uint8_t> bytes, std::shared_ptr<const void> owner,
                         const std::string& name, std::uint32_t lost);

}  // namespace isobath

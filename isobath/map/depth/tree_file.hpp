// tree_file: region quadtrees on disk, one file a tree, in their layout in memory (ledger S1-26; also S1-16).
//
// Words have the byte order of the machine that wrote them; a mark records it. Format 1:
//   header     72 bytes: magic, order mark, version, generation, levels, value outside, root, pages, blocks, head and
//              count of the free blocks, bytes of metadata, blocks in the crown, CRC of the crown, CRC of the table,
//              CRC of header and metadata: the seal, which follows from all that the file holds
//   metadata   the caller's text (UTF-8, for example JSON), up to 64 KiB
//   table      a CRC a page
//   crown      a second copy of the index and four words of each block of the five topmost levels
//   pages      from the next multiple of 4096 on: 16 KiB each, to the end of the file
// CRC is that of zlib (CRC-32, ISO 3309).
//
// Writing goes into `file`.part, which is flushed to disk and renamed; then its folder is flushed. At any instant the
// file is the old map or the new one, and a program that has mapped the old file keeps it. Writers only ever rename.
// Another program that truncates a mapped file in place ends the reading process (SIGBUS), which no reader can prevent;
// files below 4 MiB are read into memory, where this cannot happen.
//
// Opening trusts nothing. A bad header is an Error. A page with a wrong CRC is reported and not used: the squares below
// links into it read as `lost`, and the rest of the map stays. The crown keeps the loss small, because a page that
// holds a block of the top levels would otherwise lose a quarter of the map. All links are followed once on opening and
// must be in range, no deeper than the levels, and never reach a block twice; so later traversals need no check, and an
// open map is sound. (Checks during later traversals would slow each of them down, and edits could meet a list of free
// blocks that are in use.) Squares below a bad link also read as `lost`.
//
// Threads: any, on different files. Cost of opening: 1 GB/s; the checksums alone run at 4 GB/s, and the links take the
// rest of the time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <isobath/map/depth/region_quadtree.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace isobath {

inline constexpr std::size_t kMaxTreeMetadata = 65536;

/// Throws Error if the metadata is too long, if the file cannot be written or renamed (it is then the old one), or if
/// the folder cannot be flushed (the file is then the new one, and a loss of power may bring back the old one). Returns
/// the seal.
std::uint32_t write_tree_file(const std::filesystem::path& file, const RegionQuadtree& tree, std::uint64_t generation,
                              const std::string& metadata);

struct TreeFile {
  /// A page whose contents have changed, or an invalid link.
  struct Damage {
    std::uint32_t page = 0;
    std::uint64_t byte = 0;  ///< in the file, of the page or of the link
    bool operator==(const Damage&) const = default;
  };

  RegionQuadtree tree{0};  ///< its pages are in the mapped file until they are written to
  std::uint64_t generation = 0;
  std::uint32_t seal = 0;  ///< tells the files of two trees apart that are both sound
  std::string metadata;
  std::vector<Damage> damaged_pages;  ///< ascending
  std::vector<Damage> bad_links;
  /// Bytes where the second copy of the top levels or the padding has changed; nothing is lost by it.
  std::vector<std::uint64_t> spare_damage;
  std::vector<PixelWindow> lost;  ///< squares that read as the value given for them

  [[nodiscard]] bool sound() const { return damaged_pages.empty() && bad_links.empty() && spare_damage.empty(); }
};

/// `lost`: the value of pixels in damaged parts. Throws Error if the file does not exist, was cut off, is of another
/// format, version or byte order, or has a damaged header; DiskError if the system refuses to open or read it.
TreeFile open_tree_file(const std::filesystem::path& file, std::uint32_t lost);
/// The same from bytes in memory, aligned to 4; `owner` keeps them alive. `name` is for messages.
TreeFile parse_tree_file(std::span<const std::uint8_t> bytes, std::shared_ptr<const void> owner,
                         const std::string& name, std::uint32_t lost);

}  // namespace isobath

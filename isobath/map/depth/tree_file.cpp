#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/map/depth/tree_file.hpp>
#include <isobath/map/storage/disk_file.hpp>
#include <sys/stat.h>
#include <unordered_map>
#include <zlib.h>

namespace isobath {
namespace {

namespace fs = std::filesystem;
using Block = BlockPool::Block;
using Square = RegionQuadtree::Square;

constexpr std::array<char, 8> kMagic{'I', 'S', 'O', 'T', 'R', 'E', 'E', '\n'};
constexpr std::uint32_t kOrderMark = 0x01020304;
constexpr std::uint32_t kVersion = 1;
constexpr int kCrownLevels = 5;
constexpr std::size_t kMaxCrown = 341;  // 1 + 4 + 16 + 64 + 256
constexpr std::size_t kAlignment = 4096;
constexpr std::size_t kMapFrom = std::size_t{4} << 20;  // smaller files are read into memory

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t order = kOrderMark;
  std::uint32_t version = kVersion;
  std::uint64_t generation = 0;
  std::uint32_t levels = 0;
  std::uint32_t outside = 0;
  std::uint32_t root = 0;
  std::uint32_t pages = 0;
  std::uint32_t blocks = 0;
  std::uint32_t free_head = 0;
  std::uint32_t free_count = 0;
  std::uint32_t metadata_bytes = 0;
  std::uint32_t crown_blocks = 0;
  std::uint32_t crown_crc = 0;
  std::uint32_t table_crc = 0;  ///< of the CRCs of all pages; 0 in files of earlier versions
  std::uint32_t crc = 0;        ///< of the header before it and of the metadata
};
static_assert(sizeof(Header) == 72 && std::is_trivially_copyable_v<Header>);

struct CrownBlock {
  std::uint32_t index = 0;
  Block block{};
};
static_assert(sizeof(CrownBlock) == 20);

/// The offsets of the parts of a file.
struct Layout {
  explicit Layout(const Header& h)
      : table(sizeof(Header) + (std::size_t{h.metadata_bytes} + 3) / 4 * 4),
        crown(table + sizeof(std::uint32_t) * h.pages),
        pages((crown + sizeof(CrownBlock) * h.crown_blocks + kAlignment - 1) / kAlignment * kAlignment),
        end(pages + BlockPool::kPageBytes * h.pages) {}
  std::size_t table;
  std::size_t crown;
  std::size_t pages;
  std::size_t end;
};

std::uint32_t crc_of(const void* data, std::size_t size, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(::crc32_z(before, static_cast<const Bytef*>(data), size));
}

std::uint32_t header_crc(const Header& header, const void* metadata) {
  return crc_of(metadata, header.metadata_bytes, crc_of(&header, offsetof(Header, crc)));
}

void collect_crown(const BlockPool& pool, std::uint32_t node, int depth, std::vector<CrownBlock>& crown) {
  if (RegionQuadtree::is_leaf(node) || depth == kCrownLevels) return;
  crown.push_back({node >> 1, pool.block(node >> 1)});
  for (std::uint32_t child : crown[crown.size() - 1].block) collect_crown(pool, child, depth + 1, crown);
}

/// Returns the seal.
std::uint32_t write_parts(const DiskFile& out, const RegionQuadtree& tree, std::uint64_t generation,
                          const std::string& metadata) {
  const BlockPool& pool = tree.pool();
  std::vector<CrownBlock> crown;
  crown.reserve(kMaxCrown);
  collect_crown(pool, tree.root(), 0, crown);
  Header header;
  header.generation = generation;
  header.levels = static_cast<std::uint32_t>(tree.levels());
  header.outside = tree.outside();
  header.root = tree.root();
  header.pages = pool.pages();
  header.blocks = pool.end();
  header.free_head = pool.free_head();
  header.free_count = pool.free_count();
  header.metadata_bytes = static_cast<std::uint32_t>(metadata.size());
  header.crown_blocks = static_cast<std::uint32_t>(crown.size());
  header.crown_crc = crc_of(crown.data(), crown.size() * sizeof(CrownBlock));
  std::vector<std::uint32_t> table;
  for (std::uint32_t i = 0; i < header.pages; ++i) table.push_back(crc_of(pool.page(i), BlockPool::kPageBytes));
  header.table_crc = crc_of(table.data(), table.size() * sizeof(std::uint32_t));
  header.crc = header_crc(header, metadata.data());
  const Layout layout(header);
  std::vector<std::uint8_t> front(layout.pages, 0);
  std::memcpy(front.data(), &header, sizeof header);
  std::copy(metadata.begin(), metadata.end(), front.begin() + sizeof header);
  for (std::uint32_t i = 0; i < header.pages; ++i) {
    out.write(pool.page(i), BlockPool::kPageBytes, layout.pages + BlockPool::kPageBytes * i);
  }
  if (!table.empty()) std::memcpy(front.data() + layout.table, table.data(), table.size() * sizeof(std::uint32_t));
  if (!crown.empty()) std::memcpy(front.data() + layout.crown, crown.data(), crown.size() * sizeof(CrownBlock));
  out.write(front.data(), front.size(), 0);
  return header.crc;
}

/// Throws Error where the header is invalid.
Header checked_header(std::span<const std::uint8_t> bytes, const std::string& name) {
  Header h;
  const auto refuse = [&](std::size_t byte, const std::string& problem, const std::string& allowed = {},
                          const std::string& advice = {}) {
    throw Error(problem, {name, byte}, allowed, advice);
  };
  if (bytes.size() < sizeof h) refuse(bytes.size(), "the file ends in its header", {}, "it was cut off");
  std::memcpy(&h, bytes.data(), sizeof h);
  if (h.magic != kMagic) refuse(0, "not a quadtree file");
  if (h.order != kOrderMark) {
    const bool swapped = h.order == 0x04030201;
    refuse(offsetof(Header, order), swapped ? "written by a machine of the other byte order" : "header damaged", {},
           swapped ? "export the map there and import it here" : "");
  }
  if (h.version != kVersion) {
    refuse(offsetof(Header, version), fmt::format("format version {}", h.version), fmt::format("{}", kVersion),
           "written by another version of the program");
  }
  if (h.metadata_bytes > kMaxTreeMetadata)
    refuse(offsetof(Header, metadata_bytes), "header damaged: metadata too long");
  if (bytes.size() < sizeof h + h.metadata_bytes)
    refuse(bytes.size(), "the file ends in its metadata", {}, "it was cut off");
  if (h.crc != header_crc(h, bytes.data() + sizeof h))
    refuse(offsetof(Header, crc), "header damaged: checksum differs");
  if (h.levels > RegionQuadtree::kMaxLevels) refuse(offsetof(Header, levels), "levels out of range", "0 .. 24");
  if (h.outside > RegionQuadtree::kLargestValue) refuse(offsetof(Header, outside), "value has more than 31 bits");
  if (h.blocks > BlockPool::kMaxBlocks ||
      h.pages != (h.blocks + BlockPool::kBlocksPerPage - 1) / BlockPool::kBlocksPerPage) {
    refuse(offsetof(Header, pages), "the numbers of pages and of blocks contradict each other");
  }
  if (h.crown_blocks > kMaxCrown) refuse(offsetof(Header, crown_blocks), "crown too large", "0 .. 341");
  const std::size_t end = Layout(h).end;
  if (bytes.size() != end) {
    refuse(std::min(bytes.size(), end), fmt::format("{} bytes instead of the {} in the header", bytes.size(), end), {},
           bytes.size() < end ? "the file was cut off" : "something was appended to the file");
  }
  return h;
}

/// Follows every link once and repairs the tree.
class Inspection {
 public:
  Inspection(const Header& header, std::span<const std::uint8_t> bytes, BlockPool& pool, std::uint32_t lost,
             TreeFile& report)
      : header_(header),
        layout_(header),
        pool_(pool),
        lost_(RegionQuadtree::leaf_of(lost)),
        report_(report),
        reached_(header.blocks),
        bad_page_(header.pages) {
    check_pages(bytes);
    check_crown(bytes);
  }

  /// The root of the sound tree; afterwards the pool's list of free blocks is valid.
  std::uint32_t run() {
    const std::uint32_t root = node(header_.root, {0, 0, static_cast<int>(header_.levels)}, kNoParent, 0);
    if (!free_list_sound()) {
      for (std::uint32_t index : merged_) reached_[index] = false;
      pool_.free_unmarked(reached_);
    }
    return root;
  }

 private:
  static constexpr std::uint32_t kNoParent = BlockPool::kNone;

  void check_pages(std::span<const std::uint8_t> bytes) {
    for (std::uint32_t i = 0; i < header_.pages; ++i) {
      std::uint32_t crc = 0;
      std::memcpy(&crc, bytes.data() + layout_.table + sizeof crc * i, sizeof crc);
      if (crc == crc_of(pool_.page(i), BlockPool::kPageBytes)) continue;
      bad_page_[i] = true;
      report_.damaged_pages.push_back({i, layout_.pages + BlockPool::kPageBytes * i});
    }
  }
  /// Reports bytes that are not 0 between the parts.
  void check_empty(std::span<const std::uint8_t> bytes, std::size_t from, std::size_t to) {
    for (std::size_t at = from; at < to; ++at) {
      if (bytes[at] == 0) continue;
      report_.spare_damage.push_back(at);
      return;
    }
  }
  void check_crown(std::span<const std::uint8_t> bytes) {
    const std::uint8_t* crown = bytes.data() + layout_.crown;
    const std::size_t crown_bytes = sizeof(CrownBlock) * header_.crown_blocks;
    check_empty(bytes, sizeof(Header) + header_.metadata_bytes, layout_.table);
    check_empty(bytes, layout_.crown + crown_bytes, layout_.pages);
    if (crc_of(crown, crown_bytes) != header_.crown_crc) {
      report_.spare_damage.push_back(layout_.crown);
      return;
    }
    if (report_.damaged_pages.empty()) return;
    for (std::uint32_t i = 0; i < header_.crown_blocks; ++i) {
      CrownBlock b;
      std::memcpy(&b, crown + sizeof b * i, sizeof b);
      crown_.emplace(b.index, b.block);
    }
  }

  /// The descriptor of a square, repaired; `parent` and `quadrant` are the place of the link.
  std::uint32_t node(std::uint32_t found, const Square& square, std::uint32_t parent, int quadrant) {
    if (RegionQuadtree::is_leaf(found)) return found;
    const std::uint32_t index = found >> 1;
    if (index >= header_.blocks || square.level == 0 || reached_[index]) {
      report_.bad_links.push_back(place(parent, quadrant));
      return lose(square);
    }
    if (bad_page_[index / BlockPool::kBlocksPerPage]) {
      const auto kept = crown_.find(index);
      if (kept == crown_.end()) return lose(square);
      pool_.write(index, kept->second);
    }
    reached_[index] = true;
    ++reached_count_;
    const Block before = pool_.block(index);
    Block now = before;
    for (int q = 0; q < 4; ++q) {
      if (!RegionQuadtree::is_leaf(before[q])) now[q] = node(before[q], square.quadrant(q), index, q);
    }
    if (RegionQuadtree::is_leaf(now[0]) && now[0] == now[1] && now[0] == now[2] && now[0] == now[3]) {
      merged_.push_back(index);  // stays marked: a block that is met twice must stop the walk, whatever it holds
      return now[0];
    }
    if (now != before) pool_.write(index, now);
    return found;
  }
  std::uint32_t lose(const Square& square) {
    report_.lost.push_back(square.window());
    return lost_;
  }
  [[nodiscard]] TreeFile::Damage place(std::uint32_t parent, int quadrant) const {
    if (parent == kNoParent) return {0, offsetof(Header, root)};
    return {parent / BlockPool::kBlocksPerPage,
            layout_.pages + sizeof(Block) * parent + sizeof(std::uint32_t) * quadrant};
  }

  /// Whether the file's free blocks are those that the tree does not use, each once.
  bool free_list_sound() {
    if (!merged_.empty() || !report_.damaged_pages.empty() || !report_.bad_links.empty()) return false;
    if (header_.free_count != header_.blocks - reached_count_) return false;
    std::vector<bool> seen(header_.blocks);
    std::uint32_t index = header_.free_head;
    for (std::uint32_t i = 0; i < header_.free_count; ++i) {
      if (index >= header_.blocks || reached_[index] || seen[index]) return false;
      seen[index] = true;
      index = *pool_.at(index);
    }
    if (index != BlockPool::kNone) return false;
    pool_.adopt_free_list(header_.free_head, header_.free_count);
    return true;
  }

  const Header& header_;
  Layout layout_;
  BlockPool& pool_;
  std::uint32_t lost_;
  TreeFile& report_;
  std::vector<bool> reached_;
  std::vector<bool> bad_page_;
  std::unordered_map<std::uint32_t, Block> crown_;
  std::uint32_t reached_count_ = 0;
  std::vector<std::uint32_t> merged_;  ///< blocks of four equal leaves
};

/// The whole file: mapped if it is large, else read.
std::shared_ptr<const void> contents(const DiskFile& in, std::size_t size, const fs::path& file) {
  if (size >= kMapFrom) return in.map(size);
  auto words = std::make_shared<std::vector<std::uint64_t>>((size + 7) / 8);
  if (in.read(words->data(), size) != size) throw Error("became shorter while it was read", {file});
  return {words, words->data()};
}

}  // namespace

std::uint32_t write_tree_file(const fs::path& file, const RegionQuadtree& tree, std::uint64_t generation,
                              const std::string& metadata) {
  if (metadata.size() > kMaxTreeMetadata) {
    throw Error(fmt::format("{} bytes of metadata", metadata.size()), {file}, fmt::format("0 .. {}", kMaxTreeMetadata));
  }
  std::uint32_t seal = 0;
  replace_file(file, [&](const DiskFile& out) { seal = write_parts(out, tree, generation, metadata); });
  return seal;
}

TreeFile open_tree_file(const fs::path& file, std::uint32_t lost) {
  const DiskFile in(file, O_RDONLY);
  struct stat status {};
  if (::fstat(in.number(), &status) != 0) throw DiskError(file, "cannot be read", errno);
  if (!S_ISREG(status.st_mode)) throw Error("not a file", {file});
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) throw Error("the file is empty", {file, 0}, {}, "it was cut off");
  const std::shared_ptr<const void> owner = contents(in, size, file);
  return parse_tree_file({static_cast<const std::uint8_t*>(owner.get()), size}, owner, file, lost);
}

TreeFile parse_tree_file(std::span<const std::uint8_t> bytes, std::shared_ptr<const void> owner,
                         const std::string& name, std::uint32_t lost) {
  ISOBATH_ASSERT(lost <= RegionQuadtree::kLargestValue);
  const Header header = checked_header(bytes, name);
  const Layout layout(header);
  ISOBATH_ASSERT(reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(std::uint32_t) == 0);
  TreeFile result;
  result.generation = header.generation;
  result.seal = header.crc;
  result.metadata.assign(reinterpret_cast<const char*>(bytes.data()) + sizeof header, header.metadata_bytes);
  BlockPool pool(reinterpret_cast<const std::uint32_t*>(bytes.data() + layout.pages), header.pages, std::move(owner),
                 header.blocks);
  const std::uint32_t root = Inspection(header, bytes, pool, lost, result).run();
  result.tree = RegionQuadtree(static_cast<int>(header.levels), header.outside, root, std::move(pool));
  return result;
}

}  // namespace isobath

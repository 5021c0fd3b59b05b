#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <isobath/io/exports/voxel_files.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <span>
#include <vector>

namespace isobath {
namespace {

constexpr int kSide = VoxelBlocks::kSide, kMiddle = 32768, kBlockDepth = 16 - VoxelBlocks::kSideLog2;

/// East, north and up keys of a voxel of W in the tree: centre = (key - 32768 + 1/2) edges.
std::array<int, 3> key_of(const VoxelIndex& v) { return {v.y() + kMiddle, v.x() + kMiddle, -v.z() - 1 + kMiddle}; }

bool has_key(const VoxelIndex& corner) {
  const auto key = key_of(corner);
  return std::all_of(key.begin(), key.end(), [](int k) { return k >= kSide && k < 2 * kMiddle - kSide; });
}

/// The Morton code of the block that a voxel lies in: one octree level after another, east in the lowest bit.
std::uint64_t morton(const VoxelIndex& corner) {
  const auto key = key_of(corner);
  std::uint64_t code = 0;
  for (int bit = 0; bit < kBlockDepth; ++bit) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto part = static_cast<std::uint64_t>(key[static_cast<std::size_t>(axis)] >> VoxelBlocks::kSideLog2);
      code |= (part >> bit & 1) << (3 * bit + axis);
    }
  }
  return code;
}

enum class Node : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2, kInner = 3 };

struct Placed {
  std::uint64_t code;
  VoxelIndex corner;
};

class TreeWriter {
 public:
  explicit TreeWriter(const VoxelMap& map) : map_(map) {}

  /// Writes all blocks of one cube of the tree, `depth` levels below the root.
  Node write(std::span<const Placed> blocks, int depth) {
    if (blocks.empty()) return Node::kUnknown;
    if (depth == kBlockDepth) {
      const VoxelIndex& c = blocks.front().corner;  // z of the tree points up
      return cube({c.x(), c.y(), c.z() + kSide - 1}, kSide);
    }
    return parts([&](int child) {
      const int shift = 3 * (kBlockDepth - 1 - depth);
      const auto of = [&](const Placed& p) { return static_cast<int>(p.code >> shift & 7); };
      const auto first =
          std::partition_point(blocks.begin(), blocks.end(), [&](const Placed& p) { return of(p) < child; });
      const auto last = std::partition_point(first, blocks.end(), [&](const Placed& p) { return of(p) == child; });
      return write({first, last}, depth + 1);
    });
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] std::uint64_t nodes() const { return nodes_ + 1; }

 private:
  /// Writes the cube with this lowest voxel (greatest z).
  Node cube(const VoxelIndex& least, int side) {
    if (side == 1) {
      switch (map_.space(least)) {
        case Space::kFree: return Node::kFree;
        case Space::kOccupied: return Node::kOccupied;
        case Space::kUnknown: return Node::kUnknown;
      }
    }
    const int half = side / 2;
    return parts([&](int child) {
      const VoxelIndex step((child >> 1 & 1) * half, (child & 1) * half, -(child >> 2) * half);
      return cube(least + step, half);
    });
  }
  /// Writes the two bytes of an inner node and its children. If all eight are equal leaves, writes nothing and returns
  /// that leaf.
  template <class Child>
  Node parts(const Child& child) {
    const std::size_t at = bytes_.size();
    const std::uint64_t nodes = nodes_;
    bytes_.append(2, '\0');
    std::array<Node, 8> kinds;
    for (int i = 0; i < 8; ++i) kinds[static_cast<std::size_t>(i)] = child(i);
    const bool alike = std::all_of(kinds.begin(), kinds.end(), [&](Node n) { return n == kinds[0]; });
    if (alike && kinds[0] != Node::kInner) {
      bytes_.resize(at);
      nodes_ = nodes;
      return kinds[0];
    }
    for (int i = 0; i < 8; ++i) {
      const Node kind = kinds[static_cast<std::size_t>(i)];
      char& byte = bytes_[at + static_cast<std::size_t>(i / 4)];
      byte = static_cast<char>(static_cast<unsigned char>(byte) | static_cast<unsigned>(kind) << 2 * (i % 4));
      nodes_ += kind != Node::kUnknown ? 1 : 0;
    }
    return Node::kInner;
  }

  const VoxelMap& map_;
  std::string bytes_;
  std::uint64_t nodes_ = 0;
};

}  // namespace

OctoMapFile octomap_file(const VoxelMap& map) {
  OctoMapFile file;
  std::vector<Placed> blocks;
  for (const VoxelIndex& corner : map.changed_after(0)) {
    if (has_key(corner)) {
      blocks.push_back({morton(corner), corner});
    } else {
      ++file.left_out;
    }
  }
  std::sort(blocks.begin(), blocks.end(), [](const Placed& a, const Placed& b) { return a.code < b.code; });
  TreeWriter tree(map);
  const bool any = tree.write(blocks, 0) == Node::kInner;
  file.bytes = fmt::format(
      "# Octomap OcTree binary file\n# x east, y north, z up, metres\n#\nid OcTree\nsize {}\nres {}\ndata\n",
      any ? tree.nodes() : 0, map.voxel_m());
  if (any) file.bytes += tree.bytes();
  return file;
}

std::string ply_file(const VoxelMap& map) {
  std::string points;
  std::uint64_t count = 0;
  for_each_seen(map, [&](const VoxelIndex& v) {
    if (map.space(v) != Space::kOccupied) return;
    const Eigen::Vector3d p = map.centre_of(v);
    for (const double value : {p.y(), p.x(), -p.z(), map.probability(v)}) {
      const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
      for (int byte = 0; byte < 4; ++byte) points += static_cast<char>(bits >> 8 * byte & 0xFF);
    }
    ++count;
  });
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\ncomment x east, y north, z up, metres; voxels of {} m\nelement "
             "vertex "
             "{}\nproperty float x\nproperty float y\nproperty float z\nproperty float probability\nend_header\n",
             map.voxel_m(), count) +
         points;
}

}  // namespace isobath

// Voxel maps as files: byte for byte what OctoMap's own library writes for the same voxels (bytes stated, made once
// with liboctomap 1.9.7), and trees and points read back by their published layouts.
#include <cstring>
#include <gmock/gmock.h>
#include <isobath/base/random.hpp>
#include <isobath/io/exports/voxel_files.hpp>
#include <map>

namespace isobath {
namespace {

using testing::HasSubstr;

VoxelMap map_of(double voxel_m) {
  VoxelMapConfig config;
  config.voxel_m = voxel_m;
  return VoxelMap(config);
}

std::string payload(const std::string& file, const std::string& mark) {
  return file.substr(file.find(mark) + mark.size());
}

TEST(VoxelFiles, AreWhatOctoMapWritesForTwoVoxels) {
  VoxelMap map = map_of(0.1);
  // x east 2.05, y north -0.95, z up 0.55: occupied; x 1.95: free.
  map.layer("sonar").add({-10, 20, -6}, to_evidence(5));
  map.layer("sonar").add({-10, 19, -6}, to_evidence(-5));
  const OctoMapFile file = octomap_file(map);
  EXPECT_THAT(file.bytes, testing::StartsWith("# Octomap OcTree binary file\n"));
  EXPECT_THAT(file.bytes, HasSubstr("\nid OcTree\nsize 20\nres 0.1\ndata\n"));
  const unsigned char expected[] = {0x00, 0x0C, 0x30, 0x00, 0x30, 0x00, 0x30, 0x00, 0x30, 0x00, 0x30, 0x00,
                                    0x30, 0x00, 0x30, 0x00, 0x30, 0x00, 0x30, 0x00, 0x30, 0x00, 0xC0, 0x00,
                                    0x03, 0x00, 0x00, 0xF0, 0xC0, 0x00, 0x00, 0x04, 0x30, 0x00, 0x00, 0x02};
  const std::string bytes = payload(file.bytes, "data\n");
  ASSERT_EQ(bytes.size(), sizeof expected);
  EXPECT_EQ(std::memcmp(bytes.data(), expected, sizeof expected), 0);
  EXPECT_EQ(file.left_out, 0u);
}

using Leaves = std::map<std::array<int, 3>, bool>;  // by key at depth 16: whether it is occupied

std::size_t read_tree(const std::string& bytes, std::size_t at, std::array<int, 3> low, int side, Leaves& leaves) {
  const auto word = static_cast<unsigned>(static_cast<unsigned char>(bytes.at(at)) |
                                          static_cast<unsigned char>(bytes.at(at + 1)) << 8);
  at += 2;
  const int half = side / 2;
  for (int i = 0; i < 8; ++i) {
    std::array<int, 3> corner = low;
    for (std::size_t a = 0; a < 3; ++a) corner[a] += (i >> a & 1) * half;
    const unsigned kind = word >> 2 * i & 3;
    if (kind == 3) at = read_tree(bytes, at, corner, half, leaves);
    if (kind != 1 && kind != 2) continue;
    for (int x = 0; x < half; ++x) {
      for (int y = 0; y < half; ++y) {
        for (int z = 0; z < half; ++z) leaves[{corner[0] + x, corner[1] + y, corner[2] + z}] = kind == 2;
      }
    }
  }
  return at;
}

TEST(VoxelFiles, ReadBackAsTheyWereWithLeavesOfAllSizes) {
  Random random(4);
  VoxelMap map = map_of(0.25);
  VoxelBlocks& layer = map.layer("sonar");
  std::map<std::array<int, 3>, bool> expected;
  const auto put = [&](const VoxelIndex& v, bool occupied) {
    layer.add(v, to_evidence(occupied ? 6 : -6));
    expected[{v.y() + 32768, v.x() + 32768, -v.z() - 1 + 32768}] = occupied;
  };
  for (int n = 0; n < 300; ++n) {
    VoxelIndex v;
    for (int a = 0; a < 3; ++a) v[a] = static_cast<int>(random.index(200)) - 100;
    if (layer.at(v) == kUnseen) put(v, random.uniform() < 0.5);
  }
  for (int i = 0; i < 16; ++i) {  // a whole block, and half of another
    for (int j = 0; j < 16; ++j) {
      for (int k = 0; k < 16; ++k) {
        put({i + 320, j - 160, k + 32}, false);
        if (k < 8) put({i - 320, j + 16, k - 160}, true);
      }
    }
  }
  layer.add({1, 1, 1}, to_evidence(0.5));  // neither free nor occupied
  const std::string bytes = payload(octomap_file(map).bytes, "data\n");
  Leaves leaves;
  EXPECT_EQ(read_tree(bytes, 0, {0, 0, 0}, 65536, leaves), bytes.size());
  expected.erase({1 + 32768, 1 + 32768, -2 + 32768});
  leaves.erase({1 + 32768, 1 + 32768, -2 + 32768});
  EXPECT_EQ(leaves, expected);
}

TEST(VoxelFiles, OfAnEmptyMapAreEmptyAndOfAFarOneSaySo) {
  VoxelMap map = map_of(1);
  EXPECT_THAT(octomap_file(map).bytes, HasSubstr("size 0\n"));
  EXPECT_THAT(ply_file(map), HasSubstr("element vertex 0\n"));
  map.layer("sonar").add({40'000, 0, 0}, to_evidence(5));
  EXPECT_EQ(octomap_file(map).left_out, 1u);
}

TEST(VoxelFiles, HoldTheOccupiedVoxelsAsPoints) {
  VoxelMap map = map_of(0.5);
  map.layer("sonar").add({4, -7, 10}, to_evidence(6));
  map.layer("sonar").add({5, -7, 10}, to_evidence(-6));
  const std::string file = ply_file(map);
  EXPECT_THAT(file, testing::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(file, HasSubstr("element vertex 1\n"));
  const std::string bytes = payload(file, "end_header\n");
  float point[4];
  ASSERT_EQ(bytes.size(), sizeof point);
  std::memcpy(point, bytes.data(), sizeof point);
  EXPECT_FLOAT_EQ(point[0], -3.25f);
  EXPECT_FLOAT_EQ(point[1], 2.25f);
  EXPECT_FLOAT_EQ(point[2], -5.25f);
  EXPECT_NEAR(point[3], 1 / (1 + std::exp(-6.0)), 1e-3);
}

}  // namespace
}  // namespace isobath

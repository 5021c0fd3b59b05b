// Voxels for OpenVDB, read back with OpenVDB's own reader: every value in its place, and nothing else.
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/base/random.hpp>
#include <isobath/io/exports/voxel_vdb.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <openvdb/openvdb.h>
#include <sstream>

namespace isobath {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;
namespace fs = std::filesystem;

VoxelMap vdb_map() {
  VoxelMapConfig config;
  config.voxel_m = 0.5;
  config.prior = 0.2;
  VoxelMap map(config);
  Random random(3);
  for (int i = 0; i < 4000; ++i) {
    VoxelIndex v;
    for (int a = 0; a < 3; ++a) v[a] = static_cast<int>(random.index(90)) - 45;
    const auto more = static_cast<LogOdds16>(static_cast<int>(random.index(4000)) - 2000);
    map.layer(i % 3 == 0 ? "upright" : "flat").add(v, more);
  }
  for (int i = 0; i < VoxelBlocks::kVolume; ++i) {  // a block that is alike all through
    map.layer("flat").add(VoxelIndex(160, 160, 160) + VoxelBlocks::place_of(i), -900);
  }
  return map;
}

openvdb::FloatGrid::Ptr read_grid(const fs::path& path) {
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open();
  EXPECT_EQ(file.getGrids()->size(), 1u);
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("log_odds"));
  file.close();
  return grid;
}

TEST(VoxelVdb, HoldsEachVoxelThatWasSeenAndNoOther) {
  ASSERT_TRUE(has_openvdb());
  const fs::path path = fs::path(testing::TempDir()) / "isobath_voxels.vdb";
  const VoxelMap map = vdb_map();
  write_vdb(map, path);
  const auto grid = read_grid(path);
  ASSERT_TRUE(grid);
  std::uint64_t seen = 0;
  const auto reader = grid->getConstAccessor();
  for_each_seen(map, [&](const VoxelIndex& v) {
    ++seen;
    // By the place in space, not by the index: where OpenVDB says that the voxel with this centre is.
    const Eigen::Vector3d centre = map.centre_of(v);
    const openvdb::Vec3d index = grid->worldToIndex({centre.y(), centre.x(), -centre.z()});
    const openvdb::Coord at = openvdb::Coord::round(index);
    ASSERT_NEAR((index - at.asVec3d()).length(), 0, 1e-9);
    ASSERT_TRUE(reader.isValueOn(at));
    ASSERT_FLOAT_EQ(reader.getValue(at), static_cast<float>(map.log_odds(v)));
  });
  EXPECT_EQ(grid->activeVoxelCount(), seen);
  EXPECT_NEAR(grid->background(), std::log(0.2 / 0.8), 1e-6);
  EXPECT_EQ(grid->metaValue<std::string>("sensors"), "upright, flat");
  EXPECT_EQ(grid->metaValue<std::string>("axes"), "x east, y north, z up, metres");
  EXPECT_EQ(grid->metaValue<double>("prior"), 0.2);
  EXPECT_EQ(grid->metaValue<double>("occupied_from"), 0.98);
  EXPECT_EQ(grid->metaValue<double>("free_to"), 0.2);
  fs::remove(path);
}

TEST(VoxelVdb, OfAnEmptyMapIsAnEmptyGrid) {
  const fs::path path = fs::path(testing::TempDir()) / "isobath_empty.vdb";
  write_vdb(VoxelMap(), path);
  EXPECT_EQ(read_grid(path)->activeVoxelCount(), 0u);
  fs::remove(path);
}

TEST(VoxelVdb, IsTheSameFileForTheSameMap) {
  std::array<std::string, 2> files;
  for (std::string& bytes : files) {
    const fs::path path = fs::path(testing::TempDir()) / "isobath_same.vdb";
    write_vdb(vdb_map(), path);
    std::ostringstream all;
    all << std::ifstream(path, std::ios::binary).rdbuf();
    bytes = all.str();
    fs::remove(path);
  }
  EXPECT_GT(files[0].size(), 1000u);
  EXPECT_TRUE(files[0] == files[1]);
}

TEST(VoxelVdb, ThatCannotBeWrittenIsAnError) {
  EXPECT_THAT([] { write_vdb(VoxelMap(), "/no/such/folder/voxels.vdb"); },
              ThrowsMessage<Error>(HasSubstr("voxels.vdb: cannot be written")));
}

}  // namespace
}  // namespace isobath

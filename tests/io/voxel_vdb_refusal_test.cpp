// Voxels for OpenVDB where there is no OpenVDB: this program looks nowhere for the module. Of what is written:
// tests/vdb.
#include <gmock/gmock.h>
#include <isobath/base/error.hpp>
#include <isobath/io/exports/voxel_vdb.hpp>

namespace isobath {
namespace {

TEST(VoxelVdb, IsRefusedWhereTheModuleIsNotFound) {
  if (has_openvdb()) GTEST_SKIP() << "isobath_vdb.so stands in a folder of the system";
  EXPECT_THAT([] { write_vdb(VoxelMap(), "voxels.vdb"); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("voxels.vdb: cannot be written: this program was built "
                                                               "without OpenVDB, or isobath_vdb.so is not found")));
}

}  // namespace
}  // namespace isobath

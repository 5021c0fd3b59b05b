#include <isobath/base/error.hpp>
#include <isobath/io/voxel_vdb.hpp>
#ifdef ISOBATH_HAS_OPENVDB
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <isobath/map/seen_voxels.hpp>
#include <openvdb/openvdb.h>
#endif

namespace isobath {

#ifdef ISOBATH_HAS_OPENVDB

namespace {

openvdb::FloatGrid::Ptr grid_of(const VoxelMap& map) {
  const VoxelMapConfig& config = map.config();
  const auto grid = openvdb::FloatGrid::create(static_cast<float>(std::log(config.prior / (1 - config.prior))));
  const double edge = map.voxel_m();
  const auto place = openvdb::math::Transform::createLinearTransform(edge);
  place->postTranslate(openvdb::Vec3d(edge / 2));
  grid->setTransform(place);
  grid->setName("log_odds");
  std::string sensors;
  for (const std::string& sensor : map.sensors()) sensors += (sensors.empty() ? "" : ", ") + sensor;
  grid->insertMeta("axes", openvdb::StringMetadata("x east, y north, z up, metres"));
  grid->insertMeta("quantity", openvdb::StringMetadata("natural logarithm of the odds that a voxel is occupied"));
  grid->insertMeta("sensors", openvdb::StringMetadata(sensors));
  grid->insertMeta("prior", openvdb::DoubleMetadata(config.prior));
  grid->insertMeta("occupied_from", openvdb::DoubleMetadata(config.occupied));
  grid->insertMeta("free_to", openvdb::DoubleMetadata(config.free));

  auto writer = grid->getAccessor();
  for_each_seen(map, [&](const VoxelIndex& v) {
    writer.setValueOn({v.y(), v.x(), -v.z() - 1}, static_cast<float>(map.log_odds(v)));
  });
  return grid;
}

/// Every archive carries a random tag, a UUID as text, by which OpenVDB tells whether a file was exchanged while parts
/// of it wait to be loaded. Here it is made from the map, so that one map is one file.
void settle_tag(const std::filesystem::path& file, const openvdb::FloatGrid& grid) {
  constexpr int kTagAt = 8 + 4 + 4 + 4 + 1;  // magic, versions of file and library, whether offsets follow
  constexpr std::size_t kTagSize = 36;
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  std::array<char, kTagSize> tag{};
  bytes.seekg(kTagAt).read(tag.data(), kTagSize);
  for (const std::size_t dash : {8u, 13u, 18u, 23u}) {
    if (!bytes || tag[dash] != '-') throw Error("OpenVDB has written a header of a kind that is not known here");
  }
  const std::string own = fmt::format("00000000-0000-0000-0000-{:012x}", grid.activeVoxelCount() & 0xFFFFFFFFFFFF);
  bytes.seekp(kTagAt).write(own.data(), kTagSize);
  bytes.close();
  if (!bytes) throw Error("cannot be written", {file.string()});
}

}  // namespace

bool has_openvdb() { return true; }

void write_vdb(const VoxelMap& map, const std::filesystem::path& file) {
  openvdb::initialize();
  try {
    const openvdb::FloatGrid::Ptr grid = grid_of(map);
    openvdb::io::File(file.string()).write({grid});
    settle_tag(file, *grid);
  } catch (const openvdb::Exception& e) {
    throw Error(fmt::format("cannot be written: {}", e.what()), {file.string()});
  }
}

#else

bool has_openvdb() { return false; }

void write_vdb(const VoxelMap&, const std::filesystem::path& file) {
  throw Error("cannot be written: this program was built without OpenVDB", {file.string()}, {},
              "install libopenvdb-dev and build again");
}

#endif

}  // namespace isobath

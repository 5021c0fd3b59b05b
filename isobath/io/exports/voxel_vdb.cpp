#include <array>
#include <cmath>
#include <dlfcn.h>
#include <fmt/format.h>
#include <fstream>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/exports/vdb/vdb_module.hpp>
#include <isobath/io/exports/voxel_vdb.hpp>
#include <isobath/map/voxel/seen_voxels.hpp>
#include <string>
#include <vector>

namespace isobath {
namespace {

WriteVdb* vdb_writer() {
#ifdef ISOBATH_HAS_OPENVDB
  static WriteVdb* const writer = [] {
    void* module = dlopen("isobath_vdb.so", RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    return module ? reinterpret_cast<WriteVdb*>(dlsym(module, "isobath_write_vdb")) : nullptr;
  }();
  return writer;
#else
  return nullptr;
#endif
}

/// Every archive carries a random tag, a UUID as text. OpenVDB uses it to detect that a file was replaced while parts
/// of it wait to be loaded. This function replaces it by a tag made from the number of voxels, so that the same map
/// gives the same file.
void settle_tag(const std::filesystem::path& file, std::size_t voxels) {
  constexpr int kTagAt = 8 + 4 + 4 + 4 + 1;  // magic, versions of file and library, whether offsets follow
  constexpr std::size_t kTagSize = 36;
  std::fstream bytes(file, std::ios::in | std::ios::out | std::ios::binary);
  std::array<char, kTagSize> tag{};
  bytes.seekg(kTagAt).read(tag.data(), kTagSize);
  for (const std::size_t dash : {8u, 13u, 18u, 23u}) {
    if (!bytes || tag[dash] != '-') throw Error("OpenVDB has written a header of an unknown kind");
  }
  const std::string own = fmt::format("00000000-0000-0000-0000-{:012x}", voxels & 0xFFFFFFFFFFFF);
  bytes.seekp(kTagAt).write(own.data(), kTagSize);
  bytes.close();
  if (!bytes) throw Error("cannot be written", {file.string()});
}

}  // namespace

bool has_openvdb() { return vdb_writer() != nullptr; }

void write_vdb(const VoxelMap& map, const std::filesystem::path& file) {
  WriteVdb* const write = vdb_writer();
  if (!write) {
    throw Error("cannot be written: this program was built without OpenVDB, or isobath_vdb.so is not found",
                {file.string()}, {}, kVdbRemedy);
  }
  const VoxelMapConfig& config = map.config();
  std::string sensors;
  for (const std::string& sensor : map.sensors()) sensors += (sensors.empty() ? "" : ", ") + sensor;
  const std::vector<std::pair<std::string, std::string>> words = {
      {"axes", "x east, y north, z up, metres"},
      {"quantity", "natural logarithm of the odds that a voxel is occupied"},
      {"sensors", sensors}};
  const std::vector<std::pair<std::string, double>> numbers = {
      {"prior", config.prior}, {"occupied_from", config.occupied}, {"free_to", config.free}};
  std::vector<std::array<std::int32_t, 3>> places;
  std::vector<float> values;
  for_each_seen(map, [&](const VoxelIndex& v) {
    places.push_back({v.y(), v.x(), -v.z() - 1});
    values.push_back(static_cast<float>(map.log_odds(v)));
  });
  VdbGrid grid;
  grid.name = "log_odds";
  grid.edge_m = map.voxel_m();
  grid.background = static_cast<float>(std::log(config.prior / (1 - config.prior)));
  grid.words = words;
  grid.numbers = numbers;
  grid.places = places;
  grid.values = values;
  std::string why;
  PendingFile pending(file);
  if (!write(grid, pending.beside().string(), why))
    throw Error(fmt::format("cannot be written: {}", why), {file.string()});
  settle_tag(pending.beside(), places.size());
  pending.complete();
}

}  // namespace isobath

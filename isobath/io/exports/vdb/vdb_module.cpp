#include <exception>
#include <isobath/io/exports/vdb/vdb_module.hpp>
#include <openvdb/openvdb.h>

extern "C" bool isobath_write_vdb(const isobath::VdbGrid& from, const std::string& file, std::string& why) {
  try {
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create(from.background);
    const auto transform = openvdb::math::Transform::createLinearTransform(from.edge_m);
    transform->postTranslate(openvdb::Vec3d(from.edge_m / 2));
    grid->setTransform(transform);
    grid->setName(from.name);
    for (const auto& [name, text] : from.words) grid->insertMeta(name, openvdb::StringMetadata(text));
    for (const auto& [name, number] : from.numbers) grid->insertMeta(name, openvdb::DoubleMetadata(number));
    auto writer = grid->getAccessor();
    for (std::size_t i = 0; i < from.places.size(); ++i) {
      const auto& [x, y, z] = from.places[i];
      writer.setValueOn({x, y, z}, from.values[i]);
    }
    openvdb::io::File(file).write({grid});
    return true;
  } catch (const std::exception& e) {
    why = e.what();
    return false;
  }
}

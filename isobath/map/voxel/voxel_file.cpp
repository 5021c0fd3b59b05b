#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <isobath/map/voxel/voxel_file.hpp>
#include <zlib.h>

namespace isobath {
namespace {

constexpr std::size_t kPlainBytes = kBlockVolume * sizeof(LogOdds16);
static_assert(std::endian::native == std::endian::little, "evidence is stored in its layout in memory");

SqliteSchema voxel_schema() {
  return {"voxel map",
          0x49534f56,  // "ISOV"
          1,
          {R"(CREATE TABLE map(
  only INTEGER PRIMARY KEY CHECK(only = 1), voxel_m REAL NOT NULL, least INTEGER NOT NULL, most INTEGER NOT NULL
) STRICT)",
           R"(CREATE TABLE layer(id INTEGER PRIMARY KEY AUTOINCREMENT, sensor TEXT NOT NULL UNIQUE) STRICT)",
           R"(CREATE TABLE block(
  layer INTEGER NOT NULL REFERENCES layer(id) ON DELETE CASCADE,
  place INTEGER NOT NULL CHECK(place BETWEEN 0 AND 1152921504606846975),
  revision INTEGER NOT NULL CHECK(revision > 0),
  crc32 INTEGER NOT NULL,
  evidence BLOB NOT NULL,
  UNIQUE(layer, place)
) STRICT)"}};
}

enum VoxelQuery : std::size_t {
  kFindMap,
  kMakeMap,
  kLayers,
  kMakeLayer,
  kIndex,
  kReadBlock,
  kWriteBlock,
  kEraseBlock,
  kVoxelQueries
};

std::vector<std::string> voxel_statements() {
  std::vector<std::string> sql(kVoxelQueries);
  sql[kFindMap] = "SELECT voxel_m, least, most FROM map";
  sql[kMakeMap] = "INSERT INTO map VALUES(1, ?, ?, ?)";
  sql[kLayers] = "SELECT id, sensor FROM layer ORDER BY id";
  sql[kMakeLayer] = "INSERT INTO layer(sensor) VALUES(?) RETURNING id";
  sql[kIndex] = "SELECT place, revision FROM block WHERE layer = ?";
  sql[kReadBlock] = "SELECT revision, crc32, evidence FROM block WHERE layer = ? AND place = ?";
  sql[kWriteBlock] =
      "INSERT INTO block(layer, place, revision, crc32, evidence) VALUES(?,?,?,?,?) ON CONFLICT(layer, place) DO "
      "UPDATE SET revision = excluded.revision, crc32 = excluded.crc32, evidence = excluded.evidence";
  sql[kEraseBlock] = "DELETE FROM block WHERE layer = ? AND place = ?";
  return sql;
}

std::int64_t checksum_of(std::int64_t layer, std::uint64_t key, std::uint64_t revision, const LogOdds16* evidence) {
  const std::array<std::uint64_t, 3> head{static_cast<std::uint64_t>(layer), key, revision};
  const uLong of_head = crc32(0, reinterpret_cast<const Bytef*>(head.data()), sizeof head);
  return static_cast<std::int64_t>(crc32(of_head, reinterpret_cast<const Bytef*>(evidence), kPlainBytes));
}

}  // namespace

// A shelf ------------------------------------------------------------------------------------------------------------

void VoxelShelf::read_row(std::uint64_t key, std::span<LogOdds16> evidence) const {
  ISOBATH_ASSERT(evidence.size() == kBlockVolume);
  const auto damaged = [&](const char* how) {
    const VoxelIndex corner = corner_of_block(key);
    return Error(
        fmt::format("the block of voxels at {}, {}, {} is damaged: {}", corner.x(), corner.y(), corner.z(), how),
        {file_.file_.name()}, {}, "move the file away to start anew");
  };
  SqliteUse use = file_.file_.use(kReadBlock);
  if (!use.with(layer_).with(static_cast<std::int64_t>(key)).step()) throw damaged("it is missing");
  const auto revision = static_cast<std::uint64_t>(use.integer());
  const std::int64_t checksum = use.integer();
  const std::span<const std::byte> packed = use.bytes();
  uLongf size = kPlainBytes;
  const int code = uncompress(reinterpret_cast<Bytef*>(evidence.data()), &size,
                              reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size()));
  if (code != Z_OK || size != kPlainBytes) throw damaged("it cannot be unpacked");
  if (revision != revisions_.at(key) || checksum_of(layer_, key, revision, evidence.data()) != checksum) {
    throw damaged("its checksum does not match");
  }
}

void VoxelShelf::write_row(const Block& block) {
  std::array<std::byte, kPlainBytes + kPlainBytes / 8> packed;  // larger than compressBound: see the check
  uLongf size = packed.size();
  const int code = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                             reinterpret_cast<const Bytef*>(block.evidence), kPlainBytes, Z_BEST_SPEED);
  ISOBATH_ASSERT(code == Z_OK);
  file_.file_.use(kWriteBlock)
      .with(layer_)
      .with(static_cast<std::int64_t>(block.key))
      .with(static_cast<std::int64_t>(block.revision))
      .with(checksum_of(layer_, block.key, block.revision, block.evidence))
      .with(std::span<const std::byte>(packed.data(), size))
      .run();
}

LogOdds16 VoxelShelf::at(std::uint64_t key, int offset) const {
  if (!holds(key)) return kUnseen;
  const std::lock_guard lock(file_.reading_);
  std::unique_ptr<Copy>& copy = copy_of(key);
  if (!copy) copy = std::make_unique<Copy>();
  if (copy->key != key) {
    copy->key = ~std::uint64_t{0};  // stays so if the read fails
    read_row(key, copy->evidence);
    copy->key = key;
  }
  return copy->evidence[static_cast<std::size_t>(offset)];
}

void VoxelShelf::read(std::uint64_t key, std::span<LogOdds16> evidence) const {
  const std::lock_guard lock(file_.reading_);
  const std::unique_ptr<Copy>& copy = copy_of(key);
  if (copy && copy->key == key) {
    std::copy(copy->evidence.begin(), copy->evidence.end(), evidence.begin());
  } else {
    read_row(key, evidence);
  }
}

void VoxelShelf::write(std::span<const Block> blocks) {
  if (blocks.empty()) return;
  revisions_.reserve(revisions_.size() + blocks.size());
  file_.transact([&] {
    for (const Block& block : blocks) write_row(block);
  });
  for (const Block& block : blocks) {
    revisions_[block.key] = block.revision;
    if (const auto& copy = copy_of(block.key); copy && copy->key == block.key) copy->key = ~std::uint64_t{0};
  }
}

void VoxelShelf::erase(std::span<const std::uint64_t> keys) {
  if (keys.empty()) return;
  file_.transact([&] {
    for (const std::uint64_t key : keys) {
      file_.file_.use(kEraseBlock).with(layer_).with(static_cast<std::int64_t>(key)).run();
    }
  });
  for (const std::uint64_t key : keys) revisions_.erase(key);
}

std::size_t VoxelShelf::bytes() const {
  const auto copies = std::count_if(copies_.begin(), copies_.end(), [](const auto& copy) { return copy != nullptr; });
  constexpr std::size_t kNode = sizeof(std::uint64_t) * 2 + sizeof(void*);
  return static_cast<std::size_t>(copies) * sizeof(Copy) + revisions_.size() * kNode +
         revisions_.bucket_count() * sizeof(void*);
}

// The file -----------------------------------------------------------------------------------------------------------

VoxelFile::VoxelFile(const std::filesystem::path& path, double voxel_m, const EvidenceBounds& bounds)
    : file_(path, voxel_schema(), voxel_statements()) {
  check_map(voxel_m, bounds);
  read_index();
}

void VoxelFile::check_map(double voxel_m, const EvidenceBounds& bounds) {
  SqliteUse map = file_.use(kFindMap);
  if (!map.step()) {
    file_.use(kMakeMap).with(voxel_m).with(std::int64_t{bounds.least}).with(std::int64_t{bounds.most}).run();
    return;
  }
  const double edge = map.finite("the edge of a voxel");
  const std::int64_t least = map.integer(), most = map.integer();
  if (edge != voxel_m || least != bounds.least || most != bounds.most) {
    throw Error(fmt::format("is a map of voxels of {:g} m with evidence from {} to {}", edge, least, most),
                {file_.name()}, fmt::format("{:g} m, {} to {}", voxel_m, bounds.least, bounds.most),
                "give another file, or the configuration that made it");
  }
}

void VoxelFile::read_index() {
  {
    SqliteUse layers = file_.use(kLayers);
    while (layers.step()) {
      const std::int64_t id = layers.integer();
      shelves_.push_back({layers.text(), std::make_unique<VoxelShelf>(*this, id)});
    }
  }
  for (const Named& named : shelves_) {
    SqliteUse index = file_.use(kIndex);
    index.with(named.shelf->layer_);
    while (index.step()) {
      const auto key = static_cast<std::uint64_t>(index.integer());
      named.shelf->revisions_[key] = static_cast<std::uint64_t>(index.integer());
    }
  }
}

std::vector<std::string> VoxelFile::sensors() const {
  std::vector<std::string> names;
  for (const Named& named : shelves_) names.push_back(named.sensor);
  return names;
}

VoxelShelf& VoxelFile::shelf(std::string_view sensor) {
  for (const Named& named : shelves_) {
    if (named.sensor == sensor) return *named.shelf;
  }
  std::int64_t id = 0;
  transact([&] {
    SqliteUse made = file_.use(kMakeLayer);
    made.with(std::string(sensor));
    while (made.step()) id = made.integer();
  });
  shelves_.push_back({std::string(sensor), std::make_unique<VoxelShelf>(*this, id)});
  return *shelves_.back().shelf;
}

std::uint64_t VoxelFile::revision() const {
  std::uint64_t last = 0;
  for (const Named& named : shelves_) {
    for (const auto& block : named.shelf->revisions_) last = std::max(last, block.second);
  }
  return last;
}

void VoxelFile::transact(const std::function<void()>& change) {
  const std::lock_guard lock(reading_);
  file_.begin();
  try {
    change();
    file_.commit();
  } catch (...) {
    file_.roll_back();
    throw;
  }
}

}  // namespace isobath

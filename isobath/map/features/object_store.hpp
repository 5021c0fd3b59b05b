// ObjectStore: objects and the observations of them, in one SQLite file (Oskard 1990, II; ledger S1-07 S1-08 S1-09
// S1-25).
//
// An object has an identification number of its own, a mask of 32 capabilities, a kind, a name, and a position in W
// (north, east, depth; m) with its covariance (m2). It has attributes, each with a name. Each attribute keeps its
// newest 16 entries (time, value) in the order of time. A full history drops its oldest entry, which may be the new one
// if that arrives too late. A value is a number, a vector, a text or a reference to a shape: a file of the map's folder
// together with its most requested properties.
//
// Spatial trees keep ids; `find` reads exactly the requested records (S1-25). Queries by mask read all objects.
//
// On disk: rollback journal; every commit is flushed before it returns; a crash at any instant leaves the last commit.
// One program at a time: the file stays locked, so that no reader can make the vehicle's writes fail. On opening, the
// schema is compared word for word and every page is checked, so that a foreign or damaged file is refused before
// anything is read from it or written to it. Opening costs about 8 ms for 1000 objects with 16 entries each (0.6 MB)
// and grows with the file. Measured on one core: find 1 us, history of 16 entries 20 us, put 40 us within a
// Transaction.
//
// Errors: throws Error on an unusable file, on a failing disk, on values that are not finite, and on values that name a
// file outside the folder. Not for the mapping path: it allocates, and a commit waits for the disk (some milliseconds
// to some tens), so put many changes into one Transaction. One thread at a time.
#pragma once

#include <cstdint>
#include <Eigen/Core>
#include <filesystem>
#include <isobath/base/error.hpp>
#include <isobath/base/time.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace isobath {

using ObjectId = std::int64_t;

struct MapObject {
  ObjectId id = 0;                 ///< assigned by `create`
  std::uint32_t capabilities = 0;  ///< one bit each
  std::string kind;
  std::string name;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< symmetric; the upper half is kept
};

/// A full 3-D representation in a separate file (S1-09).
struct ShapeReference {
  std::string file;  ///< relative to the map's folder, inside it
  double volume_m3 = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< in the frame of the file, m
  std::int32_t holes = 0;
  bool operator==(const ShapeReference&) const = default;
};

using AttributeValue = std::variant<double, Eigen::Vector3d, std::string, ShapeReference>;

struct AttributeEntry {
  Time time;
  AttributeValue value;
};

class ObjectStore {
 public:
  static constexpr int kEntries = 16;  ///< entries that an attribute keeps

  /// Opens the file, or creates it. Throws Error.
  explicit ObjectStore(const std::filesystem::path& file);
  ObjectStore(ObjectStore&&) noexcept;
  ObjectStore& operator=(ObjectStore&&) noexcept;
  ~ObjectStore();

  /// Applies all changes of its lifetime at once, or none: without `commit` they are undone. Not nested. A change
  /// outside a Transaction is a transaction of its own.
  class Transaction {
   public:
    explicit Transaction(ObjectStore& store);
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    ~Transaction();
    void commit();

   private:
    ObjectStore& store_;
    bool open_ = true;
  };

  /// Ignores `object.id`.
  ObjectId create(const MapObject& object);
  /// These return false if the object does not exist.
  bool update(const MapObject& object);
  bool put(ObjectId id, const std::string& attribute, const AttributeEntry& entry);

  [[nodiscard]] std::optional<MapObject> find(ObjectId id) const;
  /// In the order of `ids`; ids that do not exist are left out.
  [[nodiscard]] std::vector<MapObject> find(std::span<const ObjectId> ids) const;
  /// Ids of the objects that have at least one of the capabilities, in ascending order.
  [[nodiscard]] std::vector<ObjectId> with_any(std::uint32_t mask) const;

  [[nodiscard]] std::vector<std::string> attributes(ObjectId id) const;  ///< names, sorted
  [[nodiscard]] std::optional<AttributeEntry> latest(ObjectId id, const std::string& attribute) const;
  /// In order of time, entries of equal time in order of arrival; empty where there is none.
  [[nodiscard]] std::vector<AttributeEntry> history(ObjectId id, const std::string& attribute) const;

 private:
  struct Database;
  std::unique_ptr<Database> database_;
};

}  // namespace isobath

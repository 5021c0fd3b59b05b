#include <algorithm>
#include <Eigen/Geometry>
#include <isobath/perception/object_label.hpp>
#include <isobath/world/found_objects.hpp>
#include <isobath/world/map_features.hpp>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr const char* kSouthWest = "south-west";
constexpr const char* kNorthEast = "north-east";

Vector3d corner_at(const Eigen::Vector2d& p) { return {p.x(), p.y(), 0}; }

struct KnownObject {
  MapObject object;
  Eigen::AlignedBox2d extent;
  bool met = false;
};

std::vector<KnownObject> known_objects(const ObjectStore& store) {
  std::vector<KnownObject> known;
  for (const MapObject& object : store.find(store.with_any(kFoundObject))) {
    KnownObject one{object, Eigen::AlignedBox2d(object.p_W.head<2>()), false};
    for (const char* corner : {kSouthWest, kNorthEast}) {
      const auto entry = store.latest(object.id, corner);
      const auto* p = entry ? std::get_if<Vector3d>(&entry->value) : nullptr;
      if (p) one.extent.extend(p->head<2>());
    }
    known.push_back(std::move(one));
  }
  return known;
}

/// Labels the object. One miss is enough: the map forgets an obstacle only after many readings.
void label(ObjectStore& store, ObjectId id, Time time) {
  ObjectLabelConfig config;
  config.misses = 1;
  const auto positions = store.history(id, "position"), looks = store.history(id, "seen");
  store.put(id, "label", {time, std::string(to_text(label_object(config, positions, looks)))});
}

/// Enters the attributes. False if there is nothing new.
bool enter(ObjectStore& store, ObjectId id, const ChangedRegion& region, Time seen) {
  const auto last = store.latest(id, "depth");
  if (last && last->time >= seen && last->value == AttributeValue(region.shoalest_m)) return false;
  store.put(id, "depth", {seen, region.shoalest_m});
  store.put(id, "position", {seen, Vector3d(region.shoalest_at.x(), region.shoalest_at.y(), region.shoalest_m)});
  store.put(id, kSouthWest, {seen, corner_at(region.south_west)});
  store.put(id, kNorthEast, {seen, corner_at(region.north_east)});
  store.put(id, "last seen", {seen, to_text(seen)});
  store.put(id, "seen", {seen, 1.0});
  label(store, id, seen);
  return true;
}

}  // namespace

FoundObjects store_found(ObjectStore& store, const MapChanges& changes, const MapFacts& facts, Time now) {
  FoundObjects found;
  ObjectStore::Transaction all(store);
  std::vector<KnownObject> known = known_objects(store);
  const double pixel = facts.area.grid.pixel_m;
  for (const ChangedRegion& region : changes.regions) {
    if (!region.is_obstacle()) continue;
    const Time seen = facts.epoch + std::chrono::minutes(region.last_minute);
    MapObject object;
    object.capabilities = kFoundObject | kBlocksPassage;
    object.kind = "obstacle";
    object.p_W = {region.shoalest_at.x(), region.shoalest_at.y(), region.shoalest_m};
    object.covariance.diagonal().head<2>().setConstant(pixel * pixel / 12);
    const Eigen::Vector2d touch = Eigen::Vector2d::Constant(pixel);
    const Eigen::AlignedBox2d extent(region.south_west - touch, region.north_east + touch);
    ObjectId same = 0;
    for (KnownObject& one : known) {  // in the order of their ids: the oldest first
      if (one.met || !extent.intersects(one.extent)) continue;
      one.met = true;
      if (same == 0) {
        object.id = same = one.object.id;
        object.name = one.object.name;
        store.update(object);
        continue;
      }
      one.object.capabilities = 0;
      store.update(one.object);
      store.put(one.object.id, "merged into", {seen, static_cast<double>(same)});
    }
    found.met_again += same != 0 ? 1 : 0;
    found.met_first += same == 0 ? 1 : 0;
    enter(store, same != 0 ? same : store.create(object), region, seen);
  }
  for (KnownObject& one : known) {
    if (one.met || (one.object.capabilities & kBlocksPassage) == 0) continue;
    one.object.capabilities &= ~kBlocksPassage;
    store.update(one.object);
    store.put(one.object.id, "seen", {now, 0.0});
    label(store, one.object.id, now);
    ++found.gone;
  }
  all.commit();
  return found;
}

}  // namespace isobath

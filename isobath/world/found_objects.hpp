// FoundObjects: stores the obstacles that sonar has found as objects of a map, so that each mission meets the same
// obstacle as the same object (ledger S1-06, S1-07, S1-08, S1-26).
//
// A region that find_changes calls an obstacle is matched to the object whose last extent it meets. Otherwise it
// becomes a new object: kind "obstacle", capabilities kFoundObject and kBlocksPassage, at its shoalest point. Whenever
// a sonar has seen it again, new values of its attributes are entered: "depth" (m), "position", "south-west" and
// "north-east" (of its extent), "last seen", "seen" (1; 0 once the map no longer holds it, and then it no longer blocks
// passages), "label" (object_label). Where two objects have grown into one region, the older one continues; the younger
// one keeps its history, and gets "merged into".
#pragma once

#include <isobath/map/features/object_store.hpp>
#include <isobath/world/map_changes.hpp>

namespace isobath {

struct FoundObjects {
  std::size_t met_first = 0, met_again = 0, gone = 0;
};

/// Works in one transaction. `now`: the time of the map's last reading.
FoundObjects store_found(ObjectStore& store, const MapChanges& changes, const MapFacts& facts, Time now);

}  // namespace isobath

// Obstacles that sonar has found, as objects of a map: each mission meets the same obstacle as the same object (ledger
// S1-06, S1-07, S1-08, S1-26).
//
// A region that find_changes calls an obstacle is the object whose last extent it meets, else a new one: kind
// "obstacle", capabilities kFoundObject and kBlocksPassage, its shoalest place. Attributes, entered anew whenever a
// sonar has spoken of it again: "depth" (m), "position", "south-west" and "north-east" (of its extent), "last seen",
// "seen" (1; 0 once the map no longer holds it, which also lets passages through), "label" (object_label). Where two
// objects have grown into one region the older lives on; the younger keeps its history, and "merged into".
#pragma once

#include <isobath/map/object_store.hpp>
#include <isobath/runtime/map_changes.hpp>

namespace isobath {

struct FoundObjects {
  std::size_t met_first = 0, met_again = 0, gone = 0;
};

/// In one transaction. `now`: the time of the map's last reading.
FoundObjects store_found(ObjectStore& store, const MapChanges& changes, const MapFacts& facts, Time now);

}  // namespace isobath

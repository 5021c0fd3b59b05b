// Echoes for a slow link: several beams and bins become one sample, the loudest, so that a ping takes no more bytes
// than the link carries soon. A sample counts as detected if one of its parts was. Bytes 4 and 5 of the payload say how
// many beams and bins a sample has (docs/live-page.md, kind 5).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace isobath {

struct ThinnedEchoes {
  static constexpr std::size_t kMostEach = 8;  ///< beams, and bins, of a sample

  std::string records;
  bool thinned = false;  ///< a ping had more than `max_bytes`
};

/// The same records, with echoes of more than `max_bytes` thinned to that, at most by kMostEach each way.
ThinnedEchoes thinned_echoes(std::string_view records, std::size_t max_bytes);

}  // namespace isobath

// Frames with a truth of their own, for calibration: which cells hold a real echo was marked by hand.
//
// In the sets of a frame folder (frame_folder.hpp), "<time>_raw.png" with "<time>_annotated.png" beside it is a marked
// frame: the mask's first channel is 255 in cells that hold a true return. So is a frame with annotations of LabelMe
// beside it (polygon_marks.hpp): "<name>.json" or "<name>.xml", without "_raw" or with it. Any other frame is
// background: water without a target. Errors: an unreadable frame, mask or annotation, sizes that disagree, or no frame
// at all throw Error: a calibration must not lose data.
#pragma once

#include <filesystem>
#include <isobath/io/open.hpp>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

struct MarkedFrame {
  Ping ping;
  bool background = false;           ///< no target anywhere; `marked` is empty
  std::vector<std::uint8_t> marked;  ///< beams x bins, 1 where marked: marked[beam * bins + bin]
};

/// All sets of the folder, or the one that InputConfig::set names; by set, then by time.
std::vector<MarkedFrame> read_marked_frames(const std::filesystem::path& folder, const InputConfig& config);

}  // namespace isobath

// Frames with ground truth for calibration: the cells with a real echo are marked by hand.
//
// In the sets of a frame folder (frame_folder.hpp), "<time>_raw.png" with "<time>_annotated.png" beside it is a marked
// frame: the mask's first channel is 255 in cells that hold a true return. A frame with LabelMe annotations beside it
// (polygon_marks.hpp) is a marked frame too: "<name>.json" or "<name>.xml", with or without "_raw". Any other frame is
// background: water without a target. Errors: throws Error on an unreadable frame, mask or annotation, on sizes that
// disagree, and if there is no frame at all, because a calibration must not lose data.
#pragma once

#include <filesystem>
#include <isobath/io/input/input_config.hpp>
#include <isobath/sonar/ping.hpp>
#include <vector>

namespace isobath {

struct MarkedFrame {
  Ping ping;
  bool background = false;           ///< no target anywhere; `marked` is empty
  std::vector<std::uint8_t> marked;  ///< beams x bins, 1 where marked: marked[beam * bins + bin]
};

/// The frames of all sets of the folder, or of the set that InputConfig::set names; by set, then by time.
std::vector<MarkedFrame> read_marked_frames(const std::filesystem::path& folder, const InputConfig& config);

}  // namespace isobath

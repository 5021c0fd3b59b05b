// Folders of polar sonar frames: one PNG per ping, with a geometry file (frame_geometry.hpp) in the folder or above it.
//
// A folder holds frames itself, or sets of frames in subfolders. InputConfig::set chooses a set; the default is the
// first by name.
// - Without poses: the name of a frame is its time in microseconds since 1970, "<time>.png" or "<time>_raw.png".
//   "<time>_annotated.png" are masks (marked_frames.hpp) and give no pings. The sonar's heading is
//   InputConfig::mount_heading.
// - With poses: "<set>.csv" beside the folder "<set>" has one line per frame, as in the HoloOcean recordings: frame,
//   pass, t_s, position sx sy sz and rotation s00 .. s22 of the sonar, vx vy vz and v00 .. v22 of the vehicle, velx
//   vely velz. Its world has x, y, z up: x becomes east, y north, -z down; forward-port-up axes become
//   forward-starboard-down. A Navigation precedes each ping, and X_BS = X_WB^-1 X_WS. Each pass restarts the clock:
//   InputConfig::pass chooses one; the default is the first.
// One frame is in memory at a time. A frame that cannot be read or has another size is rejected, counted and skipped.
// Errors: throws Error if there is no geometry, no such set or pass, or no frame at all.
#pragma once

#include <filesystem>
#include <isobath/event/event.hpp>
#include <isobath/io/frames/frame_geometry.hpp>
#include <isobath/io/input/input_config.hpp>
#include <memory>
#include <string>
#include <vector>

namespace isobath {

bool looks_like_frame_folder(const std::filesystem::path& folder);
std::unique_ptr<Source> open_frame_folder(const std::filesystem::path& folder, const InputConfig& config);

/// One set of frames on disk.
struct FrameSet {
  std::string name;
  std::filesystem::path folder;
  std::filesystem::path poses;  ///< empty: none
};

/// All sets of a folder by name, and the geometry of their frames.
struct FrameLayout {
  std::vector<FrameSet> sets;
  FrameGeometry geometry;
};
/// Throws Error.
FrameLayout frame_layout(const std::filesystem::path& folder, const InputConfig& config);

/// PNG files of a folder by name.
std::vector<std::filesystem::path> frames_in(const std::filesystem::path& folder);

/// The time in a name such as "1468966397006010.png" or "1468966397006010_raw.png"; empty for any other name.
std::optional<Time> time_of_frame(const std::filesystem::path& frame);

}  // namespace isobath

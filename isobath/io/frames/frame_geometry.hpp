// FrameGeometry: what the pixels of a polar sonar frame mean. Columns are beams, rows are range bins.
//
// A folder of your own frames describes them in `geometry.json`:
//   {"beams": 96, "bins": 512,                  columns and rows of every frame
//    "range_min_m": 2.25, "range_max_m": 11.25, near edge of the first bin, far edge of the last bin
//    "azimuths_deg": [-14.7, ..., 14.1],        centre of each column, clockwise seen from above, rising or falling; or
//    "fov_deg": 28.8, "first_column": "port",   columns of equal width, from "port" (default) or from "starboard"
//    "height_deg": 14, "width_deg": 0.3,        full -3 dB beam widths; width_deg defaults to the beam spacing
//    "near_row": "top",                         position of the nearest bin: "top" (default) or "bottom"
//    "full_scale": 255}                         value of a saturated sample; default 255 or 65535 by the sample size
// The geometry files of the DIDSON frames of Teixeira et al. (IROS 2018) are accepted too: min_range, max_range (m),
// num_beams, num_bins, fov (rad), azimuths (rad). Errors: parse_frame_geometry throws Error with the key. A frame of
// another size gives no ping.
#pragma once

#include <isobath/event/event.hpp>
#include <isobath/io/frames/gray_image.hpp>
#include <isobath/io/input/input_config.hpp>
#include <isobath/sonar/ping.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace isobath {

struct FrameGeometry {
  static constexpr int kMaxBeams = 8192;
  static constexpr int kMaxBins = 32768;

  std::shared_ptr<const BeamFan> fan;
  RangeWindow window;
  bool first_column_is_starboard = false;
  bool near_row_is_bottom = false;
  std::optional<float> full_scale;
};

/// Whether the text is a geometry file of either format.
bool looks_like_frame_geometry(std::string_view json);
FrameGeometry parse_frame_geometry(std::string_view json, const std::string& file);

/// The geometry of the imaging sonar of the HoloOcean recordings, whose folders have poses but no geometry file: 512
/// bins over 0 to 8 m, 96 beams of 0.3 degrees, 14 degrees high, first column to starboard.
FrameGeometry simulated_frame_geometry();

/// Replaces beam width and height by those of the configuration where they are not zero.
FrameGeometry with_overrides(FrameGeometry geometry, const InputConfig& config);

/// The frame as a ping, without time and mounting; empty if the sizes disagree. The ping keeps the image alive.
std::optional<Ping> ping_from_frame(const FrameGeometry& geometry, GrayImage image, const InputConfig& config);

}  // namespace isobath

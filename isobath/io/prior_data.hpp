// What a prior holds, and how its file is to be read; prior.hpp says what each number means.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/smooth_surface.hpp>
#include <isobath/map/pixel_grid.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

enum class PriorSign : std::uint8_t { kAutomatic, kUp, kDown };

struct PriorConfig {
  PriorSign sign = PriorSign::kAutomatic;
  double unit_m = 0;                   ///< length of the file's unit of depth; 0: as the file says, else metres
  std::string datum;                   ///< of the file, where it does not say so itself or is wrong
  std::string map_datum;               ///< of the map's depths; empty: the water surface of the day
  std::vector<double> datum_offset_m;  ///< one number: depth in the map less depth in the file; empty: not known
  double datum_offset_sigma_m = 0;
  int epsg = 0;                 ///< horizontal system, in place of the file's; 0: the file's
  std::vector<double> no_data;  ///< values that mean nothing, beside those that the file names and the customary ones
  double least_depth_m = -20;   ///< plausible depths, before the offset
  double greatest_depth_m = 12000;
  Merge pixels = Merge::kMean;  ///< what stands for several cells or soundings of one pixel
  double sigma_m = 0.5;         ///< of files that say nothing: sigma_m + sigma_share * depth
  double sigma_share = 0.01;
  double farthest_m = 200;  ///< from any sounding (on charts at least 25 mm of paper): beyond it a surface says nothing
  std::string x_column;     ///< of text: name, or number from 1; east or longitude
  std::string y_column;     ///< north or latitude
  std::string z_column;     ///< depth or height
  std::string run_column;   ///< soundings of one run share its errors
  double most_cells = 4e8;  ///< of a raster that one call may read
};

std::vector<Field> fields(PriorConfig& config);

struct PriorWindow {
  PixelGrid grid;
  std::int32_t columns = 0;  ///< both 0: all that the file covers, aligned to the grid
  std::int32_t rows = 0;
};

/// Row-major from the north-west; NaN where nothing is known.
struct PriorRaster {
  PriorWindow window;
  std::vector<float> depth_m;
  std::vector<float> sigma_m;

  [[nodiscard]] std::size_t index(Pixel p) const {
    return static_cast<std::size_t>(p.row) * static_cast<std::size_t>(window.columns) +
           static_cast<std::size_t>(p.column);
  }
};

enum class PriorPointKind : std::uint8_t { kObstruction, kWreck, kRock, kPile, kLand };
const char* to_text(PriorPointKind kind);

struct PriorPoint {
  PriorPointKind kind = PriorPointKind::kObstruction;
  Eigen::Vector2d north_east{0, 0};
  std::optional<double> depth_m;     ///< of its top; negative: stands out of the water
  std::optional<double> clear_to_m;  ///< swept: nothing stands above this depth
  double sigma_m = 0;                ///< of either
  std::string name;
  std::map<std::string, std::string> attributes;  ///< as the file names them
};

enum class PriorLineKind : std::uint8_t { kCoast, kContour, kPipeline, kStructure, kObstruction };
const char* to_text(PriorLineKind kind);

struct PriorLine {
  PriorLineKind kind = PriorLineKind::kCoast;
  std::vector<Eigen::Vector2d> points;
  std::optional<double> depth_m;
  std::string name;
};

enum class PriorAreaKind : std::uint8_t { kDepth, kDredged, kLand, kWater, kStructure, kObstruction };
const char* to_text(PriorAreaKind kind);

struct PriorArea {
  PriorAreaKind kind = PriorAreaKind::kDepth;
  std::vector<Polygon> rings;  ///< the outline and the holes in it, in either sense
  std::optional<double> least_depth_m;
  std::optional<double> greatest_depth_m;
  std::string name;
};

struct Prior {
  std::string source;  ///< the file
  std::string format;  ///< "S-57 chart"
  std::string datum;   ///< of the file
  PriorRaster raster;
  std::vector<SurveyPoint> soundings;  ///< as read, of scattered sources
  std::vector<PriorPoint> points;
  std::vector<PriorLine> lines;
  std::vector<PriorArea> areas;
  std::map<std::string, std::uint64_t> read;      ///< cells, soundings or objects by class
  std::map<std::string, std::uint64_t> left_out;  ///< by reason
  std::map<std::string, std::string> details;     ///< scale, edition, what the library complained about
};

}  // namespace isobath

// The contents of a prior and the configuration of its reader. read_prior.hpp explains the quantities.
#pragma once

#include <cstdint>
#include <isobath/base/config.hpp>
#include <isobath/geometry/polygon.hpp>
#include <isobath/geometry/smooth_surface.hpp>
#include <isobath/map/depth/pixel_grid.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

enum class PriorSign : std::uint8_t { kAutomatic, kUp, kDown };

struct PriorConfig {
  PriorSign sign = PriorSign::kAutomatic;
  double unit_m = 0;                   ///< length of the file's unit of depth; 0: as the file states, else metres
  std::string datum;                   ///< datum of the file, if it states none or a wrong one
  std::string map_datum;               ///< datum of the map's depths; empty: the water surface of the day
  std::vector<double> datum_offset_m;  ///< one number: depth in the map less depth in the file; empty: unknown
  double datum_offset_sigma_m = 0;
  int epsg = 0;                 ///< horizontal coordinate system; 0: that of the file
  std::vector<double> no_data;  ///< no-data values, in addition to those that the file names and the usual ones
  double min_depth_m = -20;     ///< minimum plausible depth, before the offset
  double max_depth_m = 12000;
  Merge pixels = Merge::kMean;  ///< how several cells or soundings of one pixel are combined
  double sigma_m = 0.5;         ///< for files without sigma: sigma_m + sigma_share * depth
  double sigma_share = 0.01;
  double max_distance_m = 200;  ///< maximum distance of a surface from a sounding (on charts at least 25 mm of paper)
  std::string x_column;         ///< column of text, by name or number from 1: east or longitude
  std::string y_column;         ///< north or latitude
  std::string z_column;         ///< depth or height
  std::string run_column;       ///< survey run; soundings of one run share its errors
  double max_cells = 4e8;       ///< maximum cells of a raster that one call reads
};

std::vector<Field> fields(PriorConfig& config);

struct PriorWindow {
  PixelGrid grid;
  std::int32_t columns = 0;  ///< both 0: the whole area of the file, aligned to the grid
  std::int32_t rows = 0;
};

/// Row-major from the north-west; NaN: unknown.
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
  std::optional<double> depth_m;     ///< depth of its top; negative: above the water
  std::optional<double> clear_to_m;  ///< swept depth: no object reaches above it
  double sigma_m = 0;                ///< standard deviation of either depth
  std::string name;
  std::map<std::string, std::string> attributes;  ///< with the names of the file
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
  std::vector<Polygon> rings;  ///< the outline and its holes, in either direction
  std::optional<double> min_depth_m;
  std::optional<double> max_depth_m;
  std::string name;
};

struct Prior {
  std::string source;  ///< the file
  std::string format;  ///< "S-57 chart"
  std::string datum;   ///< vertical datum of the file
  PriorRaster raster;
  std::vector<SurveyPoint> soundings;  ///< as read, for scattered sources
  std::vector<PriorPoint> points;
  std::vector<PriorLine> lines;
  std::vector<PriorArea> areas;
  std::map<std::string, std::uint64_t> read;      ///< counts of cells, soundings or objects, by class
  std::map<std::string, std::uint64_t> left_out;  ///< counts by reason
  std::map<std::string, std::string> details;     ///< scale, edition, warnings of the library
};

}  // namespace isobath

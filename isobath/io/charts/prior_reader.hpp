// Shared by the readers of priors: the current job, the mapping from a file's coordinates to the plane, and the
// conversion of soundings and polygons to pixels. Internal; users of the library include read_prior.hpp.
#pragma once

#include <functional>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/charts/prior_data.hpp>
#include <isobath/io/gdal/gdal_session.hpp>
#include <memory>

class GDALDataset;
class OGRSpatialReference;

namespace isobath {

struct DatasetCloser {
  void operator()(GDALDataset* data) const;
};
using Dataset = std::unique_ptr<GDALDataset, DatasetCloser>;

struct PriorJob {
  std::string file;
  const PriorConfig& config;
  const LocalPlane& plane;
  PriorWindow wanted;
  GdalSession& gdal;

  [[noreturn]] void refuse(const std::string& problem, const std::string& advice = {}) const;
  /// Metres per unit of depth, if the file states `unit_m` (0: nothing stated).
  [[nodiscard]] double unit(double unit_m) const { return config.unit_m > 0 ? config.unit_m : unit_m > 0 ? unit_m : 1; }
  [[nodiscard]] bool plausible(double depth_m) const {
    return depth_m >= config.min_depth_m && depth_m <= config.max_depth_m;
  }
  [[nodiscard]] double default_sigma(double depth_m) const {
    return config.sigma_m + config.sigma_share * std::abs(depth_m);
  }
};

/// Opens shapes that a person drew; refuses what is no GeoJSON, shapefile or GeoPackage. `of`: "areas".
Dataset open_drawing(const PriorJob& job, const std::string& of);

/// Converts between a horizontal coordinate system and the plane of W.
class PlaneMapping {
 public:
  /// `system` may be null if an EPSG code is configured. Refuses systems that cannot be converted to WGS 84.
  PlaneMapping(const PriorJob& job, const OGRSpatialReference* system);
  /// For files in the metres of W: x east, y north.
  static PlaneMapping of_plane(const LocalPlane& plane);
  /// For files in degrees: x is longitude, y is latitude on WGS 84.
  static PlaneMapping of_degrees(const PriorJob& job);
  ~PlaneMapping();
  PlaneMapping(PlaneMapping&&) noexcept;
  PlaneMapping& operator=(PlaneMapping&&) noexcept;

  [[nodiscard]] bool geographic() const;
  /// Converts (x, y) of the file to (north, east); empty if that is impossible.
  [[nodiscard]] std::optional<Eigen::Vector2d> to_plane(double x, double y) const;
  /// Converts (north, east) to (x, y) of the file.
  [[nodiscard]] std::optional<Eigen::Vector2d> from_plane(const Eigen::Vector2d& north_east) const;

 private:
  struct Parts;
  explicit PlaneMapping(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// The requested window, or the window over the area between two corners (north, east) if none was requested. Refuses
/// a window that does not overlap the area, or that has too many pixels.
PriorWindow window_over(const PriorJob& job, const Eigen::Vector2d& low, const Eigen::Vector2d& high);
PriorRaster empty_raster(const PriorWindow& window);

/// +1 if the numbers are positive down, -1 if positive up. `convention` is that of the format. `positive` and
/// `negative` count the signs of the numbers in the file; refuses contradictions.
int depth_sign(const PriorJob& job, PriorSign convention, std::uint64_t positive, std::uint64_t negative);

/// Calls `visit` with the index of every pixel whose centre lies within the rings (even-odd rule).
void fill(const std::vector<Polygon>& rings, const PriorWindow& window, const std::function<void(std::size_t)>& visit);

/// Writes a surface through the soundings into the raster, up to `max_distance_m` from any sounding. Its sigma combines
/// the error estimated from the soundings with `sigma_of` (pixel, depth). Soundings that no pixel needs are ignored.
/// Returns false, and leaves the raster unchanged, for fewer than three soundings or if all are on one line.
bool paint_surface(const PriorJob& job, const std::vector<SurveyPoint>& soundings, double max_distance_m,
                   const std::function<double(std::size_t, double)>& sigma_of, PriorRaster& raster);

/// One reader per family of formats. The caller sets the source and datum of the prior and applies the offset.
struct PriorOfFile {
  Prior prior;
  bool datum_matters = true;
};
PriorOfFile read_raster_prior(const PriorJob& job, GDALDataset& data);
PriorOfFile read_chart_prior(const PriorJob& job, GDALDataset& data);
PriorOfFile read_outline_prior(const PriorJob& job, GDALDataset& data);
PriorOfFile read_text_prior(const PriorJob& job);

}  // namespace isobath

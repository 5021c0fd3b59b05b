// What the readers of priors share: the job in hand, the way from a file's coordinates to the plane, and what turns
// soundings and polygons into pixels. Not for users of the library: see prior.hpp.
#pragma once

#include <functional>
#include <isobath/geometry/geodesy.hpp>
#include <isobath/io/gdal_session.hpp>
#include <isobath/io/prior_data.hpp>
#include <memory>

class GDALDataset;
class OGRSpatialReference;

namespace isobath {

struct PriorJob {
  std::string file;
  const PriorConfig& config;
  const LocalPlane& plane;
  PriorWindow wanted;
  GdalSession& gdal;

  [[noreturn]] void refuse(const std::string& problem, const std::string& advice = {}) const;
  /// Metres per unit of depth, where the file says `unit_m` (0: nothing).
  [[nodiscard]] double unit(double unit_m) const { return config.unit_m > 0 ? config.unit_m : unit_m > 0 ? unit_m : 1; }
  [[nodiscard]] bool plausible(double depth_m) const {
    return depth_m >= config.least_depth_m && depth_m <= config.greatest_depth_m;
  }
  [[nodiscard]] double default_sigma(double depth_m) const {
    return config.sigma_m + config.sigma_share * std::abs(depth_m);
  }
};

/// Between a horizontal system and the plane of W.
class PlaneMapping {
 public:
  /// `system` may be null where an epsg code is configured. Refuses systems that cannot be tied to the globe.
  PlaneMapping(const PriorJob& job, const OGRSpatialReference* system);
  /// W's own metres: x east, y north.
  static PlaneMapping of_plane(const LocalPlane& plane);
  /// x is longitude, y latitude on WGS 84.
  static PlaneMapping of_degrees(const PriorJob& job);
  ~PlaneMapping();
  PlaneMapping(PlaneMapping&&) noexcept;
  PlaneMapping& operator=(PlaneMapping&&) noexcept;

  [[nodiscard]] bool geographic() const;
  /// (x, y) of the file to (north, east); empty where that cannot be.
  [[nodiscard]] std::optional<Eigen::Vector2d> to_plane(double x, double y) const;
  /// (north, east) to (x, y) of the file.
  [[nodiscard]] std::optional<Eigen::Vector2d> from_plane(const Eigen::Vector2d& north_east) const;

 private:
  struct Parts;
  explicit PlaneMapping(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// The window of what lies between two corners (north, east), or the one that was asked for. Refuses where they do not
/// meet, and too many pixels.
PriorWindow window_over(const PriorJob& job, const Eigen::Vector2d& low, const Eigen::Vector2d& high);
PriorRaster empty_raster(const PriorWindow& window);

/// +1 where numbers grow down, -1 where up. `convention` is the format's own. `down` and `up` count the signs of the
/// numbers as they stand in the file; refuses contradictions.
int depth_sign(const PriorJob& job, PriorSign convention, std::uint64_t positive, std::uint64_t negative);

/// Calls `visit` with every pixel whose centre lies within the rings (even-odd).
void fill(const std::vector<Polygon>& rings, const PriorWindow& window, const std::function<void(std::size_t)>& visit);

/// A surface through the soundings into the raster, with the error that they say themselves beside `sigma_of` (of the
/// depth, at a pixel), as far as `farthest_m` from any sounding. Soundings that no pixel needs are passed over. With
/// fewer than three, or all on one line, the raster stays as it is, and false comes back.
bool paint_surface(const PriorJob& job, const std::vector<SurveyPoint>& soundings, double farthest_m,
                   const std::function<double(std::size_t, double)>& sigma_of, PriorRaster& raster);

/// Readers of one family each. The prior has its source; datum, unit and offset are set and applied by the caller.
struct PriorOfFile {
  Prior prior;
  bool datum_matters = true;
};
PriorOfFile read_raster_prior(const PriorJob& job, GDALDataset& data);
PriorOfFile read_chart_prior(const PriorJob& job, GDALDataset& data);
PriorOfFile read_outline_prior(const PriorJob& job, GDALDataset& data);
PriorOfFile read_text_prior(const PriorJob& job);

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/geometry/surface_error.hpp>
#include <isobath/io/charts/prior_reader.hpp>
#include <isobath/map/depth/fill_polygons.hpp>
#include <numbers>
#include <ogr_spatialref.h>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kMaxPixels = 1 << 26;
constexpr double kDegree = std::numbers::pi / 180;

OGRSpatialReference wgs84() {
  OGRSpatialReference globe;
  globe.SetWellKnownGeogCS("WGS84");
  globe.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return globe;
}

using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

}  // namespace

struct PlaneMapping::Parts {
  explicit Parts(const LocalPlane& of) : plane(of) {}
  LocalPlane plane;
  bool local = false;  ///< coordinates are those of W
  bool degrees = false;
  Transformation to_globe, from_globe;
};

PlaneMapping::PlaneMapping(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
PlaneMapping::~PlaneMapping() = default;
PlaneMapping::PlaneMapping(PlaneMapping&&) noexcept = default;
PlaneMapping& PlaneMapping::operator=(PlaneMapping&&) noexcept = default;

PlaneMapping::PlaneMapping(const PriorJob& job, const OGRSpatialReference* system)
    : parts_(std::make_unique<Parts>(job.plane)) {
  OGRSpatialReference own;
  if (job.config.epsg > 0) {
    if (own.importFromEPSG(job.config.epsg) != OGRERR_NONE) {
      job.refuse(fmt::format("there is no coordinate system EPSG:{}", job.config.epsg));
    }
  } else if (!system || system->IsEmpty()) {
    job.refuse("the coordinate system is unknown", "set prior.epsg: 32633 for UTM 33 north, 4326 for WGS 84 degrees");
  } else if (system->IsLocal()) {
    parts_->local = true;
    return;
  } else {
    own = *system;
  }
  own.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (own.IsCompound()) own.StripVertical();  // depths are converted separately
  parts_->degrees = own.IsGeographic() != 0;
  const OGRSpatialReference globe = wgs84();
  parts_->to_globe.reset(OGRCreateCoordinateTransformation(&own, &globe));
  parts_->from_globe.reset(OGRCreateCoordinateTransformation(&globe, &own));
  if (!parts_->to_globe || !parts_->from_globe) {
    job.refuse("its coordinates cannot be converted to WGS 84: " + job.gdal.complaint(), "set prior.epsg");
  }
}

PlaneMapping PlaneMapping::of_plane(const LocalPlane& plane) {
  auto parts = std::make_unique<Parts>(plane);
  parts->local = true;
  return PlaneMapping(std::move(parts));
}

PlaneMapping PlaneMapping::of_degrees(const PriorJob& job) {
  const OGRSpatialReference globe = wgs84();
  return {job, &globe};
}

bool PlaneMapping::geographic() const { return parts_->degrees; }

std::optional<Vector2d> PlaneMapping::to_plane(double x, double y) const {
  if (!std::isfinite(x) || !std::isfinite(y)) return {};
  if (parts_->local) return Vector2d(y, x);
  if (!parts_->to_globe->Transform(1, &x, &y)) return {};
  const GeoPoint point{y, std::remainder(x, 360.0)};
  if (!valid(point)) return {};
  const Vector2d p = parts_->plane.to_plane(point);
  const GeoOrigin& o = parts_->plane.origin();  // the far side of the globe also projects into the plane
  const double a = point.latitude_deg * kDegree, b = o.latitude_deg * kDegree;
  const double apart = std::cos((point.longitude_deg - o.longitude_deg) * kDegree);
  const bool near = std::sin(a) * std::sin(b) + std::cos(a) * std::cos(b) * apart > 0.98;
  return near && p.norm() < 1e6 ? std::optional(p) : std::nullopt;
}

std::optional<Vector2d> PlaneMapping::from_plane(const Vector2d& north_east) const {
  if (parts_->local) return Vector2d(north_east.y(), north_east.x());
  if (!(north_east.norm() < 1e6)) return {};
  const GeoPoint point = parts_->plane.to_geo(north_east);
  double x = point.longitude_deg, y = point.latitude_deg;
  if (!parts_->from_globe->Transform(1, &x, &y)) return {};
  return Vector2d(x, y);
}

PriorWindow window_over(const PriorJob& job, const Vector2d& low, const Vector2d& high) {
  PriorWindow window = job.wanted;
  const PixelGrid& grid = window.grid;
  const auto outside = [&] {
    job.refuse(
        fmt::format("it lies outside the map: north {:.0f} .. {:.0f} m, east {:.0f} .. {:.0f} m of the map's origin",
                    low.x(), high.x(), low.y(), high.y()),
        "check the origin of the map and the file's coordinates (prior.epsg)");
  };
  if (!(low.cwiseAbs().maxCoeff() < 1e6 && high.cwiseAbs().maxCoeff() < 1e6)) outside();
  const double north = grid.corner_m.x(), west = grid.corner_m.y(), px = grid.pixel_m;
  if (window.columns == 0 && window.rows == 0) {
    const double c0 = std::floor((low.y() - west) / px), r0 = std::floor((north - high.x()) / px);
    const double columns = std::floor((high.y() - west) / px) + 1 - c0;
    const double rows = std::floor((north - low.x()) / px) + 1 - r0;
    if (columns * rows > kMaxPixels) {
      job.refuse(fmt::format("{:.0f} x {:.0f} pixels of {} m are too many", columns, rows, px),
                 "ask for a window, or for larger pixels");
    }
    window.grid.corner_m += px * Vector2d(-r0, c0);
    window.columns = static_cast<std::int32_t>(columns);
    window.rows = static_cast<std::int32_t>(rows);
    return window;
  }
  if (static_cast<double>(window.columns) * window.rows > kMaxPixels) job.refuse("the window has too many pixels");
  const bool apart =
      low.x() > north || high.x() < north - window.rows * px || low.y() > west + window.columns * px || high.y() < west;
  if (apart) outside();
  return window;
}

PriorRaster empty_raster(const PriorWindow& window) {
  const std::size_t pixels = static_cast<std::size_t>(window.columns) * static_cast<std::size_t>(window.rows);
  PriorRaster raster{window, {}, {}};
  raster.depth_m.assign(pixels, NAN);
  raster.sigma_m.assign(pixels, NAN);
  return raster;
}

void fill(const std::vector<Polygon>& rings, const PriorWindow& window, const std::function<void(std::size_t)>& visit) {
  fill_polygons(rings, window.grid, {0, 0, window.columns, window.rows}, [&](Pixel p) {
    visit(static_cast<std::size_t>(p.row) * static_cast<std::size_t>(window.columns) +
          static_cast<std::size_t>(p.column));
  });
}

bool paint_surface(const PriorJob& job, const std::vector<SurveyPoint>& soundings, double max_distance_m,
                   const std::function<double(std::size_t, double)>& sigma_of, PriorRaster& raster) {
  const PriorWindow& window = raster.window;
  const double px = window.grid.pixel_m, margin = std::max(max_distance_m, 4 * px);
  const Vector2d north_west = window.grid.corner_m + Vector2d(margin, -margin);
  const Vector2d south_east = window.grid.corner_m + Vector2d(-px * window.rows - margin, px * window.columns + margin);
  std::vector<SurveyPoint> near;
  for (const SurveyPoint& s : soundings) {
    const Vector2d& p = s.north_east;
    if (p.x() <= north_west.x() && p.x() >= south_east.x() && p.y() >= north_west.y() && p.y() <= south_east.y()) {
      near.push_back(s);
    }
  }
  std::optional<SmoothSurface> surface;
  try {
    surface.emplace(merged(near, px, job.config.pixels));
  } catch (const Error&) {
    return false;
  }
  const SurfaceError error(*surface, {}, job.config.sigma_m);
  for (int row = 0; row < window.rows; ++row) {
    for (int column = 0; column < window.columns; ++column) {
      const auto sample = surface->at(window.grid.centre({column, row}));
      if (!sample || sample->distance_m > max_distance_m) continue;
      const std::size_t i = raster.index({column, row});
      raster.depth_m[i] = static_cast<float>(sample->depth_m);
      raster.sigma_m[i] = static_cast<float>(std::hypot(error.sigma_m(*sample), sigma_of(i, sample->depth_m)));
    }
  }
  return true;
}

}  // namespace isobath

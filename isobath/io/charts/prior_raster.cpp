// Reader of depth rasters: works in tiles of the map's pixels and reads the part of the file that each tile needs.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <isobath/base/error.hpp>
#include <isobath/base/lower_case.hpp>
#include <isobath/io/charts/prior_reader.hpp>
#include <isobath/io/charts/raster_meaning.hpp>
#include <isobath/io/charts/raster_resampling.hpp>
#include <isobath/io/gdal/netcdf_size.hpp>
#include <ogr_spatialref.h>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr int kTile = 32;  // pixels; within a tile, the coordinate mapping is linear enough
constexpr double kMaxTileCells = 1 << 22;
constexpr std::array kCustomaryNoData = {-9999.0, -99999.0, -32767.0, -32768.0};

class RasterReading {
 public:
  RasterReading(const PriorJob& job, GDALDataset& data);
  PriorOfFile read();

 private:
  struct Tile {
    int column, row, width, height;
  };
  void check_frame() const;
  [[nodiscard]] std::optional<Vector2d> cell_of(const Vector2d& north_east) const;
  [[nodiscard]] PriorWindow window() const;
  void reserve_cells();
  void read_tile(const Tile& tile);
  void load(RasterPiece& piece);
  void check_cell(const RasterPiece& piece, std::size_t i, float& value, float& sigma);
  [[nodiscard]] double depth_of(float value) const { return sign_ * factor_ * static_cast<double>(value); }
  void settle_sign(PriorSign convention);

  const PriorJob& job_;
  GDALDataset& data_;
  GDALRasterBand* band_;
  GDALRasterBand* sigma_band_ = nullptr;
  std::array<double, 6> place_{}, inverse_{};
  int columns_, rows_;
  PlaneMapping mapping_;
  Prior prior_;
  double factor_ = 1;  ///< metres per unit
  int sign_ = 1;
  std::vector<bool> counted_;  ///< cells that are already counted
  int first_column_ = 0, first_row_ = 0, counted_width_ = 0;
  std::uint64_t positive_ = 0, negative_ = 0;
  double least_ = 1e300, greatest_ = -1e300;
};

RasterReading::RasterReading(const PriorJob& job, GDALDataset& data)
    : job_(job),
      data_(data),
      band_(data.GetRasterBand(1)),
      columns_(data.GetRasterXSize()),
      rows_(data.GetRasterYSize()),
      mapping_(job, data.GetSpatialRef()) {
  if (data.GetGeoTransform(place_.data()) != CE_None || !GDALInvGeoTransform(place_.data(), inverse_.data())) {
    job.refuse("the raster does not state its position");
  }
  for (int i = 2; i <= data.GetRasterCount() && !sigma_band_; ++i) {
    const std::string name = to_lower_case(data.GetRasterBand(i)->GetDescription());
    for (const char* word : {"uncertainty", "sigma", "standard deviation", "stddev"}) {
      if (name.find(word) != std::string::npos) sigma_band_ = data.GetRasterBand(i);
    }
  }
  factor_ = job.unit(metres_of_unit(band_->GetUnitType() ? band_->GetUnitType() : ""));
  check_frame();
}

/// Refuses degrees that are declared as metres, and metres that are declared as degrees.
void RasterReading::check_frame() const {
  double x_most = 0, y_most = 0;
  for (const auto& [c, r] : {std::pair{0, 0}, {columns_, 0}, {0, rows_}, {columns_, rows_}}) {
    x_most = std::max(x_most, std::abs(place_[0] + c * place_[1] + r * place_[2]));
    y_most = std::max(y_most, std::abs(place_[3] + c * place_[4] + r * place_[5]));
  }
  if (mapping_.geographic() && (x_most > 541 || y_most > 91)) {
    job_.refuse("the raster declares degrees, but its coordinates are out of range", "set prior.epsg");
  }
  const OGRSpatialReference* system = data_.GetSpatialRef();
  const char* projection = system ? system->GetAttrValue("PROJECTION") : nullptr;
  const bool about_itself = projection && std::string(projection).find("Azimuthal_Equidistant") != std::string::npos;
  if (projection && !about_itself && !mapping_.geographic() && x_most <= 360 && y_most <= 90) {
    job_.refuse("the raster declares metres, but its coordinates look like degrees", "set prior.epsg = 4326");
  }
}

/// Column and row in the file; whole numbers are the north-west corners of cells.
std::optional<Vector2d> RasterReading::cell_of(const Vector2d& north_east) const {
  auto at = mapping_.from_plane(north_east);
  if (!at) return {};
  if (mapping_.geographic()) {  // longitudes may run from 0 to 360
    const double middle = place_[0] + 0.5 * columns_ * place_[1] + 0.5 * rows_ * place_[2];
    at->x() = middle + std::remainder(at->x() - middle, 360.0);
  }
  return Vector2d(inverse_[0] + inverse_[1] * at->x() + inverse_[2] * at->y(),
                  inverse_[3] + inverse_[4] * at->x() + inverse_[5] * at->y());
}

PriorWindow RasterReading::window() const {
  if (job_.wanted.columns > 0 && job_.wanted.rows > 0) {  // overlap is checked in the raster's own columns and rows
    return window_over(job_, job_.wanted.grid.corner_m, job_.wanted.grid.corner_m);
  }
  Vector2d low = Vector2d::Constant(1e300), high = -low;
  for (int i = 0; i <= 16; ++i) {  // along the border, which projections bend
    for (const auto& [c, r] : {std::pair{i / 16.0, 0.0}, {i / 16.0, 1.0}, {0.0, i / 16.0}, {1.0, i / 16.0}}) {
      const double column = c * columns_, row = r * rows_;
      const auto p = mapping_.to_plane(place_[0] + column * place_[1] + row * place_[2],
                                       place_[3] + column * place_[4] + row * place_[5]);
      if (!p) job_.refuse("it is larger than a local plane", "ask for a window");
      low = low.cwiseMin(*p);
      high = high.cwiseMax(*p);
    }
  }
  return window_over(job_, low, high);
}

/// Finds the part of the file under the window; refuses if it is empty or too large.
void RasterReading::reserve_cells() {
  const PriorWindow& w = prior_.raster.window;
  Vector2d low = Vector2d::Constant(1e300), high = -low;
  for (int i = 0; i <= 16; ++i) {
    for (const auto& [c, r] : {std::pair{i / 16.0, 0.0}, {i / 16.0, 1.0}, {0.0, i / 16.0}, {1.0, i / 16.0}}) {
      const double size = w.grid.pixel_m;
      const auto cell = cell_of(w.grid.corner_m + size * Vector2d(-r * w.rows, c * w.columns));
      if (!cell) continue;
      low = low.cwiseMin(*cell);
      high = high.cwiseMax(*cell);
    }
  }
  const double margin = 2 + kTile / 4.0;
  const double c0 = std::clamp(low.x() - margin, 0.0, double(columns_)),
               c1 = std::clamp(high.x() + margin, 0.0, double(columns_));
  const double r0 = std::clamp(low.y() - margin, 0.0, double(rows_)),
               r1 = std::clamp(high.y() + margin, 0.0, double(rows_));
  if (high.x() < 0 || low.x() > columns_ || high.y() < 0 || low.y() > rows_ || c1 <= c0 || r1 <= r0) {
    job_.refuse("it does not reach the window of the map",
                "check the origin of the map and the file's coordinates (prior.epsg)");
  }
  if ((c1 - c0) * (r1 - r0) > job_.config.max_cells) {
    job_.refuse(fmt::format("{:.3g} cells lie under the window, the maximum is {:.3g}", (c1 - c0) * (r1 - r0),
                            job_.config.max_cells),
                "make a coarser copy (gdalwarp -tr), or ask for a smaller window");
  }
  first_column_ = static_cast<int>(c0);
  first_row_ = static_cast<int>(r0);
  counted_width_ = static_cast<int>(std::ceil(c1)) - first_column_;
  counted_.assign(static_cast<std::size_t>(counted_width_) * static_cast<std::size_t>(std::ceil(r1) - first_row_),
                  false);
}

void RasterReading::check_cell(const RasterPiece& piece, std::size_t i, float& value, float& sigma) {
  const int c = piece.column + static_cast<int>(i % static_cast<std::size_t>(piece.width));
  const int r = piece.row + static_cast<int>(i / static_cast<std::size_t>(piece.width));
  const std::size_t k = static_cast<std::size_t>(r - first_row_) * static_cast<std::size_t>(counted_width_) +
                        static_cast<std::size_t>(c - first_column_);
  const bool inside =
      c >= first_column_ && r >= first_row_ && c - first_column_ < counted_width_ && k < counted_.size();
  const bool fresh = inside && !counted_[k];
  if (fresh) counted_[k] = true;
  const double v = static_cast<double>(value);
  const auto drop = [&](const char* reason) {
    value = NAN;
    if (fresh) ++prior_.left_out[reason];
  };
  const auto is = [v](double mark) { return v == mark || v == static_cast<double>(static_cast<float>(mark)); };
  if (!std::isfinite(v)) return drop("cells without data");
  if (std::any_of(job_.config.no_data.begin(), job_.config.no_data.end(), is)) return drop("cells without data");
  if (std::abs(v) >= 1e6 - 1 || std::any_of(kCustomaryNoData.begin(), kCustomaryNoData.end(), is)) {
    return drop("cells without data");
  }
  const double s = static_cast<double>(sigma);
  const bool known_sigma = std::isfinite(s) && s > 0 && s < 1e6 - 1;
  if (sigma_band_ && !known_sigma && fresh) ++prior_.left_out["invalid uncertainties (default used)"];
  if (!known_sigma) sigma = NAN;
  if (!fresh) return;
  ++prior_.read["cells"];
  positive_ += v > 0;
  negative_ += v < 0;
  least_ = std::min(least_, v);
  greatest_ = std::max(greatest_, v);
}

void RasterReading::load(RasterPiece& piece) {
  const std::size_t cells = static_cast<std::size_t>(piece.width) * static_cast<std::size_t>(piece.height);
  const auto fetch = [&](GDALRasterBand* band, std::vector<float>& into) {
    into.resize(cells);
    if (band->RasterIO(GF_Read, piece.column, piece.row, piece.width, piece.height, into.data(), piece.width,
                       piece.height, GDT_Float32, 0, 0, nullptr) != CE_None ||
        job_.gdal.failures() > 0) {
      job_.refuse("the raster is damaged or cut off: " + job_.gdal.complaint());
    }
    int has = 0;
    const auto none = static_cast<float>(band->GetNoDataValue(&has));
    int has_scale = 0, has_offset = 0;
    const double scale = band->GetScale(&has_scale), offset = band->GetOffset(&has_offset);
    for (float& v : into) {
      if (has && (v == none || (std::isnan(none) && std::isnan(v)))) {
        v = NAN;
      } else if ((has_scale && scale != 1) || (has_offset && offset != 0)) {
        v = static_cast<float>(static_cast<double>(v) * scale + offset);
      }
    }
  };
  fetch(band_, piece.value);
  if (sigma_band_) {
    fetch(sigma_band_, piece.sigma);
  } else {
    piece.sigma.assign(cells, NAN);
  }
  for (std::size_t i = 0; i < cells; ++i) check_cell(piece, i, piece.value[i], piece.sigma[i]);
}

void RasterReading::read_tile(const Tile& tile) {
  const PriorWindow& w = prior_.raster.window;
  const double px = w.grid.pixel_m;
  std::array<Vector2d, 4> corner;  // north-west, north-east, south-west, south-east
  for (std::size_t k = 0; k < 4; ++k) {
    const double c = tile.column + ((k & 1U) ? tile.width : 0), r = tile.row + ((k & 2U) ? tile.height : 0);
    const auto cell = cell_of(w.grid.corner_m + px * Vector2d(-r, c));
    if (!cell) return;
    corner[k] = *cell;
  }
  Vector2d low = corner[0], high = corner[0];
  for (const Vector2d& c : corner) {
    low = low.cwiseMin(c);
    high = high.cwiseMax(c);
  }
  const auto within = [](double at, int most) { return static_cast<int>(std::clamp(at, 0.0, double(most))); };
  RasterPiece piece;
  piece.column = within(std::floor(low.x()) - 1, columns_);
  piece.row = within(std::floor(low.y()) - 1, rows_);
  piece.width = within(std::ceil(high.x()) + 1, columns_) - piece.column;
  piece.height = within(std::ceil(high.y()) + 1, rows_) - piece.row;
  if (piece.width <= 0 || piece.height <= 0) return;
  if (static_cast<double>(piece.width) * piece.height > kMaxTileCells && tile.width > 1 && tile.height > 1) {
    const int a = tile.width / 2, b = tile.height / 2;
    read_tile({tile.column, tile.row, a, b});
    read_tile({tile.column + a, tile.row, tile.width - a, b});
    read_tile({tile.column, tile.row + b, a, tile.height - b});
    read_tile({tile.column + a, tile.row + b, tile.width - a, tile.height - b});
    return;
  }
  load(piece);
  const Vector2d along = (corner[1] - corner[0]) / tile.width, down = (corner[2] - corner[0]) / tile.height;
  const Vector2d half = 0.5 * (along.cwiseAbs() + down.cwiseAbs());
  const bool finer = half.minCoeff() >= 0.75;  // a pixel spans one and a half cells or more
  for (int r = 0; r < tile.height; ++r) {
    for (int c = 0; c < tile.width; ++c) {
      const double u = (c + 0.5) / tile.width, v = (r + 0.5) / tile.height;
      const Vector2d cell = (1 - v) * ((1 - u) * corner[0] + u * corner[1]) + v * ((1 - u) * corner[2] + u * corner[3]);
      const Merge merge = job_.config.pixels;
      const RasterSpot spot =
          finer ? spot_of_area(piece, cell, half, merge, sign_) : spot_between(piece, cell, merge, sign_);
      const std::size_t i = prior_.raster.index({tile.column + c, tile.row + r});
      prior_.raster.depth_m[i] = static_cast<float>(spot.depth);
      prior_.raster.sigma_m[i] = static_cast<float>(std::sqrt(spot.variance));
    }
  }
}

/// Converts the numbers of the file to depths.
void RasterReading::settle_sign(PriorSign convention) {
  const int sign = depth_sign(job_, convention, positive_, negative_);
  ISOBATH_ASSERT(sign == sign_);
  for (std::size_t i = 0; i < prior_.raster.depth_m.size(); ++i) {
    float& depth = prior_.raster.depth_m[i];
    float& sigma = prior_.raster.sigma_m[i];
    if (!std::isfinite(depth)) {
      depth = sigma = NAN;
      continue;
    }
    const double d = depth_of(depth);
    if (!job_.plausible(d)) {
      ++prior_.left_out["pixels of no plausible depth"];
      depth = sigma = NAN;
      continue;
    }
    depth = static_cast<float>(d);
    sigma = static_cast<float>(std::isfinite(sigma) ? factor_ * static_cast<double>(sigma) : job_.default_sigma(d));
  }
}

PriorOfFile RasterReading::read() {
  const std::string driver = data_.GetDriverName();
  if (driver == "netCDF" && is_cut_off_classic_netcdf(job_.file))
    job_.refuse("the file is shorter than its header says");
  prior_.format = driver == "GTiff" ? "GeoTIFF" : driver;
  VerticalSystem vertical = vertical_of(data_.GetSpatialRef());
  if (driver == "BAG") vertical.sign = PriorSign::kUp;
  if (driver == "netCDF" && vertical.sign == PriorSign::kAutomatic) vertical.sign = sign_of_netcdf(*band_);
  prior_.datum = vertical.datum;
  const PriorSign said = job_.config.sign == PriorSign::kAutomatic ? vertical.sign : job_.config.sign;
  sign_ = said == PriorSign::kUp ? -1 : 1;
  prior_.raster = empty_raster(window());
  reserve_cells();
  const PriorWindow& w = prior_.raster.window;
  for (int row = 0; row < w.rows; row += kTile) {
    for (int column = 0; column < w.columns; column += kTile) {
      read_tile({column, row, std::min(kTile, w.columns - column), std::min(kTile, w.rows - row)});
    }
  }
  if (prior_.read["cells"] == 0) job_.refuse("no cell under the window holds a depth");
  settle_sign(vertical.sign);
  const double a = depth_of(static_cast<float>(least_)), b = depth_of(static_cast<float>(greatest_));
  prior_.details["depths"] = fmt::format("{:.2f} .. {:.2f} m", std::min(a, b), std::max(a, b));
  prior_.details["uncertainty"] = sigma_band_ ? "as the file states" : "as configured: the file states none";
  return {std::move(prior_), true};
}

}  // namespace

PriorOfFile read_raster_prior(const PriorJob& job, GDALDataset& data) { return RasterReading(job, data).read(); }

}  // namespace isobath

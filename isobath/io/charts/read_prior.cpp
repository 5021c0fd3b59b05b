#include <cmath>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <isobath/base/error.hpp>
#include <isobath/base/lower_case.hpp>
#include <isobath/io/charts/prior_reader.hpp>
#include <isobath/io/charts/read_prior.hpp>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

namespace isobath {
namespace {

/// The formats of shapes that people draw.
const std::vector<const char*> kDrawingDrivers{"ESRI Shapefile", "GeoJSON", "GPKG"};

/// Opens a file with the named drivers only: a virtual raster or a web service could access anything.
Dataset open(const std::string& file, unsigned kind, std::vector<const char*> drivers,
             std::vector<const char*> options = {}) {
  drivers.push_back(nullptr);
  options.push_back(nullptr);
  return Dataset(GDALDataset::Open(file.c_str(), kind | GDAL_OF_READONLY, drivers.data(), options.data()));
}

/// Lets the driver resample a raster with several cell sizes to the size of the map's pixels.
Dataset resampled(const PriorJob& job, Dataset data) {
  const char* several = data->GetMetadataItem("HAS_SUPERGRIDS");
  if (!several || !EQUAL(several, "TRUE")) return data;
  const std::string step = fmt::format("{}", job.wanted.grid.pixel_m);
  const std::string x = "RESX=" + step, y = "RESY=" + step;
  const char* population = job.config.pixels == Merge::kShoalest ? "VALUE_POPULATION=MAX" : "VALUE_POPULATION=MEAN";
  return open(job.file, GDAL_OF_RASTER, {"BAG"}, {"MODE=RESAMPLED_GRID", x.c_str(), y.c_str(), population});
}

struct Opened {
  enum class Kind : std::uint8_t { kText, kRaster, kChart, kOutline };
  Kind kind = Kind::kText;
  Dataset data;
};

Opened open_any(const PriorJob& job) {
  using Kind = Opened::Kind;
  const std::string ending = to_lower_case(std::filesystem::path(job.file).extension().string());
  if (ending == ".txt" || ending == ".csv" || ending == ".dat") return {Kind::kText, nullptr};
  if (Dataset data =
          open(job.file, GDAL_OF_RASTER, {"GTiff", "BAG", "netCDF", "AAIGrid", "XYZ", "GSBG", "GS7BG", "GSAG"})) {
    if (EQUAL(data->GetDriverName(), "BAG")) data = resampled(job, std::move(data));
    if (data && data->GetRasterCount() > 0) return {Kind::kRaster, std::move(data)};
  }
  if (ending == ".xyz") return {Kind::kText, nullptr};
  job.gdal.forget();
  if (Dataset data = open(job.file, GDAL_OF_VECTOR, {"S57"},
                          {"UPDATES=APPLY", "SPLIT_MULTIPOINT=OFF", "ADD_SOUNDG_DEPTH=OFF", "RETURN_PRIMITIVES=OFF",
                           "LNAM_REFS=OFF"})) {
    return {Kind::kChart, std::move(data)};
  }
  if (Dataset data = open(job.file, GDAL_OF_VECTOR, kDrawingDrivers)) {
    return {Kind::kOutline, std::move(data)};
  }
  job.refuse(fmt::format("not a readable survey, chart or outline{}{}", job.gdal.complaint().empty() ? "" : ": ",
                         job.gdal.complaint()),
             "GeoTIFF, BAG, netCDF, ASCII grid, S-57, shapefile, GeoJSON, or text with columns");
}

PriorOfFile read_any(const PriorJob& job) {
  const Opened opened = open_any(job);
  switch (opened.kind) {
    case Opened::Kind::kText: return read_text_prior(job);
    case Opened::Kind::kRaster: return read_raster_prior(job, *opened.data);
    case Opened::Kind::kChart: return read_chart_prior(job, *opened.data);
    case Opened::Kind::kOutline: return read_outline_prior(job, *opened.data);
  }
  return read_text_prior(job);
}

/// The bounding box of all layers in the file's coordinates, and the first coordinate system found.
std::optional<OGREnvelope> box_of(GDALDataset& data, const OGRSpatialReference*& system) {
  OGREnvelope all;
  double t[6];
  if (data.GetRasterCount() > 0 && data.GetGeoTransform(t) == CE_None) {
    system = data.GetSpatialRef();
    for (const double column : {0.0, static_cast<double>(data.GetRasterXSize())}) {
      for (const double row : {0.0, static_cast<double>(data.GetRasterYSize())}) {
        all.Merge(t[0] + column * t[1] + row * t[2], t[3] + column * t[4] + row * t[5]);
      }
    }
  }
  for (OGRLayer* layer : data.GetLayers()) {
    OGREnvelope box;
    if (layer->GetExtent(&box, 1) != OGRERR_NONE) continue;
    if (!system) system = layer->GetSpatialRef();
    all.Merge(box);
  }
  return all.IsInit() ? std::optional(all) : std::nullopt;
}

bool same_datum(const std::string& a, const std::string& b) { return to_lower_case(a) == to_lower_case(b); }

/// The offset to add to every depth of the file. Refuses datums that cannot be compared.
double datum_offset(const PriorJob& job, const std::string& datum) {
  if (job.config.datum_offset_m.size() > 1) job.refuse("datum_offset_m takes one number");
  if (!job.config.datum_offset_m.empty()) return job.config.datum_offset_m[0];
  if (datum.empty()) {
    job.refuse("the vertical datum of the depths is unknown",
               "set prior.datum and prior.map_datum, or prior.datum_offset_m from the file's datum to the map's water "
               "surface");
  }
  if (job.config.map_datum.empty() || !same_datum(datum, job.config.map_datum)) {
    job.refuse(fmt::format("depths are below {}, those of the map are below {}", datum,
                           job.config.map_datum.empty() ? "the water surface" : job.config.map_datum),
               "set prior.datum_offset_m, the height of the map's surface above that datum");
  }
  return 0;
}

void shift(std::optional<double>& depth, double offset) {
  if (depth) *depth += offset;
}

void apply_offset(Prior& prior, double offset, double sigma) {
  for (std::size_t i = 0; i < prior.raster.depth_m.size(); ++i) {
    float& depth = prior.raster.depth_m[i];
    float& own = prior.raster.sigma_m[i];
    depth = static_cast<float>(static_cast<double>(depth) + offset);
    own = static_cast<float>(std::hypot(static_cast<double>(own), sigma));
  }
  for (SurveyPoint& s : prior.soundings) s.depth_m += offset;
  for (PriorPoint& p : prior.points) {
    shift(p.depth_m, offset);
    shift(p.clear_to_m, offset);
    p.sigma_m = std::hypot(p.sigma_m, sigma);
  }
  for (PriorLine& line : prior.lines) shift(line.depth_m, offset);
  for (PriorArea& area : prior.areas) {
    shift(area.min_depth_m, offset);
    shift(area.max_depth_m, offset);
  }
}

/// Sets land back to depth 0: the datum offset does not apply to land.
void paint_land(Prior& prior, double sigma) {
  for (const PriorArea& area : prior.areas) {
    if (area.kind != PriorAreaKind::kLand) continue;
    fill(area.rings, prior.raster.window, [&](std::size_t i) {
      prior.raster.depth_m[i] = 0;
      prior.raster.sigma_m[i] = static_cast<float>(sigma);
    });
  }
}

}  // namespace

void DatasetCloser::operator()(GDALDataset* data) const { GDALClose(data); }

Dataset open_drawing(const PriorJob& job, const std::string& of) {
  Dataset data = open(job.file, GDAL_OF_VECTOR, kDrawingDrivers);
  if (data) return data;
  const std::string& complaint = job.gdal.complaint();
  job.refuse(fmt::format("not a readable file of {}{}{}", of, complaint.empty() ? "" : ": ", complaint),
             "GeoJSON, shapefile or GeoPackage");
}

void PriorJob::refuse(const std::string& problem, const std::string& advice) const {
  throw Error(problem, {file, {}, {}, {}, {}}, "", advice);
}

int depth_sign(const PriorJob& job, PriorSign convention, std::uint64_t positive, std::uint64_t negative) {
  const auto all = static_cast<double>(positive + negative);
  const PriorSign said = job.config.sign == PriorSign::kAutomatic ? convention : job.config.sign;
  if (said == PriorSign::kAutomatic) {
    job.refuse("it is unknown whether the numbers are depths or heights",
               "set prior.sign = \"up\" or prior.sign = \"down\"");
  }
  const auto under_water = static_cast<double>(said == PriorSign::kDown ? positive : negative);
  if (job.config.sign == PriorSign::kAutomatic && all > 0 && under_water <= 0.99 * all) {
    job.refuse(fmt::format("{:.1f} % of the numbers lie above the datum if they are positive {}, as in this format",
                           100 * (1 - under_water / all), said == PriorSign::kDown ? "down" : "up"),
               "set prior.sign = \"up\" or prior.sign = \"down\"");
  }
  if (all > 0 && under_water < 0.01 * all) {
    job.refuse(fmt::format("the numbers are not positive {}: {} are positive, {} negative",
                           said == PriorSign::kDown ? "down" : "up", positive, negative),
               said == PriorSign::kDown ? "set prior.sign = \"up\"" : "set prior.sign = \"down\"");
  }
  return said == PriorSign::kDown ? 1 : -1;
}

std::optional<GeoPoint> centre_of_prior(const std::filesystem::path& file, const PriorConfig& config) {
  GdalSession gdal;
  const LocalPlane plane({0, 0});
  const PriorJob job{file.string(), config, plane, {}, gdal};
  if (!std::filesystem::exists(file)) job.refuse("there is no such file");
  const Opened opened = open_any(job);
  if (!opened.data) return std::nullopt;
  const OGRSpatialReference* system = nullptr;
  const auto box = box_of(*opened.data, system);
  OGRSpatialReference own, globe;
  if (config.epsg > 0 && own.importFromEPSG(config.epsg) == OGRERR_NONE) system = &own;
  if (!box || !system || globe.importFromEPSG(4326) != OGRERR_NONE) return std::nullopt;
  OGRSpatialReference from(*system);
  from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  globe.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> way(OGRCreateCoordinateTransformation(&from, &globe));
  double x = 0.5 * (box->MinX + box->MaxX), y = 0.5 * (box->MinY + box->MaxY);
  if (!way || !way->Transform(1, &x, &y)) return std::nullopt;
  const GeoPoint centre{y, x};
  return valid(centre) ? std::optional(centre) : std::nullopt;
}

Prior read_prior(const std::filesystem::path& file, const PriorConfig& config, const LocalPlane& plane,
                 const PriorWindow& wanted) {
  ISOBATH_ASSERT(wanted.grid.pixel_m > 0 && wanted.columns >= 0 && wanted.rows >= 0);
  GdalSession gdal;
  const PriorJob job{file.string(), config, plane, wanted, gdal};
  if (!std::filesystem::exists(file)) job.refuse("there is no such file");
  PriorOfFile read = read_any(job);
  Prior& prior = read.prior;
  prior.source = job.file;
  if (!config.datum.empty()) prior.datum = config.datum;
  const double offset = read.datum_matters ? datum_offset(job, prior.datum) : 0;
  apply_offset(prior, offset, read.datum_matters ? config.datum_offset_sigma_m : 0);
  paint_land(prior, config.sigma_m);
  if (!gdal.complaint().empty()) prior.details["complaint"] = gdal.complaint();
  return std::move(prior);
}

}  // namespace isobath

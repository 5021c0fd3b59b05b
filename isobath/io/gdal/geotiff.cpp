#include <cmath>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <isobath/base/error.hpp>
#include <isobath/base/pending_file.hpp>
#include <isobath/io/gdal/gdal_session.hpp>
#include <isobath/io/gdal/geotiff.hpp>
#include <limits>
#include <memory>
#include <ogr_spatialref.h>
#include <vector>

namespace isobath {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const GdalSession& gdal) {
  throw Error(fmt::format("cannot be written as GeoTIFF: {}", gdal.complaint()), {file.string(), {}, {}, {}, {}}, "",
              "check the folder, its permissions and the free space");
}

OGRSpatialReference reference_of(const RasterFrame& frame) {
  OGRSpatialReference reference;
  if (frame.origin) {
    const std::string text = fmt::format("+proj=aeqd +lat_0={} +lon_0={} +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs",
                                         frame.origin->latitude_deg, frame.origin->longitude_deg);
    ISOBATH_ASSERT(reference.importFromProj4(text.c_str()) == OGRERR_NONE);
  } else {
    reference.SetLocalCS("Isobath local plane: x east or starboard, y north or forward");
    reference.SetLinearUnits("metre", 1);
  }
  return reference;
}

/// Writes bands of one sample type.
void write_raster(const std::filesystem::path& file, const RasterFrame& frame, std::span<const RasterMeaning> meanings,
                  GDALDataType type, std::span<const void* const> bands, std::optional<double> no_data) {
  ISOBATH_ASSERT(frame.columns > 0 && frame.rows > 0 && frame.cell_m > 0);
  const GdalSession gdal;
  const char* const options[] = {"COMPRESS=DEFLATE", "TILED=NO", "INTERLEAVE=BAND", nullptr};
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  struct Closer {
    void operator()(GDALDataset* d) const { GDALClose(d); }
  };
  PendingFile pending(file);
  std::unique_ptr<GDALDataset, Closer> data(driver->Create(pending.beside().c_str(), frame.columns, frame.rows,
                                                           static_cast<int>(bands.size()), type,
                                                           const_cast<char**>(options)));
  if (!data) refuse(file, gdal);
  const double c = frame.cell_m * cos(frame.up), s = frame.cell_m * sin(frame.up);
  double transform[] = {frame.corner_m.y(), c, -s, frame.corner_m.x(), -s, -c};
  const OGRSpatialReference reference = reference_of(frame);
  bool good = data->SetGeoTransform(transform) == CE_None && data->SetSpatialRef(&reference) == CE_None;
  for (std::size_t i = 0; i < bands.size(); ++i) {
    GDALRasterBand* band = data->GetRasterBand(static_cast<int>(i) + 1);
    if (no_data) good = good && band->SetNoDataValue(*no_data) == CE_None;
    band->SetDescription(meanings[i].name.c_str());
    if (!meanings[i].unit.empty()) band->SetUnitType(meanings[i].unit.c_str());
  }
  for (std::size_t i = 0; i < bands.size(); ++i) {
    GDALRasterBand* band = data->GetRasterBand(static_cast<int>(i) + 1);
    good = good && band->RasterIO(GF_Write, 0, 0, frame.columns, frame.rows, const_cast<void*>(bands[i]), frame.columns,
                                  frame.rows, type, 0, 0, nullptr) == CE_None;
  }
  data->FlushCache(true);
  data.reset();
  if (!good || gdal.failures() > 0) refuse(file, gdal);
  pending.complete();
}

std::size_t cells_of(const RasterFrame& frame) { return static_cast<std::size_t>(frame.columns) * frame.rows; }

}  // namespace

void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, std::span<const RasterBand> bands) {
  ISOBATH_ASSERT(!bands.empty());
  std::vector<RasterMeaning> meanings;
  std::vector<const void*> cells;
  for (const RasterBand& band : bands) {
    ISOBATH_ASSERT(band.cells.size() == cells_of(frame));
    meanings.push_back(band.meaning);
    cells.push_back(band.cells.data());
  }
  write_raster(file, frame, meanings, GDT_Float32, cells, std::numeric_limits<double>::quiet_NaN());
}

void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, const RasterMeaning& meaning,
                   std::span<const float> cells) {
  const RasterBand band{meaning, cells};
  write_geotiff(file, frame, {&band, 1});
}

void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, const RasterMeaning& meaning,
                   std::span<const std::uint8_t> cells, std::optional<std::uint8_t> no_data) {
  ISOBATH_ASSERT(cells.size() == cells_of(frame));
  const void* data = cells.data();
  write_raster(file, frame, {&meaning, 1}, GDT_Byte, {&data, 1},
               no_data ? std::optional<double>(*no_data) : std::nullopt);
}

}  // namespace isobath

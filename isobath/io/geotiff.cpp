#include <cpl_conv.h>
#include <fmt/format.h>
#include <gdal_frmts.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <cmath>
#include <isobath/base/error.hpp>
#include <isobath/io/geotiff.hpp>
#include <limits>
#include <memory>

namespace isobath {
namespace {

/// Keeps GDAL from printing while it lives.
class QuietGdal {
 public:
  QuietGdal() {
    CPLPushErrorHandler(CPLQuietErrorHandler);
    CPLErrorReset();
    if (!GetGDALDriverManager()->GetDriverByName("GTiff")) GDALRegister_GTiff();
  }
  ~QuietGdal() { CPLPopErrorHandler(); }
  QuietGdal(const QuietGdal&) = delete;
  QuietGdal& operator=(const QuietGdal&) = delete;
};

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw Error(fmt::format("cannot be written as GeoTIFF: {}", CPLGetLastErrorMsg()), {file.string(), {}, {}, {}, {}},
              "", "check the folder, its rights and free space");
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

void write_raster(const std::filesystem::path& file, const RasterFrame& frame, const RasterMeaning& meaning,
                  GDALDataType type, const void* cells, std::size_t count, std::optional<double> no_data) {
  ISOBATH_ASSERT(frame.columns > 0 && frame.rows > 0 && frame.cell_m > 0);
  ISOBATH_ASSERT(count == static_cast<std::size_t>(frame.columns) * frame.rows);
  const QuietGdal quiet;
  const char* const options[] = {"COMPRESS=DEFLATE", "TILED=NO", nullptr};
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  struct Closer {
    void operator()(GDALDataset* d) const { GDALClose(d); }
  };
  std::unique_ptr<GDALDataset, Closer> data(
      driver->Create(file.c_str(), frame.columns, frame.rows, 1, type, const_cast<char**>(options)));
  if (!data) refuse(file);
  const double c = frame.cell_m * cos(frame.up), s = frame.cell_m * sin(frame.up);
  double transform[] = {frame.corner_m.y(), c, -s, frame.corner_m.x(), -s, -c};
  const OGRSpatialReference reference = reference_of(frame);
  GDALRasterBand* band = data->GetRasterBand(1);
  bool good = data->SetGeoTransform(transform) == CE_None && data->SetSpatialRef(&reference) == CE_None;
  if (no_data) good = good && band->SetNoDataValue(*no_data) == CE_None;
  band->SetDescription(meaning.name.c_str());
  if (!meaning.unit.empty()) band->SetUnitType(meaning.unit.c_str());
  good = good && band->RasterIO(GF_Write, 0, 0, frame.columns, frame.rows, const_cast<void*>(cells), frame.columns,
                                frame.rows, type, 0, 0, nullptr) == CE_None;
  data->FlushCache(true);
  data.reset();
  if (!good || CPLGetLastErrorType() >= CE_Failure) refuse(file);
}

}  // namespace

void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, const RasterMeaning& meaning,
                   std::span<const float> cells) {
  write_raster(file, frame, meaning, GDT_Float32, cells.data(), cells.size(), std::numeric_limits<double>::quiet_NaN());
}

void write_geotiff(const std::filesystem::path& file, const RasterFrame& frame, const RasterMeaning& meaning,
                   std::span<const std::uint8_t> cells, std::optional<std::uint8_t> no_data) {
  write_raster(file, frame, meaning, GDT_Byte, cells.data(), cells.size(),
               no_data ? std::optional<double>(*no_data) : std::nullopt);
}

}  // namespace isobath

// What the numbers of a depth raster mean, as its file states it: unit, vertical datum and sign. Internal to the
// readers of priors.
#pragma once

#include <isobath/io/charts/prior_data.hpp>
#include <string>

class GDALRasterBand;
class OGRSpatialReference;

namespace isobath {

/// Metres per unit; 0 for metres and for unknown names.
double metres_of_unit(const std::string& text);

/// The vertical part of a coordinate system.
struct VerticalSystem {
  std::string datum;
  PriorSign sign = PriorSign::kAutomatic;
};
VerticalSystem vertical_of(const OGRSpatialReference* system);
/// Whether a variable is a depth or a height, by the names of the netCDF conventions.
PriorSign sign_of_netcdf(GDALRasterBand& band);

}  // namespace isobath

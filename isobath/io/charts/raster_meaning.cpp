#include <gdal_priv.h>
#include <isobath/base/lower_case.hpp>
#include <isobath/io/charts/raster_meaning.hpp>
#include <ogr_spatialref.h>

namespace isobath {

double metres_of_unit(const std::string& text) {
  const std::string name = to_lower_case(text);
  if (name == "ft" || name == "feet" || name == "foot" || name == "international foot") return 0.3048;
  if (name == "us survey foot" || name == "ussft") return 1200.0 / 3937;
  if (name == "fathom" || name == "fathoms" || name == "fm") return 1.8288;
  if (name == "cm" || name == "centimetre" || name == "centimeter") return 0.01;
  if (name == "dm") return 0.1;
  return 0;
}

VerticalSystem vertical_of(const OGRSpatialReference* system) {
  VerticalSystem v;
  if (!system || !(system->IsCompound() || system->IsVertical())) return v;
  if (const char* name = system->GetAttrValue("VERT_DATUM")) v.datum = name;
  if (to_lower_case(v.datum) == "unknown" || to_lower_case(v.datum) == "unnamed") v.datum.clear();
  OGRAxisOrientation toward = OAO_Other;
  if (system->GetAxis("VERT_CS", 0, &toward)) {
    if (toward == OAO_Up) v.sign = PriorSign::kUp;
    if (toward == OAO_Down) v.sign = PriorSign::kDown;
  }
  return v;
}

PriorSign sign_of_netcdf(GDALRasterBand& band) {
  const auto item = [&band](const char* key) {
    const char* text = band.GetMetadataItem(key);
    return to_lower_case(text ? text : "");
  };
  if (item("positive") == "up") return PriorSign::kUp;
  if (item("positive") == "down") return PriorSign::kDown;
  const std::string all = item("standard_name") + " " + item("NETCDF_VARNAME") + " " + item("long_name");
  const bool height = all.find("elevation") != std::string::npos || all.find("altitude") != std::string::npos ||
                      all.find("height") != std::string::npos;
  const bool depth = all.find("depth") != std::string::npos;
  return height == depth ? PriorSign::kAutomatic : height ? PriorSign::kUp : PriorSign::kDown;
}

}  // namespace isobath

// Detects classic netCDF files that are shorter than their header states. The library that reads them fills missing
// data with zeros without an error, and a depth of zero is worse than none. Format: Unidata, NetCDF classic format
// specification (CDF-1, CDF-2, CDF-5). Files of netCDF-4 are HDF5, which detects truncation itself: they, and any other
// file, pass.
#pragma once

#include <filesystem>

namespace isobath {

/// True if the file is truncated, if its header is invalid, or if the header is longer than a megabyte.
bool is_cut_off_classic_netcdf(const std::filesystem::path& file);

}  // namespace isobath

// Whether a classic netCDF file is as long as its header promises. The library that reads it fills what is missing with
// zeros and says nothing; a depth of zero is worse than none. Format: Unidata, NetCDF classic format specification
// (CDF-1, CDF-2, CDF-5). Files of netCDF-4 are HDF5, which notices by itself: they, and any other file, pass.
#pragma once

#include <filesystem>

namespace isobath {

/// Also true where the header makes no sense, or is longer than a megabyte.
bool is_cut_off_classic_netcdf(const std::filesystem::path& file);

}  // namespace isobath

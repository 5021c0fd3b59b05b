// Point clouds of PCD files, and text grids of points.
#include <isobath/base/error.hpp>
#include <isobath/io/formats/point_files.hpp>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const isobath::Bytes bytes = std::as_bytes(std::span(data, size));
  try {
    const auto source = isobath::looks_like_pcd({data, size}) ? isobath::points_of_pcd(bytes, "input", {})
                                                              : isobath::points_of_xyz(bytes, "input", {});
    isobath::fuzz::drain(*source, size);
  } catch (const isobath::Error&) {  // a header that cannot be read
  }
  return 0;
}

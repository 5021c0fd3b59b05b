#include <isobath/io/formats/nmea.hpp>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return isobath::fuzz::read_all(data, size, isobath::open_nmea);
}

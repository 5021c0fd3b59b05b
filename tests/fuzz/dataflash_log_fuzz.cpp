#include <isobath/io/formats/mavlink/dataflash_log.hpp>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return isobath::fuzz::read_all(data, size, isobath::open_dataflash_log);
}

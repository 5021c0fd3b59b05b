#include <isobath/io/formats/ping/ping_logs.hpp>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return isobath::fuzz::read_all(data, size, isobath::open_ping_viewer_log);
}

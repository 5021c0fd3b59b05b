#include <isobath/io/formats/fish_finder.hpp>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return isobath::fuzz::read_all(data, size, [](isobath::ByteWindow input, const isobath::InputConfig& config) {
    return isobath::open_humminbird(std::move(input), config);
  });
}

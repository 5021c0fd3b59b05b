// A log and the file with its water columns beside it: the first byte says of which format, the next two where the
// second file begins.
#include <isobath/io/formats/kongsberg/kongsberg.hpp>
#include <tests/fuzz/drain.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  constexpr std::size_t kHead = 3;
  if (size < kHead) return 0;
  const Bytes bytes = std::as_bytes(std::span(data, size)).subspan(kHead);
  const std::size_t at = std::min<std::size_t>(data[1] | data[2] << 8, bytes.size());
  ByteWindow log("log", bytes.first(at), nullptr), water("water", bytes.subspan(at), nullptr);
  const auto source = data[0] % 2 == 0 ? open_kmall_with_water(std::move(log), std::move(water), {})
                                       : open_kongsberg_all_with_water(std::move(log), std::move(water), {});
  fuzz::drain(*source, bytes.size());
  return 0;
}

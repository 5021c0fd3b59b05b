// Histogram models: any bytes, and the same with their checksum made right, so that the header is met. What is read
// must be a sound model: its table is made, and it is written again.
#include <cstring>
#include <isobath/base/error.hpp>
#include <isobath/sonar/histogram_model.hpp>
#include <zlib.h>

namespace {

void use(const std::string& bytes) {
  using namespace isobath;
  try {
    const auto model = std::make_shared<const HistogramModel>(read_histogram_model(bytes, "fuzz"));
    ISOBATH_ASSERT(read_histogram_model(write_histogram_model(*model), "again").noise == model->noise);
    const LikelihoodRatios ratios(model);
    ISOBATH_ASSERT(ratios.operating_point(0.02, 1).false_alarm <= 0.02);
  } catch (const Error&) {
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes(reinterpret_cast<const char*>(data), size);
  use(bytes);
  if (size < 4) return 0;
  const auto crc = static_cast<std::uint32_t>(::crc32_z(0, data, size - 4));
  std::memcpy(bytes.data() + size - 4, &crc, sizeof crc);
  use(bytes);
  return 0;
}

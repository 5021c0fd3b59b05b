// Fan models: any bytes. What is read must be sound: it is written again as it was read, and a detector starts from it.
#include <isobath/base/error.hpp>
#include <isobath/sonar/fan_detector.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  try {
    const FanModel model = read_fan_model({reinterpret_cast<const char*>(data), size}, "fuzz");
    const std::string text = write_fan_model(model);
    ISOBATH_ASSERT(write_fan_model(read_fan_model(text, "again")) == text);
    for (const TailLaw& law : model.laws) (void)FanDetector::threshold_of(law, model.all, 1e-4);
  } catch (const Error&) {
  }
  return 0;
}

// pairs.toml: any bytes. It ends in a rig or in an Error of one line, and what it is written as is read as the same.
#include <cstdint>
#include <isobath/base/error.hpp>
#include <isobath/io/frames/pair_rig.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const PairRig rig = parse_pair_rig(text, "/nonexistent/pairs.toml");
    ISOBATH_ASSERT(rig.X_BL().is_finite());
    const PairRig again = parse_pair_rig(pair_rig_toml(rig), "/nonexistent/pairs.toml");
    ISOBATH_ASSERT(again.left == rig.left && again.right_topic == rig.right_topic);
  } catch (const Error& error) {
    ISOBATH_ASSERT(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}

#include <isobath/base/error.hpp>
#include <isobath/io/frames/polygon_marks.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  looks_like_polygon_marks(text);
  try {
    const auto marks = parse_polygon_marks(text, 24, 16, "fuzz");
    ISOBATH_ASSERT(marks.size() == 24 * 16);
    for (const std::uint8_t mark : marks) ISOBATH_ASSERT(mark <= 1);
  } catch (const Error&) {
  }
  return 0;
}

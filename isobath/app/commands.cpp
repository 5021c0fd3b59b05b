#include <charconv>
#include <isobath/app/commands.hpp>
#include <isobath/base/error.hpp>

namespace isobath::app {

Eigen::Vector2d pair_of(const std::string& text) {
  double first = 0, second = 0;
  const char* const end = text.data() + text.size();
  const auto a = std::from_chars(text.data(), end, first);
  const bool comma = a.ec == std::errc() && a.ptr != end && *a.ptr == ',';
  const auto b = comma ? std::from_chars(a.ptr + 1, end, second) : a;
  if (!comma || b.ec != std::errc() || b.ptr != end) {
    throw Error("\"" + text + "\" is not a way-point", {}, "two numbers separated by a comma: 41.66,-82.82");
  }
  return {first, second};
}

}  // namespace isobath::app

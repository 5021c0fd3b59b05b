// Words of a request: any bytes as a path, a host, an origin and a list. A path that is taken leads nowhere up.
#include <isobath/base/error.hpp>
#include <isobath/server/web_request.hpp>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isobath;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (const auto path = path_of_target(text)) {
    ISOBATH_ASSERT(path->front() == '/' && (*path + "/").find("/../") == std::string::npos);
    ISOBATH_ASSERT(path->find('\0') == std::string::npos && path->size() <= text.size());
  }
  const std::size_t half = size / 2;
  (void)is_origin_of(text.substr(0, half), text.substr(half));
  (void)takes_gzip(text);
  if (is_own_host(text, names_of_list("boat.example"))) {
    ISOBATH_ASSERT(text.find_first_not_of("0123456789abcdefABCDEFghijklmnopqrstuvwxyzGHIJKLMNOPQRSTUVWXYZ.:[]-") ==
                   std::string_view::npos);  // it stands in a header of the answer
  }
  return 0;
}

// to_base64: bytes as Base64 text (RFC 4648, section 4), as pages and JSON carry them.
#pragma once

#include <string>
#include <string_view>

namespace isobath {

std::string to_base64(std::string_view bytes);

}  // namespace isobath

// Bytes as text of 64 letters (RFC 4648, section 4), as pages and JSON carry them.
#pragma once

#include <string>
#include <string_view>

namespace isobath {

std::string to_base64(std::string_view bytes);

}  // namespace isobath

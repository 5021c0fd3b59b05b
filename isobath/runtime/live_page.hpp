// The live page (web/): one HTML file with all that it needs, as the program carries it.
#pragma once

#include <string_view>

namespace isobath {

/// Empty where the program was built without it (ISOBATH_PAGE).
std::string_view live_page();

}  // namespace isobath

// live_page: the live page (web/) as one self-contained HTML file, compiled into the program.
#pragma once

#include <string_view>

namespace isobath {

/// Empty if the program was built without the page (ISOBATH_PAGE).
std::string_view live_page();

}  // namespace isobath

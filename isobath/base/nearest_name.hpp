// nearest_name: the known name that a mistyped one may stand for: of a command, an option, a setting, a choice, a file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// The name whose spelling is closest, without regard to case; of several equally close ones the first. The distance is
/// the number of letters that differ (an exchange of two neighbours counts once), but at most 2 if one of both names
/// contains the other. Empty where more than half of the letters differ from every name.
std::string nearest_name(std::string_view wanted, const std::vector<std::string>& names);

/// "bin, printed or any_target".
std::string alternatives(const std::vector<std::string>& names);

/// "did you mean NAME?"; empty where no name is close.
std::string did_you_mean(std::string_view wanted, const std::vector<std::string>& names);

}  // namespace isobath

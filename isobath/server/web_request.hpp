// Checks of a request before a WebServer answers it: whether it is well formed, is addressed to this server, and comes
// from one of its own pages. The input is untrusted; no function here opens a file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// Decodes "/a%20b?x" to "/a b". Returns nothing if the path does not begin with '/', has an incomplete escape, is not
/// UTF-8, or contains control characters, '\' or a part "." or "..": no file of a page has such a path.
std::optional<std::string> path_of_target(std::string_view target);

/// Whether a Host header may name this server: a numeric address, localhost, or one of the names (in lower case), with
/// any port. Any other name could belong to a foreign page whose DNS entry now points here (DNS rebinding).
bool is_own_host(std::string_view host, const std::vector<std::string>& names);

/// Whether an Origin header names the host of a Host header.
bool is_origin_of(std::string_view origin, std::string_view host);

/// Whether an Accept-Encoding header accepts gzip.
bool takes_gzip(std::string_view accept_encoding);

/// Splits "a, b" into {"a", "b"}, in lower case.
std::vector<std::string> names_of_list(std::string_view list);

}  // namespace isobath

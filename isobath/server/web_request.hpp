// What a WebServer makes of the words of a request before it answers: whether they are whole, meant for it, and of a
// page of its own. Input is untrusted; nothing here looks at a file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {

/// "/a%20b?x" is "/a b". Nothing where it does not begin with '/', an escape is not whole, it is not UTF-8, or holds
/// control characters, '\' or a part "." or "..": no such path is a file of a page.
std::optional<std::string> path_of_target(std::string_view target);

/// Whether a Host header may name this server: an address in digits, localhost, or one of the names, in lower case;
/// with any port. Any other name could be one that a stranger's page was loaded from, and that points here now (DNS
/// rebinding).
bool is_own_host(std::string_view host, const std::vector<std::string>& names);

/// Whether an Origin header says that the page was loaded from `host`, a Host header.
bool is_origin_of(std::string_view origin, std::string_view host);

/// Whether an Accept-Encoding header takes gzip.
bool takes_gzip(std::string_view accept_encoding);

/// "a, b" is {"a", "b"}, in lower case.
std::vector<std::string> names_of_list(std::string_view list);

}  // namespace isobath

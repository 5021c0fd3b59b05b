#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <charconv>
#include <isobath/server/web_request.hpp>

namespace isobath {
namespace {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 'a' - 'A') : c; });
  return lower;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Calls `each` with every part between separators, without surrounding blanks.
template <class Each>
void split(std::string_view text, char separator, const Each& each) {
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(separator, at), text.size());
    each(without_blanks(text.substr(at, end - at)));
    at = end + 1;
  }
}

std::optional<std::string> without_escapes(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      plain += text[i];
      continue;
    }
    unsigned byte = 0;
    const std::string_view digits = text.substr(i + 1, 2);
    const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    if (digits.size() != 2 || read.ptr != digits.data() + 2) return std::nullopt;
    plain += static_cast<char>(byte);
    i += 2;
  }
  return plain;
}

/// RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.
bool is_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    if (lead < 0x80) continue;
    const int more = lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead < 0xc2 || lead > 0xf4 || text.size() - i < static_cast<std::size_t>(more)) return false;
    unsigned code = lead & (0x3fu >> more);
    for (int k = 0; k < more; ++k) {
      const auto next = static_cast<unsigned char>(text[i++]);
      if ((next & 0xc0) != 0x80) return false;
      code = code << 6 | (next & 0x3fu);
    }
    constexpr std::array<unsigned, 4> kMin{0, 0x80, 0x800, 0x10000};
    if (code < kMin[static_cast<std::size_t>(more)] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) {
      return false;
    }
  }
  return true;
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::optional<std::string> path_of_target(std::string_view target) {
  const auto path = without_escapes(target.substr(0, target.find('?')));
  if (!path || !path->starts_with('/') || !is_utf8(*path)) return std::nullopt;
  const bool odd =
      std::ranges::any_of(*path, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\'; });
  bool climbs = false;
  split(*path, '/', [&](std::string_view part) { climbs = climbs || part == "." || part == ".."; });
  return odd || climbs ? std::nullopt : path;
}

bool is_own_host(std::string_view host, const std::vector<std::string>& names) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  if (bracket == std::string_view::npos || host.find('\0') != std::string_view::npos) return false;
  const std::size_t colon = host.find(':', bracket);
  if (colon != std::string_view::npos && !is_port(host.substr(colon + 1))) return false;
  const std::string name = lower_case(host.substr(0, colon));
  if (bracket > 0) {
    return name.ends_with(']') && inet_pton(AF_INET6, name.substr(1, name.size() - 2).c_str(), address.data()) == 1;
  }
  return name == "localhost" || inet_pton(AF_INET, name.c_str(), address.data()) == 1 ||
         std::ranges::find(names, name) != names.end();
}

bool is_origin_of(std::string_view origin, std::string_view host) {
  const std::string from = lower_case(origin), to = lower_case(host);
  return from == "http://" + to || from == "https://" + to;
}

bool takes_gzip(std::string_view accept_encoding) {
  bool takes = false;
  split(accept_encoding, ',', [&](std::string_view coding) {
    const std::string_view name = without_blanks(coding.substr(0, coding.find(';')));
    if (lower_case(name) != "gzip") return;
    const std::size_t q = coding.find("q=");
    takes = q == std::string_view::npos || coding.substr(q + 2).find_first_of("123456789") != std::string_view::npos;
  });
  return takes;
}

std::vector<std::string> names_of_list(std::string_view list) {
  std::vector<std::string> names;
  split(list, ',', [&](std::string_view name) {
    if (!name.empty()) names.push_back(lower_case(name));
  });
  return names;
}

}  // namespace isobath

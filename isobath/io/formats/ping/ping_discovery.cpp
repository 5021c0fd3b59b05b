#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <isobath/io/formats/ping/ping_discovery.hpp>

namespace isobath {
namespace {

constexpr std::string_view kOctetDigits = "0123456789.";
constexpr std::size_t kLongestAnswer = 2048;

/// "192.168.001.020" without the zeros; empty: no address.
std::optional<std::string> plain_address(std::string_view word) {
  std::string address;
  for (int i = 0; i < 4; ++i) {
    int octet = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), octet);
    const auto digits = static_cast<std::size_t>(end - word.data());
    if (fault != std::errc() || octet > 255 || digits > 3) return std::nullopt;
    word.remove_prefix(digits);
    if (i < 3 && !word.starts_with('.')) return std::nullopt;
    if (i < 3) word.remove_prefix(1);
    address += fmt::format("{}{}", i > 0 ? "." : "", octet);
  }
  return word.empty() ? std::optional(address) : std::nullopt;
}

}  // namespace

std::optional<std::string> ping360_address_in(Bytes answer) {
  std::string_view text = text_of(answer.first(std::min(answer.size(), kLongestAnswer)));
  if (text.find("PING360") == std::string_view::npos) return std::nullopt;
  while (true) {
    const std::size_t begin = text.find_first_of(kOctetDigits);
    if (begin == std::string_view::npos) return std::nullopt;
    text.remove_prefix(begin);
    const std::size_t end = text.find_first_not_of(kOctetDigits);
    if (auto address = plain_address(text.substr(0, end))) return address;
    if (end == std::string_view::npos) return std::nullopt;
    text.remove_prefix(end);
  }
}

std::string ping360_discovery_answer(const std::string& address) {
  std::string padded;
  std::string_view rest = address;
  while (!rest.empty()) {
    const std::size_t dot = rest.find('.');
    padded += fmt::format("{}{:0>3}", padded.empty() ? "" : ".", rest.substr(0, dot));
    rest.remove_prefix(dot == std::string_view::npos ? rest.size() : dot + 1);
  }
  return fmt::format("SONAR PING360\r\nBlue Robotics\r\nMAC Address:- 00-04-A3-00-00-01\r\nIP Address:- {}\r\n",
                     padded);
}

}  // namespace isobath

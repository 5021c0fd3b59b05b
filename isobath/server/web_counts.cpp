#include <fmt/format.h>
#include <isobath/server/web_counts.hpp>

namespace isobath {
namespace {

void add_metric(std::string& text, const char* name, const char* type, const char* help, std::uint64_t value) {
  text += fmt::format("# HELP isobath_web_{0} {2}\n# TYPE isobath_web_{0} {1}\nisobath_web_{0} {3}\n", name, type, help,
                      value);
}

}  // namespace

void WebCounts::refuse(std::string_view reason) {
  const auto found = refused.find(reason);
  if (found != refused.end()) {
    ++found->second;
  } else {
    refused.emplace(reason, 1);
  }
}

std::string to_prometheus(const WebCounts& counts) {
  std::string text;
  add_metric(text, "connections", "gauge", "Connections now.", static_cast<std::uint64_t>(counts.connections));
  add_metric(text, "clients", "gauge", "Pages on the socket now.", static_cast<std::uint64_t>(counts.clients));
  add_metric(text, "connections_total", "counter", "Connections so far.", counts.connections_ever);
  add_metric(text, "clients_total", "counter", "Pages on the socket so far.", counts.clients_ever);
  add_metric(text, "requests_total", "counter", "HTTP requests.", counts.requests);
  add_metric(text, "messages_total", "counter", "Messages from pages.", counts.messages);
  add_metric(text, "frames_total", "counter", "Frames sent to pages.", counts.frames);
  add_metric(text, "frame_bytes_total", "counter", "Bytes of these frames.", counts.frame_bytes);
  add_metric(text, "longest_call_us", "gauge", "Longest call of one page, for which all pages wait, in us.",
             counts.longest_call_us);
  text += "# HELP isobath_web_refused_total Refused, held back or dropped, by reason.\n";
  text += "# TYPE isobath_web_refused_total counter\n";
  for (const auto& [reason, count] : counts.refused) {
    text += fmt::format("isobath_web_refused_total{{reason=\"{}\"}} {}\n", reason, count);
  }
  return text;
}

}  // namespace isobath

#include <isobath/base/error.hpp>
#include <isobath/display/live_page.hpp>
#include <isobath/server/foxglove_session.hpp>
#include <isobath/server/packed_records.hpp>
#include <isobath/server/page_site.hpp>
#include <map>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

double seconds_shown(const PageSources& sources) {
  if (!sources.live) return 0;
  const TimeSpan span = sources.live_span();
  return to_seconds(span.end - span.start);
}

/// What BlueOS asks a service of a vehicle's computer, and the widget of Cockpit: the page in a frame.
std::map<std::string, std::string> extension_files(const std::string& version) {
  const nlohmann::json service{{"name", "Isobath"},
                               {"description", "Maps from sonar, and steers round what it sees"},
                               {"icon", "mdi-radar"},
                               {"company", "Isobath"},
                               {"version", version},
                               {"webpage", ""},
                               {"api", ""},
                               {"new_page", false},
                               {"works_in_relative_paths", false},
                               {"extras", {{"cockpit", "/cockpit_extras.json"}}}};
  const nlohmann::json widget{{"name", "Isobath"}, {"iframe_url", "/"}, {"icon_url", ""}, {"version", version}};
  const nlohmann::json cockpit{{"target_system", "Cockpit"},
                               {"target_cockpit_api_version", "1.0.0"},
                               {"widgets", nlohmann::json::array({widget})},
                               {"actions", nlohmann::json::array()}};
  return {{"/register_service", service.dump()}, {"/cockpit_extras.json", cockpit.dump()}};
}

}  // namespace

WebSite page_site(std::span<const PageSources* const> vehicles) {
  const std::string page(live_page());
  const WebFile file{"text/html; charset=utf-8", page, packed(page, Packing::kGzip, 9)};
  WebSite site;
  for (std::size_t v = 0; v < vehicles.size(); ++v) {
    const std::string path = v == 0 ? "/" : "/vehicle/" + std::to_string(v + 1) + "/";
    site.files[path] = file;
    const auto open = [source = vehicles[v]](bool paced) { return std::make_unique<PageSession>(*source, paced); };
    site.sockets[path + "socket"].open = [open] { return open(false); };
    site.sockets[path + "socket/paced"].open = [open] { return open(true); };
    if (vehicles[v]->viewers == nullptr) continue;
    site.sockets[path + "foxglove"] = {[source = vehicles[v]] {
                                         return std::make_unique<FoxgloveSession>(
                                             *source->viewers, "Isobath " + source->version, source->run);
                                       },
                                       foxglove_protocols(), true};
  }
  const PageSources& sources = *vehicles.front();
  for (auto& [path, text] : extension_files(sources.version)) site.files[path] = {"application/json", text};
  site.health = [&sources] {
    return nlohmann::json{{"status", "ok"},
                          {"version", sources.version},
                          {"shows", sources.live ? "a run" : "a recording"},
                          {"run_s", seconds_shown(sources)}}
        .dump();
  };
  site.metrics = [&sources] {
    return "# HELP isobath_run_seconds Seconds since the start of the run that is shown, on its own clock.\n"
           "# TYPE isobath_run_seconds gauge\n"
           "isobath_run_seconds " +
           std::to_string(seconds_shown(sources)) + "\n";
  };
  return site;
}

}  // namespace isobath

// The site of the live page: its file, its sessions, and its pages for machines (/health, /metrics). Where a group of
// vehicles runs, each vehicle has a page of its own: that of the first at /, that of the second at /vehicle/2/. Viewers
// that speak the Foxglove protocol connect to /foxglove, /vehicle/2/foxglove. BlueOS and Cockpit, on the computer of a
// vehicle, read /register_service and /cockpit_extras.json.
#pragma once

#include <isobath/server/page_session.hpp>
#include <isobath/server/web_site.hpp>
#include <span>

namespace isobath {

/// One source for each vehicle, at least one. They must outlive the server and have been checked.
WebSite page_site(std::span<const PageSources* const> vehicles);
inline WebSite page_site(const PageSources& sources) {
  const PageSources* const only = &sources;
  return page_site(std::span(&only, 1));
}

}  // namespace isobath

// The site of the live page: its file, its sessions, and its pages for machines (/health, /metrics).
#pragma once

#include <isobath/server/page_session.hpp>
#include <isobath/server/web_site.hpp>

namespace isobath {

/// The sources must outlive the server and have been checked.
WebSite page_site(const PageSources& sources);

}  // namespace isobath

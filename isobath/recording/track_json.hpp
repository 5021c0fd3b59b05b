// track_json: the bodies that move in a scan as JSON, for readers of a recording: one object with scan, time_ns and
// bodies. A body has the number of its track, that of its obstacle, its place and velocity with their covariances, its
// outline, and its existence. Covariances are [north north, north east, east east], m2 and (m/s)2. Numbers are rounded
// to 1e-6; one that is not finite becomes null. W, m, m/s.
#pragma once

#include <isobath/world/result_sinks.hpp>
#include <string>

namespace isobath {

std::string tracks_json(const ScanResult& scan);
/// The JSON Schema of these objects.
const char* tracks_schema();

}  // namespace isobath

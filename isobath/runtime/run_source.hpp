// What a run reads from: a log, a folder, or a scene that is simulated here and now; in the frame of a map, if there is
// one already.
#pragma once

#include <deque>
#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <memory>
#include <optional>

namespace isobath {

/// Log, folder of logs, or scene (.toml; an empty path is the embedded one). With `frame` all fixes are brought to the
/// local plane around it. Throws Error where the input cannot be opened; and, at the first fix, where it does not say
/// where on the globe it is although `frame` does.
std::unique_ptr<Source> open_run_source(const std::filesystem::path& input, const Configuration& configuration,
                                        const std::optional<GeoOrigin>& frame = {}, int threads = 1);

/// `source`, which must outlive it, in the plane around `frame`.
std::unique_ptr<Source> place_in(Source& source, const GeoOrigin& frame);

/// Reads on until the pipeline has heard enough to decide the first ping (Pipeline::listen), and gives what it has
/// read: the events to begin with. Of a log without pings 20 000 events are read.
std::deque<Event> listen_ahead(Source& source, Pipeline& pipeline);

}  // namespace isobath

// What a run reads from: a log, a folder, or a scene that is simulated here and now; in the frame of a map, if there is
// one already.
#pragma once

#include <deque>
#include <filesystem>
#include <isobath/io/event.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <isobath/runtime/scenario.hpp>
#include <memory>
#include <optional>

namespace isobath {

/// Log, folder of logs, or scene (.toml; an empty path is the embedded one). With `frame` all fixes are brought to the
/// local plane around it. Throws Error where the input cannot be opened; and, at the first fix, where it does not say
/// where on the globe it is although `frame` does.
std::unique_ptr<Source> open_run_source(const std::filesystem::path& input, const Configuration& configuration,
                                        const std::optional<GeoOrigin>& frame = {}, int threads = 1);

/// Reads on until the pipeline has heard enough to decide the first ping (Pipeline::listen), and gives what it has
/// read: the events to begin with. Of a log without pings 20 000 events are read.
std::deque<Event> listen_ahead(Source& source, Pipeline& pipeline);

/// Where the events of a run come from, a scene that is simulated here and now or a log, and where on the globe they
/// lie.
class RunInput {
 public:
  /// `scenario`: of an input that is one. `frame`: of a map that is continued. Throws Error as open_run_source.
  RunInput(const std::filesystem::path& input, const std::optional<Scenario>& scenario,
           const Configuration& configuration, const std::optional<GeoOrigin>& frame, int threads);

  std::optional<Event> next();
  /// Reads on until the pipeline can decide its first ping (listen_ahead); what was read comes next.
  void listen_for(Pipeline& pipeline) { ahead_ = listen_ahead(*source_, pipeline); }
  [[nodiscard]] const SourceReport& report() const { return source_->report(); }
  /// Of W, as soon as it is known.
  [[nodiscard]] std::optional<GeoOrigin> origin() const { return frame_ ? frame_ : report().origin; }
  /// Null: it is a log.
  [[nodiscard]] SimulatedSource* simulated() { return simulated_.get(); }
  [[nodiscard]] const Simulator* simulator() const { return simulated_ ? &simulated_->simulator() : nullptr; }

 private:
  std::optional<GeoOrigin> frame_;
  std::unique_ptr<SimulatedSource> simulated_;
  std::unique_ptr<Source> opened_;  ///< the log, or what puts the simulated one into the frame
  Source* source_ = nullptr;
  std::deque<Event> ahead_;
};

}  // namespace isobath

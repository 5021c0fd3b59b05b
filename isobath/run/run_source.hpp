// RunInput: the input of a run: a log, a folder, or a scene that is simulated during the run. If the run continues a
// map, the input is transformed into the frame of the map.
#pragma once

#include <deque>
#include <filesystem>
#include <isobath/configuration/configuration.hpp>
#include <isobath/event/event.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/scenario/scenario.hpp>
#include <memory>
#include <optional>

namespace isobath {

/// Opens a log, a folder of logs or of camera pairs, or a scene (.toml; an empty path is the embedded one). With
/// `frame`, all fixes are transformed into the local plane around it. Throws Error if the input cannot be opened; with
/// `frame`, also at the first fix, if the input has no geographic origin or lies more than 1000 km away.
std::unique_ptr<Source> open_run_source(const std::filesystem::path& input, const Configuration& configuration,
                                        const std::optional<GeoOrigin>& frame = {}, int threads = 1);

/// Reads ahead until the pipeline has learnt enough to decide the first ping (Pipeline::listen), but at most 20 000
/// events. Returns the events read; the run begins with them.
std::deque<Event> listen_ahead(Source& source, Pipeline& pipeline);

/// The source of the events of a run (a scene that is simulated during the run, or a log) and their geographic origin.
class RunInput {
 public:
  /// `scenario`: the input, if it is one. `frame`: the origin of the map that is continued. Throws Error as
  /// open_run_source.
  RunInput(const std::filesystem::path& input, const std::optional<Scenario>& scenario,
           const Configuration& configuration, const std::optional<GeoOrigin>& frame, int threads);
  /// The devices of a vehicle, which must outlive it.
  RunInput(Source& devices, const std::optional<GeoOrigin>& frame);

  std::optional<Event> next();
  /// Reads ahead until the pipeline can decide its first ping (listen_ahead). `next` returns these events first.
  void listen_for(Pipeline& pipeline) { ahead_ = listen_ahead(*source_, pipeline); }
  [[nodiscard]] const SourceReport& report() const { return source_->report(); }
  /// The geographic origin of W, as soon as it is known.
  [[nodiscard]] std::optional<GeoOrigin> origin() const { return frame_ ? frame_ : report().origin; }
  /// Null: the input is a log.
  [[nodiscard]] SimulatedSource* simulated() { return simulated_.get(); }
  [[nodiscard]] const Simulator* simulator() const { return simulated_ ? &simulated_->simulator() : nullptr; }

 private:
  std::optional<GeoOrigin> frame_;
  std::unique_ptr<SimulatedSource> simulated_;
  std::unique_ptr<Source> opened_;  ///< the log, or the source that transforms the simulated one into the frame
  Source* source_ = nullptr;
  std::deque<Event> ahead_;
};

}  // namespace isobath

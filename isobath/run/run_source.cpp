#include <algorithm>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/cameras/pair_source.hpp>
#include <isobath/io/survey_folder.hpp>
#include <isobath/run/prefetch.hpp>
#include <isobath/run/run_source.hpp>
#include <isobath/scenario/scenario.hpp>

namespace isobath {
namespace {

constexpr double kFarthest = 1e6;  // m: the reach of a local plane

/// A source whose fixes are transformed into another local plane.
class PlacedSource final : public Source {
 public:
  PlacedSource(Source& source, const GeoOrigin& frame, std::unique_ptr<Source> owned)
      : source_(&source), owned_(std::move(owned)), frame_(frame), to_(frame) {}

  std::optional<Event> next() override {
    std::optional<Event> event = source_->next();
    if (auto* fix = event ? std::get_if<Navigation>(&*event) : nullptr) {
      const auto& origin = source_->report().origin;
      if (!origin) {
        throw Error("the input has no geographic origin, but the map has one", {source_->report().format});
      }
      if (!from_) {
        refuse_far(*origin);
        from_.emplace(*origin);
      }
      *fix = in_plane(*fix, *from_, to_);
    }
    return event;
  }
  /// The report of the source, with the source's own origin.
  [[nodiscard]] const SourceReport& report() const override { return source_->report(); }

 private:
  void refuse_far(const GeoOrigin& origin) const {
    const double apart = distance_m(origin, frame_);
    if (apart <= kFarthest) return;
    throw Error(
        fmt::format("the input is at {:.4f}, {:.4f}, the map {:.0f} km away at {:.4f}, {:.4f}", origin.latitude_deg,
                    origin.longitude_deg, apart / 1000, frame_.latitude_deg, frame_.longitude_deg),
        {source_->report().format}, {}, "use another map");
  }

  Source* source_;
  std::unique_ptr<Source> owned_;  ///< null: the caller owns the source
  GeoOrigin frame_;
  LocalPlane to_;
  std::optional<LocalPlane> from_;
};

}  // namespace

std::unique_ptr<Source> open_run_source(const std::filesystem::path& input, const Configuration& configuration,
                                        const std::optional<GeoOrigin>& frame, int threads) {
  std::unique_ptr<Source> source;
  if (is_scene(input)) {
    source =
        std::make_unique<SimulatedSource>(open_scene(input), configuration.simulation, threads, configuration.cameras);
  } else {
    source = open_input(input, configuration.input, configuration.cameras);
    if (threads > 1) source = std::make_unique<PrefetchSource>(std::move(source));
  }
  if (!frame) return source;
  Source& inner = *source;
  return std::make_unique<PlacedSource>(inner, *frame, std::move(source));
}

std::deque<Event> listen_ahead(Source& source, Pipeline& pipeline) {
  constexpr std::size_t kMax = 20'000;
  std::deque<Event> ahead;
  while (ahead.size() < kMax) {
    auto event = source.next();
    if (!event) {
      pipeline.end_learning();
      break;
    }
    ahead.push_back(std::move(*event));
    const auto* ping = std::get_if<Ping>(&ahead.back());
    if (ping && pipeline.listen(*ping)) break;
  }
  return ahead;
}

RunInput::RunInput(const std::filesystem::path& input, const std::optional<Scenario>& scenario,
                   const Configuration& configuration, const std::optional<GeoOrigin>& frame, int threads)
    : frame_(frame) {
  if (!scenario) {
    opened_ = open_run_source(input, configuration, frame, threads);
    source_ = opened_.get();
    return;
  }
  simulated_ = std::make_unique<SimulatedSource>(scenario->scene, configuration.simulation, std::min(threads, 2),
                                                 configuration.cameras);
  source_ = simulated_.get();
  if (!frame) return;
  opened_ = std::make_unique<PlacedSource>(*simulated_, *frame, nullptr);
  source_ = opened_.get();
}

RunInput::RunInput(Source& devices, const std::optional<GeoOrigin>& frame) : frame_(frame), source_(&devices) {
  if (!frame) return;
  opened_ = std::make_unique<PlacedSource>(devices, *frame, nullptr);
  source_ = opened_.get();
}

std::optional<Event> RunInput::next() {
  if (ahead_.empty()) return source_->next();
  Event event = std::move(ahead_.front());
  ahead_.pop_front();
  return event;
}

}  // namespace isobath

// ReservoirSource: the embedded scene as a source of events.
#pragma once

#include <isobath/io/event.hpp>
#include <isobath/sim/reservoir.hpp>
#include <optional>

namespace isobath {

class ReservoirSource : public Source {
 public:
  explicit ReservoirSource(const ReservoirConfig& config);
  std::optional<Event> next() override;
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  Reservoir scene_;
  SourceReport report_;
  std::optional<Ping> pending_;  ///< comes after its fix
};

}  // namespace isobath

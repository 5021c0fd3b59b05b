// Small events for tests of the pipeline.
#pragma once

#include <isobath/event/event.hpp>
#include <memory>
#include <vector>

namespace isobath::test {

inline Ping ping_at(double t, std::vector<std::uint8_t> samples = {1, 2, 3, 4}, Angle azimuth = {}) {
  const auto fan = std::make_shared<BeamFan>(BeamFan{{azimuth}, {Angle::degrees(3)}, Angle::degrees(35)});
  const RangeWindow window{0, 1.0, static_cast<int>(samples.size())};
  return make_ping(Time(seconds(t)), fan, window, std::move(samples));
}

inline Navigation fix_at(double t, double north, double heading_deg = 0) {
  Navigation fix;
  fix.time = Time(seconds(t));
  fix.X_WB = {Rotation::from_heading(Angle::degrees(heading_deg)), {north, 0, 0}};
  return fix;
}

/// Replays a list; reports one byte an event.
class ListSource : public Source {
 public:
  explicit ListSource(std::vector<Event> events) : events_(std::move(events)) {
    report_.format = "list";
    report_.bytes_total = events_.size();
  }
  std::optional<Event> next() override {
    if (report_.bytes_read == events_.size()) return std::nullopt;
    return events_[report_.bytes_read++];
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }

 private:
  std::vector<Event> events_;
  SourceReport report_;
};

}  // namespace isobath::test

#include <isobath/runtime/pipeline.hpp>

namespace isobath {

// The paragraph: event -> gate -> pose -> decisions -> map -> obstacles.
void Pipeline::take(Event event) {
  const auto verdict = gate_.judge(event);
  if (verdict == EventGate::Verdict::kRejected) return;
  if (verdict == EventGate::Verdict::kRestarted) restart();
  if (auto* ping = std::get_if<Ping>(&event)) hold(std::move(*ping));
  if (const auto* fix = std::get_if<Navigation>(&event)) take_fix(*fix);
  if (std::holds_alternative<RangeReading>(event)) ++counts_.ranges;  // for the depth map, which is not built yet
  release(time_of(event));
}

}  // namespace isobath

#include <algorithm>
#include <isobath/display/display_bytes.hpp>
#include <isobath/display/signal_display.hpp>
#include <limits>
#include <span>
#include <string_view>

namespace isobath {
namespace {

constexpr Duration kInterval = std::chrono::milliseconds(950);
constexpr std::uint64_t kSamplesAnItem = 16;  // an item is sent anew with each of its samples

/// By Signal. A set-point has the name of its signal, and is drawn with it.
constexpr const char* kNames =
    R"([["speed","m/s"],["speed set-point","m/s"],["depth","m"],["depth set-point","m"],["altitude","m"],)"
    R"(["heading","deg"],["heading set-point","deg"],["roll","deg"],["pitch","deg"],["position ±","m"],)"
    R"(["nearest obstacle","m"],["battery","%"],["pings","1/s"]])";

}  // namespace

SignalDisplay::SignalDisplay(DisplayState& items) : items_(items) {
  values_.fill(std::numeric_limits<float>::quiet_NaN());
}

void SignalDisplay::set(Signal signal, double value) {
  values_[static_cast<std::size_t>(signal)] = static_cast<float>(value);
}

void SignalDisplay::sample(Time time, Time start) {
  if (!show_again(last_, time, kInterval)) return;
  last_ = time;
  if (samples_ % kSamplesAnItem == 0) rows_.clear();
  DisplayBytes row;
  row.add(static_cast<float>(to_seconds(time - start)));
  for (const float value : values_) row.add(value);
  rows_ += row.take();
  const std::string_view names = kNames;
  DisplayBytes bytes;
  bytes.add(static_cast<std::uint32_t>(names.size()));
  bytes.append(std::span(reinterpret_cast<const std::uint8_t*>(names.data()), names.size())).pad_to(4);
  items_.set(DisplayKind::kSignals, samples_ / kSamplesAnItem, time, bytes.take() + rows_);
  ++samples_;
}

}  // namespace isobath

// Time of events: nanoseconds since 1970 (UTC) where the input contains the date, else since the start of the log. The
// library never reads the wall clock: a run is a function of its input.
#pragma once

#include <chrono>
#include <string>

namespace isobath {

using Duration = std::chrono::nanoseconds;
using Time = std::chrono::time_point<std::chrono::system_clock, Duration>;

/// Seconds to a duration, rounded to the nearest nanosecond. The argument must be finite and within +-9.2e9 s.
Duration seconds(double value);
/// Whether `seconds` can represent the value: finite and within +-292 years.
bool representable_seconds(double value);

inline double to_seconds(Duration value) { return std::chrono::duration<double>(value).count(); }
inline double to_seconds(Time value) { return to_seconds(value.time_since_epoch()); }

/// "2024-03-13T15:50:16.250Z" (milliseconds), or "12.345 s" for times in the first ten years of the epoch, which are
/// those of a log without a date.
std::string to_text(Time value);

}  // namespace isobath

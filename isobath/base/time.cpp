#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/base/time.hpp>

namespace isobath {

bool representable_seconds(double value) { return std::isfinite(value) && std::abs(value) < 9.2e9; }

Duration seconds(double value) {
  ISOBATH_ASSERT(representable_seconds(value));
  const double whole = std::floor(value);  // split off: a double cannot hold a date and nanoseconds together
  return Duration(static_cast<std::int64_t>(whole) * 1'000'000'000 + std::llround((value - whole) * 1e9));
}

std::string to_text(Time value) {
  using namespace std::chrono;
  if (value.time_since_epoch() < days(3653)) return fmt::format("{:.3f} s", to_seconds(value));
  const auto day = floor<days>(value);
  const year_month_day date(day);
  const hh_mm_ss<milliseconds> clock(floor<milliseconds>(value - day));
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count(), clock.subseconds().count());
}

}  // namespace isobath

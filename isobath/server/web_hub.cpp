#include <isobath/base/time.hpp>
#include <isobath/server/web_hub.hpp>

namespace isobath::web {

Clock::duration ticks_of(double s) { return std::chrono::duration_cast<Clock::duration>(seconds(s)); }

const std::string& Hub::report(Report& report, const std::function<std::string()>& make) {
  const auto now = Clock::now();
  if (!report.made || now - *report.made >= kReportsKept) {
    if (make) report.text = make();
    report.made = now;
  }
  return report.text;
}

}  // namespace isobath::web

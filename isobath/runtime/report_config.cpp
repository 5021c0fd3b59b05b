#include <isobath/runtime/report_config.hpp>

namespace isobath {

std::vector<Field> fields(ReportConfig& c) {
  return {Field::flag("film", &c.film, "The report carries the run, which its page shows again as the live page did."),
          Field::real("film_s", &c.film_s, {0.1, 60}, "s", "Between two moments of the run in the report."),
          Field::real("film_mb", &c.film_mb, {0.01, 200}, "MB",
                      "Most that the run may add to the report: of a run that is larger, what weighs most is shown "
                      "less often.")};
}

}  // namespace isobath

#include <isobath/configuration/report_config.hpp>

namespace isobath {

std::vector<Field> fields(ReportConfig& c) {
  return {Field::flag("film", &c.film, "The report embeds a replay of the run, shown as on the live page."),
          Field::real("film_s", &c.film_s, {0.1, 60}, "s", "Time between two moments of the replay in the report."),
          Field::real("film_mb", &c.film_mb, {0.01, 200}, "MB",
                      "Maximum size of the replay in the report. If a run needs more, its largest items are shown less "
                      "often.")};
}

}  // namespace isobath

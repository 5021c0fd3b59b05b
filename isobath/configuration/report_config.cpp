#include <isobath/configuration/report_config.hpp>

namespace isobath {

std::vector<Field> fields(ReportConfig& c) {
  return {
      Field::flag("replay", &c.replay, "The report embeds a replay of the run, shown as on the live page.").was("film"),
      Field::real("replay_s", &c.replay_s, {0.1, 60}, "s", "Time between two moments of the replay in the report.")
          .was("film_s"),
      Field::real("replay_mb", &c.replay_mb, {0.01, 200}, "MB",
                  "Maximum size of the replay in the report. If a run needs more, its largest items are shown less "
                  "often.")
          .was("film_mb")};
}

}  // namespace isobath

#include <isobath/app/json_output.hpp>
#include <isobath/app/run_json.hpp>
#include <isobath/report/contact_text.hpp>
#include <isobath/report/corner_fix_text.hpp>
#include <isobath/report/fan_calibration.hpp>
#include <isobath/report/placement_pages.hpp>
#include <isobath/report/result_text.hpp>
#include <nlohmann/json.hpp>

namespace isobath::app {
namespace {

using nlohmann::ordered_json;

/// CPU time of each stage, s; the input and the report are stages of their own.
ordered_json load_json(const RunLoad& load) {
  ordered_json all;
  for (std::size_t i = 0; i < kStages; ++i) all[to_text(static_cast<Stage>(i))] = load.stage_s[i];
  return all;
}

ordered_json live_json(const LiveOutcome& live) {
  return {{"lost_pings", live.lost_pings},
          {"unshown_pings", live.unshown_pings},
          {"unshown_notes", live.unshown_notes},
          {"display_problem", live.display_problem}};
}

ordered_json rates_json(const RunOutcome& outcome) {
  const double wall = outcome.timings.wall_s;
  return {{"log_s", outcome.log_s},
          {"wall_s", wall},
          {"pings_per_s", wall > 0 ? static_cast<double>(outcome.counts.pings) / wall : 0},
          {"times_real_time", wall > 0 ? outcome.log_s / wall : 0},
          {"ping_median_ms", outcome.timings.ping_median_ms},
          {"ping_p99_ms", outcome.timings.ping_p99_ms},
          {"stages_s", load_json(outcome.timings.load)},
          {"depth_map_share", outcome.log_s > 0 ? outcome.timings.load.of(Stage::kDepths) / outcome.log_s : 0},
          {"shift_waits", outcome.depth ? outcome.depth->counts.waited : 0}};
}

ordered_json recording_json(const RunRequest& request, const RunOutcome& outcome) {
  if (request.record.empty()) return {};
  return {{"file", request.record.string()},
          {"problem", outcome.recording_problem},
          {"not_recorded", outcome.not_recorded}};
}

ordered_json alarms_with_times(const RunOutcome& outcome) {
  ordered_json alarms = alarms_json(outcome);
  for (std::size_t i = 0; i < alarms.size(); ++i) add_time(alarms[i], "first", outcome.alarms[i].first);
  return alarms;
}

ordered_json obstacles_with_times(const RunOutcome& outcome) {
  ordered_json obstacles = obstacle_list(outcome.obstacles);
  for (std::size_t i = 0; i < obstacles.size(); ++i) add_time(obstacles[i], "last_echo", outcome.obstacles[i].last_hit);
  return obstacles;
}

ordered_json mission_with_times(const MissionOutcome& mission) {
  ordered_json json = mission_json(mission, true);
  for (std::size_t i = 0; i < mission.answers.size(); ++i)
    add_time(json["operator"][i], "time", mission.answers[i].time);
  return json;
}

ordered_json contacts_with_times(const ContactOutcome& heard) {
  ordered_json json = contacts_json(heard);
  for (std::size_t i = 0; i < heard.contacts.size(); ++i) {
    add_time(json["lines"][i], "first", heard.contacts[i].first);
    add_time(json["lines"][i], "last", heard.contacts[i].last);
  }
  return json;
}

}  // namespace

ordered_json run_json(const RunRequest& request, const RunOutcome& outcome) {
  ordered_json json{{"input", request.input.string()},
                    {"problem", outcome.problem},
                    {"warning", outcome.warning},
                    {"undecided", outcome.undecided},
                    {"map_holds", outcome.map_holds},
                    {"alarms", alarms_with_times(outcome)},
                    {"obstacles", obstacles_with_times(outcome)},
                    {"counts", counts_json(outcome)},
                    {"rejected", rejected_json(outcome)},
                    {"depth", outcome.depth ? depth_json(*outcome.depth) : ordered_json()},
                    {"voxels", outcome.voxels ? voxels_json(*outcome.voxels) : ordered_json()},
                    {"sphere", outcome.sphere ? sphere_json(*outcome.sphere) : ordered_json()},
                    {"corner_fix", outcome.corner_fix ? corner_fix_json(*outcome.corner_fix) : ordered_json()},
                    {"contacts", outcome.contacts ? contacts_with_times(*outcome.contacts) : ordered_json()},
                    {"sharpness", outcome.sharpness ? sharpness_json(*outcome.sharpness) : ordered_json()},
                    {"drift", outcome.drift ? drift_json(*outcome.drift) : ordered_json()},
                    {"truth", outcome.truth ? truth_json(*outcome.truth) : ordered_json()},
                    {"mission", outcome.mission ? mission_with_times(*outcome.mission) : ordered_json()},
                    {"rates", rates_json(outcome)},
                    {"fan_model", outcome.fan ? departure_json(*outcome.fan) : ordered_json()},
                    {"live", outcome.live ? live_json(*outcome.live) : ordered_json()},
                    {"recording", recording_json(request, outcome)}};
  add_files(json, request.out, outcome.files);
  return json;
}

}  // namespace isobath::app

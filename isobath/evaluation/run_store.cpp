#include <isobath/base/pending_file.hpp>
#include <isobath/evaluation/run_store.hpp>
#include <nlohmann/json.hpp>

namespace isobath {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FaultInjectionCheck, fault, after_s, failure)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StoryCheck, after_s, scans, failure, min_injected_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RulesScore, give_way, passed_astern, head_on, passed_port_to_port, stand_on,
                                   stood_on)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(GroupRunScore, vehicles, searched, overlap, all_searched_s, separation_m, lost_s,
                                   reassigned_s, passage_shared_s, bit_rate)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RunScore, collision, near_miss, encounter, contact_s, contact_with, min_clearance_m,
                                   nearest_body, goal_reached, goal_s, goal_distance_m, refused, points_dropped, path_m,
                                   duration_s, path_ratio, time_ratio, delay_pings, first_range_m, range_error_m,
                                   bodies_missed, replans, false_replans, safety_actions, opening_known_m,
                                   opening_share, scans, false_obstacles, near_false_obstacles, unseen_false_obstacles,
                                   moving_bodies, moving_known, moving_known_s, ospa_m, velocity_rms, proof, story,
                                   rules, group)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ScoredRun, seed, variant, conditions, way_m, no_way, scores)

std::string to_line(const ScoredRun& run, const std::string& fingerprint) {
  nlohmann::json json = run;
  json["fingerprint"] = fingerprint;
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::optional<ScoredRun> from_line(const std::string& line, const std::string& fingerprint) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object() || json.value("fingerprint", nlohmann::json()) != fingerprint) return std::nullopt;
  try {
    return json.get<ScoredRun>();
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

RunStore::RunStore(std::filesystem::path file, std::string fingerprint)
    : file_(std::move(file)), fingerprint_(std::move(fingerprint)) {
  std::ifstream in(file_, std::ios::binary);
  std::string line;
  while (std::getline(in, line)) {
    if (auto run = from_line(line, fingerprint_)) runs_.insert_or_assign(run->seed, std::move(*run));
  }
  rewrite();
}

void RunStore::rewrite() {
  out_.close();
  std::string text;
  for (const auto& [seed, run] : runs_) text += to_line(run, fingerprint_) + "\n";
  write_whole_file(file_, text);
  out_.open(file_, std::ios::binary | std::ios::app);
}

void RunStore::add(const ScoredRun& run) {
  runs_.insert_or_assign(run.seed, run);
  out_ << to_line(run, fingerprint_) + "\n";
  if (!out_.flush()) throw Error("cannot write", {.file = file_.string()}, "", "check space and permissions");
}

void RunStore::close() {
  rewrite();
  out_.close();
}

}  // namespace isobath

#include <cmath>
#include <isobath/display/decision_json.hpp>
#include <nlohmann/json.hpp>

namespace isobath {
namespace {

using nlohmann::ordered_json;

/// Rounded to 1e-6, which is finer than any sonar and still readable; null if not finite.
ordered_json tidy(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(value * 1e6) / 1e6;
}

ordered_json place_json(const Eigen::Vector2d& p) { return ordered_json::array({tidy(p.x()), tidy(p.y())}); }

ordered_json decision_content(const Decision& d) {
  ordered_json json{{"number", d.number},      {"time_ns", d.time.time_since_epoch().count()},
                    {"time", to_text(d.time)}, {"agent", d.agent},
                    {"what", d.what},          {"reason", d.reason}};
  if (d.obstacle_number > 0) json["obstacle"] = d.obstacle_number;
  if (d.obstacle) json["obstacle_m"] = place_json(*d.obstacle);
  if (d.leg) json["leg"] = *d.leg;
  if (d.margin_m) json["margin_m"] = tidy(*d.margin_m);
  if (d.opening) {
    json["opening"] = {{"distance_m", tidy(d.opening->distance_m)},
                       {"width_m", tidy(d.opening->width_m)},
                       {"height_m", d.opening->height_m > 0 ? tidy(d.opening->height_m) : nullptr},
                       {"free_share", tidy(d.opening->free_share)}};
  }
  if (d.approach) json["approach"] = {{"in_s", tidy(d.approach->in_s)}, {"gap_m", tidy(d.approach->gap_m)}};
  if (!d.way.empty()) {
    json["way_m"] = ordered_json::array();
    for (const Eigen::Vector2d& p : d.way) json["way_m"].push_back(place_json(p));
  }
  return json;
}

std::string dump(const ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace

std::string decision_json(const Decision& decision, const std::optional<Eigen::Vector2d>& obstacle_then_W) {
  ordered_json json = decision_content(decision);
  if (decision.approach && obstacle_then_W) json["approach"]["obstacle_m"] = place_json(*obstacle_then_W);
  return dump(json, -1);
}

std::string decisions_text(const std::vector<Decision>& decisions) {
  ordered_json json{{"frame", "world: north, east, metres, as estimated by the vehicle"},
                    {"decisions", ordered_json::array()}};
  for (const Decision& d : decisions) json["decisions"].push_back(decision_content(d));
  return dump(json, 1) + "\n";
}

}  // namespace isobath

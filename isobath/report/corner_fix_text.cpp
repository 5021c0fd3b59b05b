#include <cmath>
#include <fmt/format.h>
#include <isobath/report/corner_fix_text.hpp>
#include <nlohmann/json.hpp>

namespace isobath {

using nlohmann::ordered_json;

namespace {

double millimetres(double metres) { return std::round(metres * 1e3) / 1e3; }

}  // namespace

ordered_json corner_fix_json(const CornerFixOutcome& fixes) {
  ordered_json moves = ordered_json::array();
  for (const double move : fixes.last_moves_m) moves.push_back(millimetres(move));
  return {{"charted", fixes.charted},
          {"sweeps", fixes.sweeps},
          {"taken", fixes.taken},
          {"refused", fixes.refused},
          {"last_moves_m", std::move(moves)},
          {"farthest_move_m", millimetres(fixes.farthest_move_m)},
          {"offset_north_m", millimetres(fixes.offset.x())},
          {"offset_east_m", millimetres(fixes.offset.y())},
          {"sigma_m", millimetres(fixes.sigma_m)}};
}

std::string corner_fix_text(const CornerFixOutcome& fixes) {
  if (fixes.charted == 0) return "corner fixes: none, because the chart shows no corner of a wall";
  std::string text = fmt::format("corner fixes: {} taken, {} refused, in {} sweeps with a corner", fixes.taken,
                                 fixes.refused, fixes.sweeps);
  if (fixes.taken == 0) return text;
  text += "; the last ones moved the position by";
  for (std::size_t i = 0; i < fixes.last_moves_m.size(); ++i) {
    text += fmt::format("{} {:.2f}", i == 0 ? "" : ",", fixes.last_moves_m[i]);
  }
  return text + fmt::format(" m, the farthest by {:.2f} m; all together north {:+.2f} m, east {:+.2f} m",
                            fixes.farthest_move_m, fixes.offset.x(), fixes.offset.y());
}

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <isobath/app/echo_picture.hpp>
#include <string_view>

namespace isobath::app {

std::vector<std::string> echo_picture(const EchoPanorama& echoes, int rows) {
  constexpr std::string_view kShades = " .:-=*#%@";
  constexpr int kSteps = 4;  // samples across and along a character, which is twice as tall as wide
  const int columns = 2 * rows;
  const double row_m = 2 * echoes.reach_m() / rows, column_m = row_m / 2;
  std::vector<std::string> picture(static_cast<std::size_t>(rows), std::string(static_cast<std::size_t>(columns), ' '));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double strongest = 0;
      for (int i = 0; i < kSteps * kSteps; ++i) {
        const int down = i / kSteps, across = i % kSteps;
        const double ahead = echoes.reach_m() - (row + (down + 0.5) / kSteps) * row_m;
        const double starboard = (column + (across + 0.5) / kSteps) * column_m - echoes.reach_m();
        const double range = std::hypot(ahead, starboard);
        strongest = std::max(strongest, echoes.at(Angle::radians(std::atan2(starboard, ahead)), range));
      }
      const auto shade = static_cast<std::size_t>(std::min(strongest, 0.999) * static_cast<double>(kShades.size()));
      picture[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = kShades[shade];
    }
  }
  if (rows > 0) picture[static_cast<std::size_t>(rows) / 2][static_cast<std::size_t>(rows)] = '+';
  for (std::string& line : picture) line.erase(line.find_last_not_of(' ') + 1);
  return picture;
}

}  // namespace isobath::app

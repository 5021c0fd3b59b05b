#include <algorithm>
#include <cmath>
#include <isobath/sim/field_of_view.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr int kScanningCells = 9, kSkirt = 5;
constexpr double kMinViewGain = 1e-4;  // gain of a receive beam below which a direction is ignored

}  // namespace

ViewCell cell_of(double azimuth, double d_azimuth, double low, double high, const BeamPattern& pattern) {
  const double elevation = 0.5 * (low + high), ca = std::cos(azimuth), sa = std::sin(azimuth);
  const double ce = std::cos(elevation), se = std::sin(elevation);
  return {.u = {ce * ca, ce * sa, -se},
          .across = {-sa, ca, 0},
          .up = {-se * ca, -se * sa, -ce},
          .half_across = 0.5 * d_azimuth * ce,
          .half_up = 0.5 * (high - low),
          .solid_angle = d_azimuth * (std::sin(high) - std::sin(low)),
          .elevation = elevation,
          .gain = pattern.gain(elevation)};
}

FieldOfView::FieldOfView(const SonarConfig& c)
    : across(c.pattern, c.width, c.side_lobe_db), height(c.height_pattern, c.height, c.side_lobe_db) {
  const bool fan = c.kind != SonarKind::kScanning && c.beams > 1;
  const double first = fan ? -c.sector.radians() / 2 : 0;
  const double spacing = fan ? c.sector.radians() / (c.beams - 1) : c.width.radians();
  for (int b = 0; b < (fan ? c.beams : 1); ++b) beams.push_back(first + b * spacing);
  fan ? cut_fan(c, spacing) : cut_single(c);
  weigh();
  hearing = across.reach(1e-4);
}

/// Divides the elevations: most rays within 1.5 beam heights, a few beyond for the side lobes.
void FieldOfView::cut_heights(const SonarConfig& config) {
  const double half = 0.5 * config.height.radians();
  const bool ideal = config.height_pattern == PatternKind::kIdeal;
  const double inner = std::min(ideal ? half : 1.5 * half, 0.49 * std::numbers::pi);
  const double outer = ideal ? inner : std::min(height.reach(1e-4), 0.49 * std::numbers::pi);
  const int skirt = outer > 1.2 * inner && config.rays >= 8 ? std::max(1, config.rays / 8) : 0;
  const int middle = std::max(1, config.rays - 2 * skirt);
  for (int i = skirt; i > 0; --i) edges.push_back(-inner - (outer - inner) * i / skirt);
  for (int i = 0; i <= middle; ++i) edges.push_back(-inner + 2 * inner * i / middle);
  for (int i = 1; i <= skirt; ++i) edges.push_back(inner + (outer - inner) * i / skirt);
  cell_up = 2 * inner / middle;
}

void FieldOfView::add_direction(double azimuth, double width) {
  directions.push_back(azimuth);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    cells.push_back(cell_of(azimuth, width, edges[i], edges[i + 1], height));
  }
}

void FieldOfView::cut_fan(const SonarConfig& config, double spacing) {
  cut_heights(config);
  const int beyond = static_cast<int>(std::ceil(std::min(2 * config.width.radians(), across.reach(1e-3)) / spacing));
  cell_across = spacing / config.rays_across;
  const int count = static_cast<int>(beams.size());
  for (int i = -beyond * config.rays_across; i < (count + beyond) * config.rays_across; ++i) {
    add_direction(beams[0] + ((i + 0.5) / config.rays_across - 0.5) * spacing, cell_across);
  }
}

void FieldOfView::cut_single(const SonarConfig& config) {
  cut_heights(config);
  const double half = 0.5 * config.width.radians();
  const bool ideal = config.pattern == PatternKind::kIdeal;
  const double inner = std::min(ideal ? half : 3 * half, std::numbers::pi / 2);
  cell_across = 2 * inner / kScanningCells;
  std::vector<std::pair<double, double>> skirt;  // growing cells, out to where the gain is negligible
  const double outer = ideal ? inner : std::min(across.reach(1e-4), 0.9 * std::numbers::pi);
  double at = inner, size = 2 * cell_across;
  while (at < outer && static_cast<int>(skirt.size()) < kSkirt) {
    const bool last = static_cast<int>(skirt.size()) + 1 == kSkirt;
    const double next = last ? outer : std::min(outer, at + size);
    skirt.emplace_back(0.5 * (at + next), next - at);
    at = next;
    size *= 2;
  }
  for (auto s = skirt.rbegin(); s != skirt.rend(); ++s) add_direction(-s->first, s->second);
  for (int i = 0; i < kScanningCells; ++i) add_direction(-inner + (i + 0.5) * cell_across, cell_across);
  for (const auto& [azimuth, width] : skirt) add_direction(azimuth, width);
}

void FieldOfView::weigh() {
  weights.resize(beams.size());
  for (std::size_t b = 0; b < beams.size(); ++b) {
    for (std::size_t d = 0; d < directions.size(); ++d) {
      const double gain = across.gain(directions[d] - beams[b]);
      if (gain > kMinViewGain) weights[b].push_back({static_cast<int>(d), static_cast<float>(gain)});
    }
  }
}

}  // namespace isobath

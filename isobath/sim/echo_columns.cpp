#include <algorithm>
#include <isobath/sim/echo_columns.hpp>
#include <isobath/sim/fan_loops.hpp>

namespace isobath {
namespace {

void fill_volume(const EchoPaths& paths, const std::vector<double>& back_from, EchoColumn& column) {
  const double strength = paths.volume_strength, bin = paths.bin_m();
  const double pulse = std::max(bin, paths.config.resolution_m);
  double open = 0;
  for (int k = 0; k < paths.config.bins; ++k) {
    open += column.volume[static_cast<std::size_t>(k)];
    const double r = (k + 0.5) * bin;
    const auto value = static_cast<float>(strength * open * pulse / (r * r) * back_from[static_cast<std::size_t>(k)]);
    column.power[static_cast<std::size_t>(k)] += value;
    if (value > column.strongest[static_cast<std::size_t>(k)]) {
      column.strongest[static_cast<std::size_t>(k)] = value;
      column.labels[static_cast<std::size_t>(k)] = EchoLabel(kNothing, EchoPath::kVolume);
    }
  }
}

}  // namespace

EchoColumn::EchoColumn(int bins)
    : power(static_cast<std::size_t>(bins) + kLoopPad),
      strongest(power.size()),
      labels(power.size()),
      volume(static_cast<std::size_t>(bins) + 1) {}

void deposit_echo(const EchoPaths& paths, const PathEcho& echo, float* power, float* strongest, EchoLabel* labels) {
  const double bin = paths.bin_m();
  const double pulse = paths.config.resolution_m > bin ? paths.config.resolution_m : 0;
  double near = echo.span.near, far = echo.span.far, height_of = echo.power;
  if (pulse > 0) {
    const double length = std::max(far - near, pulse), middle = 0.5 * (near + far);
    near = middle - length / 2;
    far = middle + length / 2;
    height_of = echo.power * pulse / length;
  } else if (far - near > 1e-6) {
    height_of = echo.power * bin / (far - near);
  }
  const double a = near / bin, b = far / bin;
  if (!(b > 0) || !(a < paths.config.bins)) return;
  const double middle_bin = 0.5 * (a + b);
  const double slope = b - a > 2 ? std::min(3 / middle_bin, 1.8 / (b - a)) : 0;
  const int first = std::max(0, static_cast<int>(a)), last = std::min(paths.config.bins - 1, static_cast<int>(b));
  // Within a span the echo falls with about the third power of range, as that of a plane at grazing incidence.
  // Many rays meet the same target: their powers add up.
  if (pulse > 0 || far - near > 1e-6) {
    return add_echo({a, b, middle_bin, slope, height_of, echo.label}, first, last, power, strongest, labels);
  }
  // A point target lies in one bin.
  add_echo({double(first), first + 1.0, middle_bin, 0, height_of, echo.label}, first, first, power, strongest, labels);
}

void fill_column(const EchoPaths& paths, int direction, const std::vector<double>& back_from,
                 const std::vector<float>& by_bin, EchoColumn& column) {
  std::fill(column.power.begin(), column.power.end(), 0.f);
  std::fill(column.strongest.begin(), column.strongest.end(), 0.f);
  std::fill(column.labels.begin(), column.labels.end(), EchoLabel());
  std::fill(column.volume.begin(), column.volume.end(), 0.0);
  std::vector<PathEcho> echoes;
  const ViewCell* cells = paths.view.column(direction);
  for (int i = 0; i < paths.view.cells_a_column(); ++i) {
    const ViewCell& cell = cells[i];
    double open = 0;
    echoes.clear();
    paths.trace(cell, kNothing, open, echoes);
    for (const PathEcho& echo : echoes) {
      deposit_echo(paths, echo, column.power.data(), column.strongest.data(), column.labels.data());
    }
    column.volume[0] += cell.gain * cell.solid_angle;
    const int end = static_cast<int>(std::min<double>(open / paths.bin_m(), paths.config.bins));
    column.volume[static_cast<std::size_t>(end)] -= cell.gain * cell.solid_angle;
  }
  if (paths.config.volume_reverberation) fill_volume(paths, back_from, column);
  column.loudest = largest_product(column.strongest.data(), by_bin.data(), paths.config.bins);
}

}  // namespace isobath

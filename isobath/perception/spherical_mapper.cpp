#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/perception/spherical_mapper.hpp>
#include <isobath/sonar/ping_quality.hpp>
#include <numbers>
#include <utility>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kWidthOverSigma = 2.355;  // half-power width of a normal, 2 sqrt(2 ln 2)

double number_from_log_odds(double l) { return l > 30 ? l : std::log1p(std::exp(l)); }
double log_odds_from_number(double n) { return n > 30 ? n : std::log(std::expm1(n)); }

}  // namespace

std::vector<Field> fields(SphericalMapperConfig& c) {
  using C = SphericalMapperConfig;
  return {
      Field::choice("rule", &c.rule, {{"log_odds", C::Rule::kLogOdds}, {"maximum_response", C::Rule::kMaximumResponse}},
                    "Rule by which a reading changes cells; maximum_response is the paper's, which clears nothing."),
      Field::choice("axes", &c.axes, {{"north_up", C::Axes::kNorthUp}, {"course_up", C::Axes::kCourseUp}},
                    "Whether the grid's y axis points north or along the course."),
      Field::real("sigma_m", &c.sigma_m, {0.001, 10}, "m", "Minimum standard deviation of a range."),
      Field::real("sigma_share", &c.sigma_share, {0, 0.2}, "1", "Standard deviation of a range, as a share of it."),
      Field::real("mask", &c.mask, {0.1, 5}, "1", "Standard deviations about an echo within which cells change."),
      Field::integer("max_cells", &c.max_cells, {1, 10000}, "cells", "Maximum number of cells that one echo changes.")
          .was("most_cells"),
      Field::real("hit", &c.hit, {0.01, 0.999}, "1", "Probability that an echo comes from a stationary object."),
      Field::real("pass", &c.pass, {0, 0.999}, "1", "Probability that an object that fills a beam echoes."),
      Field::real("contrast", &c.contrast, {0, 100}, "1",
                  "Contrast of the echoes of a sonar that count, in deviations of its beam's noise, as for "
                  "safety.echo_contrast; those that come too densely for false alarms count too. 0: every decision for "
                  "an echo counts."),
      Field::real("tau_s", &c.tau_s, {0, 1e7}, "s", "Time in which evidence fades to 1/e; 0: no fading."),
  };
}

SphericalMapper::SphericalMapper(const SphericalMapperConfig& config, SphericalGrid& grid)
    : config_(config), grid_(grid), kappa_(-std::log1p(-config.hit)) {}

Vector3d SphericalMapper::to_grid(const Vector3d& v_W) const {
  const Vector3d v = grid_axes_from_world(v_W);
  const double c = cos(grid_.turned()), s = sin(grid_.turned());
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()};
}

void SphericalMapper::move_to(const Pose& X_WB, Time time) {
  if (!X_WB_) {
    faded_ = time;
  } else {
    grid_.translate(to_grid(X_WB.translation - X_WB_->translation));
  }
  X_WB_ = X_WB;
  if (config_.axes == SphericalMapperConfig::Axes::kCourseUp) {
    grid_.turn((X_WB.rotation.heading() - grid_.turned()).wrapped());
  }
  if (time < faded_) faded_ = time;  // the clock was set back
  // Fades in steps of a hundredth of tau, not at each beam.
  const Duration tau = seconds(config_.tau_s);
  if (config_.tau_s > 0 && time - faded_ >= tau / 100) {
    grid_.decay(time - faded_, tau, time);
    faded_ = time;
  }
}

void SphericalMapper::update(const RangeReading& reading, const Pose& X_WB) {
  move_to(X_WB, reading.time);
  look_from(
      X_WB * reading.X_BS, Vector3d::UnitX(),
      {.width = reading.width, .range_m = reading.range_m, .max_range_m = reading.max_range_m, .time = reading.time});
}

void SphericalMapper::update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB) {
  move_to(X_WB, ping.time);
  const Pose X_WS = X_WB * ping.X_BS;
  const auto& azimuth = ping.fan->azimuth;
  const auto& width = ping.fan->width;
  beams_.clear();
  for (int beam = 0; beam < decisions.beams(); ++beam) beams_.push_back(heard(ping, decisions, beam));
  const auto look = [&](Angle a, Angle wide, const Heard& heard) {
    if (!(heard.told.to_m > 0) && !heard.range_m) return;
    look_from(X_WS, {cos(a), sin(a), 0},
              {.width = wide,
               .range_m = heard.range_m,
               .max_range_m = ping.window.end_m(),
               .time = ping.time,
               .told = heard.told});
  };
  const double bucket = 0.999 * grid_.buckets().step().radians();
  for (std::size_t first = 0; first < beams_.size();) {
    std::size_t last = first;
    while (last + 1 < beams_.size() && std::abs((azimuth[last + 1] - azimuth[first]).radians()) < bucket) ++last;
    Heard all = beams_[first];
    for (std::size_t b = first + 1; b <= last; ++b) {
      const Heard& beam = beams_[b];
      if (beam.range_m && (!all.range_m || *beam.range_m < *all.range_m)) all.range_m = beam.range_m;
      all.told = {std::max(all.told.from_m, beam.told.from_m), std::min(all.told.to_m, beam.told.to_m)};
    }
    if (!all.range_m || all.told.to_m >= *all.range_m) {  // else it is not the same for all
      look((azimuth[first] + azimuth[last]) / 2, abs(azimuth[last] - azimuth[first]) + width[first], all);
    } else {
      for (std::size_t b = first; b <= last; ++b) look(azimuth[b], width[b], beams_[b]);
    }
    first = last + 1;
  }
}

SphericalMapper::Heard SphericalMapper::heard(const Ping& ping, const EchoDecisions& decisions, int beam) const {
  Heard heard;
  std::optional<int> echo;
  if (config_.contrast > 0) {
    echo = nearest_sure_echo(ping, decisions, beam, contrast_of_fan(config_.contrast, decisions.beams()));
  }
  bool begun = false, gap = false;  // a gap is longer than a layer
  double told_to = 0;
  for (int bin = 0; bin < decisions.bins(); ++bin) {
    if (!decisions.tells(beam, bin)) continue;
    const double from = ping.window.edge(bin);
    if (!std::exchange(begun, true)) {
      heard.told.from_m = from > kAboutVehicle_m ? from : 0;
    } else {
      gap = gap || from - told_to >
                       grid_.layers().thickness(grid_.layers().layer_at(std::min(told_to, grid_.config().range_m)));
    }
    told_to = ping.window.edge(bin + 1);
    if (!gap) heard.told.to_m = told_to;
    if (config_.contrast > 0 ? bin != echo : !decisions.hit(beam, bin)) continue;
    heard.range_m = ping.window.centre(bin);
    break;
  }
  return heard;
}

void SphericalMapper::look_from(const Pose& X_WS, const Vector3d& u_S, const SphericalLook& look) {
  SphericalLook placed = look;
  placed.from = to_grid(X_WS.translation - X_WB_->translation);
  placed.axis = to_grid(X_WS.rotation * u_S);
  add(placed);
}

void SphericalMapper::add(const SphericalLook& look) {
  const double reach = std::min(look.range_m.value_or(look.max_range_m), grid_.config().range_m);
  const Vector3d end_T = grid_.to_table(look.from + reach * look.axis);
  const double range = end_T.norm();
  if (!(range > 0 && std::isfinite(range))) return;
  const double sigma = std::max({config_.sigma_m, config_.sigma_share * reach, look.sigma_m});
  const ReadingGaussian reading{end_T / range, range, sigma, look.width.radians() / kWidthOverSigma};
  const auto clear = [&](double end) {
    return ClearViews::Stretch{look.told.from_m,
                               std::min(look.told.to_m, look.range_m ? end - config_.mask * sigma : end)};
  };
  if (config_.rule == SphericalMapperConfig::Rule::kLogOdds) pass(reading, clear(range));
  grid_.add_clear(look.from, look.axis, look.width / 2, clear(reach), look.time);
  if (!look.range_m || *look.range_m > grid_.config().range_m) return;
  hit(reading);
  grid_.add_echo(look.from + *look.range_m * look.axis, sigma, look.time);
}

void SphericalMapper::hit(const ReadingGaussian& reading) {
  touched_cells(grid_, reading, config_.mask, config_.max_cells, touched_);
  for (const TouchedCell& cell : touched_) {
    const double l = grid_.log_odds(cell.place);
    if (config_.rule == SphericalMapperConfig::Rule::kMaximumResponse) {
      const double share = std::min(cell.response, 1 - 1e-12);
      grid_.set_log_odds(cell.place, std::max(l, std::log(share / (1 - share))));
    } else {
      grid_.set_log_odds(cell.place, log_odds_from_number(number_from_log_odds(l) + kappa_ * cell.mass));
    }
  }
}

void SphericalMapper::pass(const ReadingGaussian& reading, const ClearViews::Stretch& clear) {
  touched_directions(grid_, reading, config_.mask, directions_);
  const SphericalLayers& layers = grid_.layers();
  for (const TouchedDirection& d : directions_) {
    for (const SphericalCell& cell : grid_.cells().beam(d.direction)) {
      if (layers.outer(cell.layer) > clear.to_m) break;
      if (layers.inner(cell.layer) < clear.from_m) continue;
      const double l = static_cast<double>(cell.log_odds);
      const double left = number_from_log_odds(l) * (1 - config_.pass * d.share);
      grid_.set_log_odds({d.direction, cell.layer}, log_odds_from_number(left));
    }
  }
}

SonarResolution listed_resolution(const std::string& name) {
  if (name == "em_1000_shallow") return {name, 200, 0.15, Angle::degrees(2.5), Angle::degrees(2.5), 60};
  if (name == "wesmar_ss150") return {name, 100, 0.5, Angle::degrees(6.5), Angle::degrees(6.5), 1};
  if (name == "simulated_2_5") return {name, 50, 0.15, Angle::degrees(2.5), Angle::degrees(2.5), 144};
  throw Error("unknown sonar \"" + name + "\"", {}, "em_1000_shallow, wesmar_ss150 or simulated_2_5");
}

SphericalGridConfig grid_for(const SonarResolution& sonar) {
  SphericalGridConfig config;
  config.range_m = sonar.range_m;
  config.min_layer_m = sonar.resolution_m;
  config.bucket = Angle::degrees(180 / std::ceil(180 / sonar.beam_spacing.degrees() - 1e-9));
  return config;
}

std::string coarser_than_sonar(const SphericalGridConfig& grid, const SonarResolution& sonar) {
  if (grid.min_layer_m > sonar.resolution_m * 1.001) {
    return fmt::format("layers of {:g} m are thicker than the sonar's resolution, {:g} m", grid.min_layer_m,
                       sonar.resolution_m);
  }
  if (grid.bucket.degrees() > sonar.beam_spacing.degrees() * 1.001) {
    return fmt::format("directions of {:g} degrees are wider than the spacing of the sonar's beams, {:g} degrees",
                       grid.bucket.degrees(), sonar.beam_spacing.degrees());
  }
  return {};
}

}  // namespace isobath

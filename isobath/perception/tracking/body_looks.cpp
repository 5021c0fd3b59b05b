#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/perception/tracking/body_looks.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kMaxSector = std::numbers::pi / 2;  // rad: a sector ends here also where a cluster is open
constexpr double kMaxPause_s = 2;                    // between two beams of a sector
constexpr double kFwhm = 2.355;                      // full width at half maximum, in standard deviations
constexpr double kBeamsOfCentre = 4;                 // the centre over many beams is at most twice as sure

}  // namespace

std::vector<Field> fields(BodyLooksConfig& c) {
  return {
      Field::real("link_m", &c.link_m, {0.01, 100}, "m",
                  "Echoes of neighbouring beams this near in range are of one body."),
      Field::integer("min_echoes", &c.min_echoes, {1, 1000}, "1", "Fewer echoes together are no reading of a body."),
      Field::real("max_size_m", &c.max_size_m, {0.1, 1000}, "m", "What is larger is a structure, which does not move."),
      Field::real("sector_deg", &c.sector_deg, {1, 90}, "deg", "Sector of a scanning head that is one look."),
      Field::real("range_sigma_m", &c.range_sigma_m, {0.001, 10}, "m", "Standard deviation of the range of a body."),
      Field::real("position_sigma_m", &c.position_sigma_m, {0, 100}, "m",
                  "Standard deviation of the own position from one look to the next."),
      Field::degrees("heading_sigma_deg", &c.heading_sigma, {0, 90}, "The same of the own heading."),
      Field::real("centre_share", &c.centre_share, {0, 1}, "1",
                  "Variance of the centre of a body's echoes, as a share of the variance of the echoes about it."),
      Field::real("detection", &c.detection, {0.01, 0.999}, "1", "Probability that a look shows a body in view."),
      Field::real("hidden", &c.hidden, {0, 1}, "1",
                  "Share of that in and behind a structure, and in the echoes of another body."),
      Field::real("behind", &c.behind, {0, 1}, "1", "Share of that behind another body."),
  };
}

double BodyLook::detection(const Eigen::Vector2d& p_W) const {
  const Eigen::Vector2d to = p_W - from_W_;
  const double range = to.norm();
  if (range < near_m_ || range > far_m_) return 0;
  const double off = (Angle::radians(std::atan2(to.y(), to.x())) - middle_).wrapped().radians();
  if (std::abs(off) > half_rad_) return 0;
  double share = 1;
  for (const Shadow& s : shadows_) {
    if (off >= s.low && off <= s.high && range >= s.near_m)
      share = std::min(share, range > s.far_m ? s.behind : s.beside);
  }
  return share * seen_;
}

const BodyLook* BodyLooks::add(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB) {
  const Pose X_WS = X_WB * ping.X_BS;
  const int beams = ping.fan->beams();
  const auto beam_of = [&](int b) {
    const Angle a = ping.fan->azimuth[b];
    const Eigen::Vector3d u_W = X_WS.rotation * Eigen::Vector3d(cos(a), sin(a), 0);
    const int beside = b + 1 < beams ? b + 1 : b - 1;
    const double step = beams > 1 ? abs(ping.fan->azimuth[beside] - a).radians() : ping.fan->width[b].radians();
    const double gap = ping.fan->width[b].radians() / std::max(step, 1e-6);
    return Beam{
        ping.time, X_WS.translation.head<2>(), Angle::radians(std::atan2(u_W.y(), u_W.x())),         ping.fan->width[b],
        a,         u_W.head<2>().norm(),       std::clamp(static_cast<int>(std::lround(gap)), 1, 64)};
  };
  parts_.clear();
  const bool is_fan = beams > 1;
  level_bin_m_ = beam_of(0).level_share * ping.window.bin_m;
  false_alarm_ = decisions.false_alarm;
  bool done = false;
  if (is_fan || !continues(ping, beam_of(0))) {
    done = !is_fan && beams_ > 0;
    if (done) end(false);
    begin(ping, beam_of(0));
  }
  for (int b = 0; b < beams; ++b) add_beam(ping, decisions, b, beam_of(b));
  if (is_fan) {
    end(true);
    return &look_;
  }
  if (done) return &look_;
  const double turned = std::abs(turned_rad_);
  const bool is_open = std::any_of(clusters_.begin(), clusters_.end(), [&](const Cluster& c) {
    return c.joined == static_cast<std::size_t>(&c - clusters_.data()) && c.last_beam + 1 >= beams_ - 1;
  });
  if (turned < Angle::degrees(config_.sector_deg).radians() || (is_open && turned < kMaxSector)) return nullptr;
  end(false);
  return &look_;
}

/// Whether the beam of a scanning head goes on with the sector.
bool BodyLooks::continues(const Ping& ping, const Beam& beam) const {
  if (beams_ == 0 || ping.time < last_ || to_seconds(ping.time - last_) > kMaxPause_s) return false;
  const double step = (beam.azimuth - last_azimuth_).wrapped().radians();
  return beams_ < 2 || step * turned_rad_ >= 0;
}

void BodyLooks::begin(const Ping& ping, const Beam& beam) {
  clusters_.clear();
  runs_.clear();
  beams_ = 0;
  turned_rad_ = 0;
  half_width_rad_ = beam.width.radians() / 2;
  begin_ = last_ = ping.time;
  from_W_ = beam.from_W;
  first_azimuth_ = last_azimuth_ = beam.azimuth;
  look_.near_m_ = beam.level_share * ping.window.start_m;
  look_.far_m_ = beam.level_share * ping.window.end_m();
}

void BodyLooks::add_beam(const Ping& ping, const EchoDecisions& decisions, int index, const Beam& beam) {
  turned_rad_ += (beam.azimuth - last_azimuth_).wrapped().radians();
  last_azimuth_ = beam.azimuth;
  last_ = ping.time;
  forget_runs(beam.gap);
  const int link = std::max(1, static_cast<int>(config_.link_m / ping.window.bin_m));
  const std::uint64_t* hits = decisions.hits(index);
  int first = -1, last = -1, echoes = 0;
  for (int w = 0; w < decisions.words(); ++w) {
    for (std::uint64_t bits = hits[w] & decisions.usable()[w]; bits != 0; bits &= bits - 1) {
      const int bin = 64 * w + std::countr_zero(bits);
      if (!decisions.tells(index, bin)) continue;
      if (first >= 0 && bin - last > link) {
        add_run(ping, beam, first, last, echoes);
        first = -1;
        echoes = 0;
      }
      if (first < 0) first = bin;
      last = bin;
      ++echoes;
    }
  }
  if (first >= 0) add_run(ping, beam, first, last, echoes);
  ++beams_;
}

void BodyLooks::add_run(const Ping& ping, const Beam& beam, int first_bin, int last_bin, int echoes) {
  if (runs_.size() >= kMaxRuns) {
    ++left_out_;
    return;
  }
  Cluster one;
  one.near_m = beam.level_share * ping.window.edge(first_bin);
  one.far_m = beam.level_share * ping.window.edge(last_bin + 1);
  const double middle = (one.near_m + one.far_m) / 2, length = one.far_m - one.near_m;
  const Eigen::Vector2d along(cos(beam.azimuth), sin(beam.azimuth));
  const Eigen::Vector2d p = beam.from_W - from_W_ + middle * along;
  const Angle half = beam.width / 2;
  parts_.push_back(
      {{beam.in_S - half, beam.in_S + half, ping.window.edge(first_bin - 1), ping.window.edge(last_bin + 2)},
       from_W_ + p,
       clusters_.size()});
  one.joined = clusters_.size();
  one.echoes = echoes;
  one.sum = echoes * p;
  one.squares = echoes * (p * p.transpose() + length * length / 12 * along * along.transpose());
  one.time_s = echoes * to_seconds(beam.time - begin_);
  one.low_rad = one.high_rad = turned_rad_;
  one.width_rad = beam.width.radians();
  one.first_beam = one.last_beam = beams_;
  clusters_.push_back(one);
  for (const Run& run : runs_) {
    if (run.beam == beams_) break;  // the newest runs stand last
    if (run.near_m > one.far_m + config_.link_m || run.far_m < one.near_m - config_.link_m) continue;
    join(clusters_.size() - 1, run.cluster);
  }
  runs_.push_back({beams_, one.near_m, one.far_m, clusters_.size() - 1});
}

std::size_t BodyLooks::root(std::size_t cluster) const {
  while (clusters_[cluster].joined != cluster) cluster = clusters_[cluster].joined;
  return cluster;
}

void BodyLooks::join(std::size_t from, std::size_t to) {
  from = root(from);
  to = root(to);
  if (from == to) return;
  Cluster& a = clusters_[to];
  Cluster& b = clusters_[from];
  b.joined = to;
  a.echoes += b.echoes;
  a.sum += b.sum;
  a.squares += b.squares;
  a.time_s += b.time_s;
  a.near_m = std::min(a.near_m, b.near_m);
  a.far_m = std::max(a.far_m, b.far_m);
  a.low_rad = std::min(a.low_rad, b.low_rad);
  a.high_rad = std::max(a.high_rad, b.high_rad);
  a.width_rad = std::max(a.width_rad, b.width_rad);
  a.first_beam = std::min(a.first_beam, b.first_beam);
  a.last_beam = std::max(a.last_beam, b.last_beam);
}

void BodyLooks::forget_runs(int gap) {
  std::erase_if(runs_, [&](const Run& run) { return run.beam + gap + 1 < beams_; });
}

void BodyLooks::end(bool whole) {
  look_.time_ = last_;
  look_.from_W_ = from_W_;
  look_.middle_ = first_azimuth_ + Angle::radians(turned_rad_ / 2);
  look_.half_rad_ = std::abs(turned_rad_) / 2 + half_width_rad_;
  look_.seen_ = config_.detection;
  look_.readings_.clear();
  look_.shadows_.clear();
  for (std::size_t i = 0; i < clusters_.size(); ++i) {
    if (clusters_[i].joined == i && (whole || !is_chance(clusters_[i]))) read(clusters_[i]);
  }
  if (!whole) beams_ = 0;
}

double BodyLooks::size_of(const Cluster& c) {
  return std::max(c.far_m - c.near_m, (c.high_rad - c.low_rad) * c.near_m);
}

void BodyLooks::find_bodies(const std::function<bool(const Eigen::Vector2d&)>& is_inside,
                            std::vector<EchoBox>& out) const {
  std::vector<std::size_t> touched;
  for (const Part& part : parts_) {
    const std::size_t cluster = root(part.cluster);
    if (size_of(clusters_[cluster]) <= config_.max_size_m && is_inside(part.p_W)) touched.push_back(cluster);
  }
  std::sort(touched.begin(), touched.end());
  for (const Part& part : parts_) {
    if (std::binary_search(touched.begin(), touched.end(), root(part.cluster))) out.push_back(part.box);
  }
}

bool BodyLooks::is_structure(const Cluster& c) const {
  return size_of(c) > config_.max_size_m || c.first_beam == 0 || c.last_beam == beams_ - 1;
}

bool BodyLooks::is_chance(const Cluster& c) const {
  if (is_structure(c)) return false;
  const double samples = (c.last_beam - c.first_beam + 1) * (c.far_m - c.near_m) / level_bin_m_;
  double fewer = 0, of_k = std::exp(-samples * false_alarm_);  // Poisson
  for (int k = 0; k + 1 < c.echoes; ++k) {
    fewer += of_k;
    of_k *= samples * false_alarm_ / (k + 1);
  }
  return 1 - fewer > kByChance;
}

void BodyLooks::read(const Cluster& c) {
  const Eigen::Vector2d centre = c.sum / c.echoes;
  const Eigen::Matrix2d scatter = c.squares / c.echoes - centre * centre.transpose();
  const double range = centre.norm();
  const bool structure = is_structure(c);
  if (!structure && c.echoes < config_.min_echoes) return;
  const double from_middle = turned_rad_ / 2, grown = structure ? 0 : c.width_rad / 2;
  look_.shadows_.push_back({c.low_rad - from_middle - grown, c.high_rad - from_middle + grown, c.near_m, c.far_m,
                            config_.hidden, structure ? config_.hidden : config_.behind});
  if (structure) return;
  const double beams = std::clamp<double>(c.last_beam - c.first_beam + 1, 1, kBeamsOfCentre);
  const double across = range * c.width_rad / kFwhm, turned = range * config_.heading_sigma.radians();
  const double own = config_.position_sigma_m * config_.position_sigma_m;
  const Eigen::Vector2d along = range > 0 ? Eigen::Vector2d(centre / range) : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d aside(-along.y(), along.x());
  BodyReading reading;
  reading.p_W = from_W_ + centre;
  reading.covariance = config_.range_sigma_m * config_.range_sigma_m * along * along.transpose() +
                       (across * across / beams + turned * turned) * aside * aside.transpose() +
                       own * Eigen::Matrix2d::Identity() + config_.centre_share * scatter;
  reading.scatter = scatter;
  reading.echoes = c.echoes;
  reading.age_s = to_seconds(last_ - begin_) - c.time_s / c.echoes;
  look_.readings_.push_back(reading);
}

}  // namespace isobath

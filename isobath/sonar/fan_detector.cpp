#include <algorithm>
#include <bit>
#include <cmath>
#include <isobath/sonar/fan_detector.hpp>
#include <isobath/sonar/fan_detector_state.hpp>
#include <isobath/sonar/hidden_target.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr double kSuspectRate = 1e-3;         // of cells that stand out by chance
constexpr float kMaxSkew = 2;                 // a threshold beyond this many robust ones is made by targets
constexpr float kMaxApart = 2;                // so is one beyond this many robust ones of the whole fan
constexpr float kOnePing = 0.5f;              // of a look, at most: no ping makes an obstacle alone
constexpr float kOfClutter = 0.33f;           // of the weight of a ping: spikes of clutter stay for seconds
constexpr int kUnsettled = 8, kSettled = 40;  // pings after which what was learnt before counts an eighth
constexpr float kDead = 0.01f;                // of the median beam, in power
constexpr float kClipped = 0.7f;              // of the largest power: most samples of the cell are clipped
constexpr double kTellingFrom = 2;            // p_D over f
constexpr std::uint32_t kOwnLaw = 3000;       // cells of a stratum, from which on it has a law of its own

/// Some readers make a fan of their own for each ping.
bool same_fan(const std::shared_ptr<const BeamFan>& a, const std::shared_ptr<const BeamFan>& b) {
  return a == b || (a->azimuth == b->azimuth && a->width == b->width && a->height == b->height);
}

float faintest_of(const Ping& ping) {
  if (ping.intensity.type() != SampleType::kF32) return 0.25f;  // half a count
  const float least = 1e-5f * ping.full_scale;
  return std::max(least * least, std::numeric_limits<float>::min());
}

}  // namespace

std::vector<Field> fields(FanDetectorConfig& c) {
  std::vector<Field> all = {
      Field::real("fan_false_alarm", &c.false_alarm, {1e-6, 0.1}, "1",
                  "Method auto, fans: probability that a resolution cell without a target reports an echo."),
      Field::real("fan_p_detect", &c.p_detect, {0.01, 0.999}, "1",
                  "Method auto, fans: probability that a resolution cell with a target reports an echo."),
      Field::real("look_s", &c.look_s, {0, 60}, "s",
                  "Pings of a fan that follow each other faster than this count as one look together."),
      Field::integer("range_cells", &c.range_cells, {16, 10'000}, "cells",
                     "Range bins of a fan are pooled until a beam has about this many cells.")};
  for (Field& field : fields(c.background)) all.push_back(std::move(field));
  return all;
}

FanDetectorState::Geometry& FanDetectorState::geometry_of(const Ping& ping) {
  ++clock_;
  Geometry* oldest = nullptr;
  for (auto& g : geometries_) {
    const bool same = same_fan(g->fan, ping.fan) && g->window == ping.window && g->type == ping.intensity.type() &&
                      g->blanking_m == ping.blanking_m;
    if (same) {
      g->used = clock_;
      return *g;
    }
    if (!oldest || g->used < oldest->used) oldest = g.get();
  }
  if (geometries_.size() < kKept) {
    geometries_.push_back(std::make_unique<Geometry>());
    oldest = geometries_.back().get();
  }
  Geometry& g = *oldest;
  const Geometry* before = last_;
  g.fan = ping.fan;
  g.window = ping.window;
  g.type = ping.intensity.type();
  g.blanking_m = ping.blanking_m;
  g.used = clock_;
  g.heard = false;
  g.cells = FanCells(config_.range_cells);
  g.cells.prepare(ping);
  const RangeWindow& w = g.cells.window();
  const double blanking_m = std::max({config_.blanking_m, ping.blanking_m, model_ ? model_->blanking_m : 0.0});
  const double blind = std::ceil((blanking_m - w.start_m) / w.bin_m - 1e-9);
  g.first_bin = static_cast<int>(std::clamp(blind, 0.0, double(w.bins)));
  g.background = FanBackground(config_.background);
  g.background.begin(g.cells, g.first_bin, faintest_of(ping));
  g.heat.assign(static_cast<std::size_t>(g.cells.beams()) * static_cast<std::size_t>(w.bins), 0);
  for (std::size_t across = 0; across < kThirds; ++across) {
    std::vector<std::uint8_t>& strata = g.quiet_strata[across];
    strata.assign(static_cast<std::size_t>(w.bins), static_cast<std::uint8_t>(across));
    for (int k = g.first_bin; k < w.bins; ++k) {
      const int along = (k - g.first_bin) * kThirds / (w.bins - g.first_bin);
      strata[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(along * kThirds + static_cast<int>(across));
    }
  }
  g.watch.begin(ping, g.cells, g.first_bin);
  g.of_model = model_ && same_setting(*model_, ping) && model_->relief.size() == std::size_t(g.cells.beams());
  if (g.of_model) g.background.start_from({model_->relief.begin(), model_->relief.end()});
  if (before != &g) take_laws(g, before);
  return g;
}

/// Those of the model at its setting and for the first ping of all, else those of the setting before.
void FanDetectorState::take_laws(Geometry& g, const Geometry* before) const {
  constexpr int kHalvings = 2;
  if (model_ && !dropped_ && (g.of_model || !before)) {
    g.laws = model_->laws;
    g.all = model_->all;
    g.pings = kUnsettled;  // no rough start to forget
  } else if (before) {
    for (std::size_t i = 0; i < kStrata; ++i) g.laws[i].take_over(before->laws[i], kHalvings);
    g.all.take_over(before->all, kHalvings);
  }
}

/// As if there were none: the ping at hand is the first of all again.
void FanDetectorState::drop_model(Geometry& g) {
  dropped_ = true;
  g.laws = {};
  g.all = {};
  g.pings = 0;
  std::fill(g.heat.begin(), g.heat.end(), std::uint8_t{0});
}

/// A beam without a receiver would draw the background of its neighbours down, and call all water free.
void FanDetectorState::silence_dead_beams(const Geometry& g) {
  const int beams = g.cells.beams(), bins = g.cells.bins();
  sums_.assign(2 * static_cast<std::size_t>(beams), 0);
  for (int b = 0; b < beams; ++b) {
    const float* row = power_.data() + static_cast<std::ptrdiff_t>(b) * bins;
    float sum = 0;
    for (int k = g.first_bin; k < bins; ++k) sum += std::max(row[k], 0.f);
    sums_[static_cast<std::size_t>(b)] = sums_[static_cast<std::size_t>(beams) + static_cast<std::size_t>(b)] = sum;
  }
  const auto from = sums_.begin() + beams, middle = from + (3 * beams) / 4;
  std::nth_element(from, middle, sums_.end());  // the upper quartile: half of the beams may be dead
  for (int b = 0; b < beams; ++b) {
    if (sums_[static_cast<std::size_t>(b)] > kDead * *middle) continue;
    std::fill_n(power_.begin() + static_cast<std::ptrdiff_t>(b) * bins, bins, -1.f);
  }
}

void FanDetectorState::rate(const Geometry& g) {
  const std::vector<float>& level = g.background.level();
  for (std::size_t i = 0; i < power_.size(); ++i) ratios_[i] = power_[i] >= 0 ? power_[i] / level[i] : -1.f;
}

float FanDetectorState::threshold(int beam, int bin) const { return thresholds_[strata_of(*last_, beam)[bin]]; }

void FanDetectorState::set_thresholds(const Geometry& g) {
  for (std::size_t i = 0; i < kStrata; ++i) {
    const TailLaw& law = g.laws[i].total() >= kOwnLaw ? g.laws[i] : g.all;
    suspect_[i] = law.robust_threshold(kSuspectRate);
    thresholds_[i] = FanDetector::threshold_of(g.laws[i], g.all, config_.false_alarm);
  }
}

void FanDetectorState::decide(Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins();
  for (int b = 0; b < g.cells.beams(); ++b) {
    const float* u = ratios_.data() + static_cast<std::ptrdiff_t>(b) * bins;
    const Strata strata = strata_of(g, b);
    std::uint64_t* hits = out.hits(b);
    for (int k = g.first_bin; k < bins; ++k) hits[k / 64] |= std::uint64_t{u[k] >= thresholds_[strata[k]]} << (k % 64);
  }
}

void FanDetectorState::describe(const Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins();
  out.false_alarm = config_.false_alarm;
  for (int k = 0; k < bins; ++k) {
    if (k < g.first_bin) {
      out.set_unusable(k);
    } else {
      out.p_detect[static_cast<std::size_t>(k)] = static_cast<float>(config_.p_detect);
    }
  }
  p_dim_.assign(static_cast<std::size_t>(bins), 0);
  for (int b = 0; b < out.beams(); ++b) {
    const float* u = ratios_.data() + static_cast<std::ptrdiff_t>(b) * bins;
    const Strata strata = strata_of(g, b);
    dim_.assign(static_cast<std::size_t>(out.words()), 0);
    bool any = false;
    for (int k = g.first_bin; k < bins; ++k) {
      // Where the threshold is beyond the largest sample no echo can stand out.
      const float level = strata.level[k];
      const bool deaf = u[k] < 0 || level * thresholds_[strata[k]] > largest_;
      if (!deaf && level <= strata.loud) continue;
      const double p =
          deaf ? 0 : hidden_p_detect(double{level} / g.background.quiet(), config_.p_detect, config_.false_alarm);
      p_dim_[static_cast<std::size_t>(k)] = p < kTellingFrom * config_.false_alarm ? 0.f : static_cast<float>(p);
      dim_[static_cast<std::size_t>(k / 64)] |= std::uint64_t{1} << (k % 64);
      any = true;
    }
    if (any) out.set_dim(b, dim_.data(), p_dim_.data());
  }
}

void FanDetectorState::spread_to_samples(const Ping& ping, const Geometry& g, const EchoDecisions& cells,
                                         EchoDecisions& out) {
  const int samples = ping.window.bins;
  out.reset(ping.fan->beams(), samples);
  out.false_alarm = cells.false_alarm;
  for (int k = 0; k < samples; ++k) {
    const int cell = k / g.cells.bins_per_cell();
    if (!cells.usable(cell)) {
      out.set_unusable(k);
    } else {
      out.p_detect[static_cast<std::size_t>(k)] = cells.p_detect[static_cast<std::size_t>(cell)];
    }
  }
  row_.resize(static_cast<std::size_t>(samples));
  for (int c = 0; c < cells.beams(); ++c) {
    const std::uint64_t *hits = cells.hits(c), *dim = cells.dim(c);
    const BinSpan beams = g.cells.beams_of(c);
    const float* power = power_.data() + static_cast<std::ptrdiff_t>(c) * cells.bins();
    for (int b = beams.first; b < beams.end; ++b) {
      bool copied = false;
      for (int w = 0; w < cells.words(); ++w) {
        for (std::uint64_t left = hits[w] | (dim ? dim[w] : 0); left != 0; left &= left - 1) {
          const int cell = 64 * w + std::countr_zero(left);
          const BinSpan span = g.cells.bins_of(cell);
          if (!cells.tells(c, cell)) {
            for (int k = span.first; k < span.end; ++k) out.set_blind(b, k);
            continue;
          }
          if (!cells.hit(c, cell)) continue;
          if (!copied) ping.intensity.copy_beam(b, row_.data());
          copied = true;
          for (int k = span.first; k < span.end; ++k) {
            const float z = row_[static_cast<std::size_t>(k)];
            if (z * z >= 0.999f * power[cell]) out.set_hit(b, k);
          }
        }
      }
    }
  }
}

void FanDetectorState::detect(const Ping& ping, const WaterColumn& water, EchoDecisions& samples, FanLooks& looks) {
  Geometry& g = geometry_of(ping);
  last_ = &g;
  const bool clips = ping.intensity.type() != SampleType::kF32;
  largest_ = clips ? ping.full_scale * ping.full_scale : std::numeric_limits<float>::infinity();
  saturated_ = kClipped * largest_;
  g.cells.pool(ping);
  power_ = g.cells.power();
  ratios_.resize(power_.size());
  silence_dead_beams(g);
  g.background.update(ping.time, power_, water);
  rate(g);
  EchoDecisions& out = looks.decisions;
  out.reset(g.cells.beams(), g.cells.bins());
  loudest_.assign(static_cast<std::size_t>(g.cells.bins()), 0);
  if (model_ && !dropped_ && g.watch.contradicts(model_->all, ratios_)) drop_model(g);
  if (g.all.total() == 0) {  // the first ping of all: its own law, before anything is known
    suspects_.assign(power_.size(), 0);
    learn(g);
  }
  set_thresholds(g);
  decide(g, out);
  describe(g, out);
  drop_side_lobes(g, out);
  hide_shadows(g, out);
  suspect(g);
  learn(g);
  g.background.learn(target_);
  g.watch.end_ping(ping, power_, target_);
  if (++g.pings == kUnsettled || g.pings == kSettled) {  // the backgrounds were still rough
    for (TailLaw& law : g.laws) law.take_over(law, 3);
    g.all.take_over(g.all, 3);
  }
  if (config_.look_s > 0) {
    out.max_echo_weight = kOnePing;
    const double since_s = g.heard ? to_seconds(ping.time - g.time) : config_.look_s;
    out.weight = static_cast<float>(std::clamp(since_s / config_.look_s, 0.05, 1.0));
    if (is_cluttered(g)) out.max_echo_weight = std::min(kOnePing, kOfClutter * out.weight);
  }
  g.time = ping.time;
  g.heard = true;
  spread_to_samples(ping, g, out, samples);
  looks.ping = ping;
  looks.ping.fan = g.cells.fan();
  looks.ping.window = g.cells.window();
  looks.ping.sampled = nullptr;
}

FanModel FanDetectorState::learnt() const {
  FanModel model;
  if (!last_) return model;
  last_->watch.describe(model);
  set_sonar(model, *last_->fan);
  model.relief = last_->background.relief();
  return model;
}

/// Of the setting with most pings, the model's own before others.
std::optional<FanDeparture> FanDetectorState::departure() const {
  if (!model_ || geometries_.empty()) return std::nullopt;
  const auto heard = [](const auto& g) { return std::pair(g->of_model, g->watch.pings()); };
  const auto& g = *std::max_element(geometries_.begin(), geometries_.end(),
                                    [&](const auto& a, const auto& b) { return heard(a) < heard(b); });
  std::array<float, kStrata> thresholds{};
  for (std::size_t i = 0; i < kStrata; ++i)
    thresholds[i] = FanDetector::threshold_of(model_->laws[i], model_->all, config_.false_alarm);
  FanDeparture d = g->watch.departure(*model_, thresholds, config_.false_alarm, g->of_model);
  d.dropped = dropped_;
  return d;
}

float FanDetector::threshold_of(const TailLaw& own, const TailLaw& all, double false_alarm) {
  const TailLaw& law = own.total() >= kOwnLaw ? own : all;
  const float wanted = std::min(law.threshold(false_alarm), kMaxSkew * law.robust_threshold(false_alarm));
  return &law == &own ? std::min(wanted, kMaxApart * all.robust_threshold(false_alarm)) : wanted;
}

FanDetector::FanDetector(const FanDetectorConfig& config) : state_(std::make_unique<FanDetectorState>(config)) {}
FanDetector::~FanDetector() = default;
FanDetector::FanDetector(FanDetector&&) noexcept = default;
FanDetector& FanDetector::operator=(FanDetector&&) noexcept = default;

void FanDetector::detect(const Ping& ping, const WaterColumn& water, EchoDecisions& samples, FanLooks& looks) {
  state_->detect(ping, water, samples, looks);
}

const std::vector<float>& FanDetector::ratios() const { return state_->ratios_; }
float FanDetector::threshold(int beam, int bin) const { return state_->threshold(beam, bin); }
void FanDetector::start_from(std::shared_ptr<const FanModel> model) { state_->model_ = std::move(model); }
FanModel FanDetector::learnt() const { return state_->learnt(); }
std::optional<FanDeparture> FanDetector::departure() const { return state_->departure(); }

}  // namespace isobath

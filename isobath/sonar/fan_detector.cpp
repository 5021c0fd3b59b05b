#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <isobath/sonar/fan_background.hpp>
#include <isobath/sonar/fan_cells.hpp>
#include <isobath/sonar/fan_detector.hpp>
#include <isobath/sonar/fan_watch.hpp>
#include <isobath/sonar/hidden_target.hpp>
#include <isobath/sonar/tail_law.hpp>
#include <limits>

namespace isobath {
namespace {

constexpr int kHeatMemory = 10;        // pings
constexpr int kHeat = 3;               // echoes within that time, from which on a cell is taken to hold a target
constexpr double kSuspectRate = 1e-3;  // of cells that stand out by chance
constexpr float kMaxSkew = 2;          // a threshold beyond this many robust ones is made by targets
constexpr float kMaxApart = 2;         // so is one beyond this many robust ones of the whole fan
constexpr int kSkirtBeams = 4, kSkirtBins = 3;
constexpr int kWideBeams = 2, kWideBins = 16;  // to each side
constexpr double kFull = 0.25;
constexpr float kClutter = 0.004f, kClutterMemory = 0.01f;  // share of cells; of pings
constexpr int kClutteredThirds = 2;                         // of nine ninths, those that may be free of it
constexpr float kOnePing = 0.5f;                            // of a look, at most: no ping makes an obstacle alone
constexpr float kOfClutter = 0.33f;           // of the weight of a ping: spikes of clutter stay for seconds
constexpr int kUnsettled = 8, kSettled = 40;  // pings after which what was learnt before counts an eighth
constexpr float kDead = 0.01f;                // of the median beam, in power
constexpr float kSideLobe = 1.f / 16;         // of the loudest at a range, in power
constexpr float kOfSaturated = 1.f / 4;       // where that one is clipped
constexpr int kClippedRun = 3;                // cells
constexpr double kThick_m = 1.5;              // of a body that casts a shadow
constexpr float kBehind = 0.5f;               // of the power of the echo in front: another body
constexpr int kThickCells = 4, kShadowBeams = 3;
constexpr float kGhost = 0.1f;   // of that power: may be its own by a detour
constexpr float kSkirt = 0.03f;  // the same within the thickness of a body: may be its upper or lower parts
constexpr int kBodyBeams = 4,
              kBodyStep = 4;             // beams side by side that hear a body; cells of range from one to the next
constexpr float kFarBeyond = 4;          // times its own threshold, and
constexpr float kLoudEcho = 100;         // times the quiet water: its side lobes may be heard, and its shadow is dark
constexpr float kClipped = 0.7f;         // of the largest power: most samples of the cell are clipped
constexpr float kLoud = 2;               // times the quiet water, in power
constexpr double kMinTelling = 2;        // p_D over f
constexpr std::uint32_t kOwnLaw = 3000;  // cells of a stratum, from which on it has a law of its own

template <class Visit>
void for_around(int beam, int bin, int beams, int bins, const Visit& visit) {
  for (int b = std::max(0, beam - 1); b <= std::min(beams - 1, beam + 1); ++b) {
    for (int k = std::max(0, bin - 1); k <= std::min(bins - 1, bin + 1); ++k)
      visit(static_cast<std::size_t>(b) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k));
  }
}

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

struct FanDetector::State {
  explicit State(const FanDetectorConfig& config) : config_(config) {}
  void detect(const Ping& ping, const WaterColumn& water, EchoDecisions& samples, FanLooks& looks);
  [[nodiscard]] float threshold(int beam, int bin) const;
  [[nodiscard]] FanModel learnt() const;
  [[nodiscard]] std::optional<FanDeparture> departure() const;

  static constexpr int kThirds = FanModel::kThirds, kStrata = FanModel::kStrata;
  static constexpr std::size_t kKept = 4;  ///< geometries
  /// A loud echo in front.
  struct Front {
    int dark_from = 0;  ///< the cell
    float power = 0;
  };
  struct Geometry {
    std::shared_ptr<const BeamFan> fan;
    RangeWindow window;
    SampleType type = SampleType::kU8;
    double blanking_m = 0;
    int first_bin = 0;
    FanCells cells;
    FanBackground background;
    std::array<TailLaw, kStrata> laws;
    TailLaw all;
    FanWatch watch;
    std::vector<std::uint8_t> third_along, third_across;  ///< of each range and of each beam
    std::vector<std::uint8_t> heat;                       ///< of each cell: pings for which it is not learnt from
    std::uint64_t used = 0;
    Time time;
    int pings = 0;
    std::array<float, kThirds * kThirds> marked{};  ///< share of the cells of each ninth that look like targets
    bool heard = false;
    bool of_model = false;  ///< the setting of the model
  };
  Geometry& geometry_of(const Ping& ping);
  void take_laws(Geometry& g, const Geometry* before) const;
  void drop_model(Geometry& g);
  void silence_dead_beams(const Geometry& g);
  void rate(const Geometry& g);
  void set_thresholds(const Geometry& g);
  void decide(Geometry& g, EchoDecisions& out);
  void suspect(const Geometry& g);
  [[nodiscard]] int first_loud(const Geometry& g, const EchoDecisions& out, int beam, bool body) const;
  [[nodiscard]] bool is_body(const Geometry& g, int beam, int bin) const;
  void hide_shadows(const Geometry& g, EchoDecisions& out);
  void cast(std::vector<Front>& fronts, int beam, int bin, int thick) const;
  [[nodiscard]] bool is_loud(const Geometry& g, int beam, int bin) const;
  void drop_side_lobes(const Geometry& g, EchoDecisions& out);
  void drop_skirts(EchoDecisions& out, int bin) const;
  void learn(Geometry& g);
  void describe(const Geometry& g, EchoDecisions& out);
  void spread_to_samples(const Ping& ping, const Geometry& g, const EchoDecisions& cells, EchoDecisions& out);
  void sum_suspects(int beams, int bins);
  void mark_targets(int beams, int bins, int first_bin);
  [[nodiscard]] bool is_cluttered(const Geometry& g) const;
  [[nodiscard]] int company(int beam, int bin, int beams, int bins) const;
  [[nodiscard]] int stratum(const Geometry& g, int beam, int bin, bool loud) const;

  std::vector<std::unique_ptr<Geometry>> geometries_;
  Geometry* last_ = nullptr;
  std::uint64_t clock_ = 0;
  std::vector<float> power_, ratios_;
  std::vector<Front> body_, any_;  ///< for each beam: the echo that casts its shadow; the nearest loud one
  std::vector<std::uint32_t> suspect_sums_;
  std::vector<std::uint8_t> target_;                     ///< cells: 1 where a target stands, or its skirts
  std::vector<std::uint8_t> suspects_;                   ///< cells: 1 where there may be an echo
  std::vector<float> loudest_;                           ///< of each range
  std::array<float, kStrata> thresholds_{}, suspect_{};  ///< ratios: of an echo; of what may be one
  float largest_ = 0, saturated_ = 0;  ///< power of a sample at full scale; of a cell from which on samples are clipped
  std::vector<float> sums_, p_dim_, row_;
  std::vector<std::uint64_t> dim_;

  FanDetectorConfig config_;
  std::shared_ptr<const FanModel> model_;  ///< null: none
  bool dropped_ = false;                   ///< the pings contradict its laws
};

FanDetector::State::Geometry& FanDetector::State::geometry_of(const Ping& ping) {
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
  g.third_along.assign(static_cast<std::size_t>(w.bins), 0);
  for (int k = g.first_bin; k < w.bins; ++k)
    g.third_along[static_cast<std::size_t>(k)] =
        static_cast<std::uint8_t>((k - g.first_bin) * kThirds / (w.bins - g.first_bin));
  g.third_across.resize(static_cast<std::size_t>(g.cells.beams()));
  for (int b = 0; b < g.cells.beams(); ++b)
    g.third_across[static_cast<std::size_t>(b)] = static_cast<std::uint8_t>(b * kThirds / g.cells.beams());
  g.watch.begin(ping, g.cells, g.first_bin);
  g.of_model = model_ && same_setting(*model_, ping) && model_->relief.size() == std::size_t(g.cells.beams());
  if (g.of_model) g.background.start_from({model_->relief.begin(), model_->relief.end()});
  if (before != &g) take_laws(g, before);
  return g;
}

/// Those of the model at its setting and for the first ping of all, else those of the setting before.
void FanDetector::State::take_laws(Geometry& g, const Geometry* before) const {
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
void FanDetector::State::drop_model(Geometry& g) {
  dropped_ = true;
  g.laws = {};
  g.all = {};
  g.pings = 0;
  std::fill(g.heat.begin(), g.heat.end(), std::uint8_t{0});
}

/// A beam without a receiver would draw the background of its neighbours down, and call all water free.
void FanDetector::State::silence_dead_beams(const Geometry& g) {
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

void FanDetector::State::rate(const Geometry& g) {
  const std::vector<float>& level = g.background.level();
  for (std::size_t i = 0; i < power_.size(); ++i) ratios_[i] = power_[i] >= 0 ? power_[i] / level[i] : -1.f;
}

int FanDetector::State::stratum(const Geometry& g, int beam, int bin, bool loud) const {
  return (loud ? kThirds * kThirds : 0) + g.third_along[static_cast<std::size_t>(bin)] * kThirds +
         g.third_across[static_cast<std::size_t>(beam)];
}

float FanDetector::State::threshold(int beam, int bin) const {
  const bool loud =
      last_->background.level()[static_cast<std::size_t>(beam) * static_cast<std::size_t>(last_->cells.bins()) +
                                static_cast<std::size_t>(bin)] > kLoud * last_->background.quiet();
  return thresholds_[static_cast<std::size_t>(stratum(*last_, beam, bin, loud))];
}

void FanDetector::State::set_thresholds(const Geometry& g) {
  for (std::size_t i = 0; i < kStrata; ++i) {
    const TailLaw& law = g.laws[i].total() >= kOwnLaw ? g.laws[i] : g.all;
    suspect_[i] = law.robust_threshold(kSuspectRate);
    thresholds_[i] = threshold_of(g.laws[i], g.all, config_.false_alarm);
  }
}

void FanDetector::State::decide(Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins();
  const float loud = kLoud * g.background.quiet();
  for (int b = 0; b < g.cells.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    const float *u = ratios_.data() + row, *level = g.background.level().data() + row;
    std::uint64_t* hits = out.hits(b);
    for (int k = g.first_bin; k < bins; ++k) {
      const float wanted = thresholds_[static_cast<std::size_t>(stratum(g, b, k, level[k] > loud))];
      hits[k / 64] |= std::uint64_t{u[k] >= wanted} << (k % 64);
    }
  }
}

/// An echo that is heard by way of side lobes, and leaves a shadow.
bool FanDetector::State::is_loud(const Geometry& g, int beam, int bin) const {
  const std::size_t at =
      static_cast<std::size_t>(beam) * static_cast<std::size_t>(g.cells.bins()) + static_cast<std::size_t>(bin);
  const float level = g.background.level()[at], quiet = g.background.quiet();
  const float wanted = thresholds_[static_cast<std::size_t>(stratum(g, beam, bin, level > kLoud * quiet))];
  return power_[at] >= kLoudEcho * quiet && ratios_[at] >= kFarBeyond * wanted;
}

void FanDetector::State::drop_side_lobes(const Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins();
  for (int b = 0; b < out.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    for (int w = 0; w < out.words(); ++w) {
      for (std::uint64_t left = out.hits(b)[w]; left != 0; left &= left - 1) {
        const int k = 64 * w + std::countr_zero(left);
        if (!is_loud(g, b, k)) continue;
        const float power = power_[static_cast<std::size_t>(row + k)];
        for (int n = std::max(0, k - 1); n <= std::min(bins - 1, k + 1); ++n)
          loudest_[static_cast<std::size_t>(n)] = std::max(loudest_[static_cast<std::size_t>(n)], power);
      }
    }
  }
  for (int b = 0; b < out.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    for (int w = 0; w < out.words(); ++w) {
      for (std::uint64_t left = out.hits(b)[w]; left != 0; left &= left - 1) {
        const int k = 64 * w + std::countr_zero(left);
        const float power = power_[static_cast<std::size_t>(row + k)];
        if (power < (loudest_[static_cast<std::size_t>(k)] > saturated_ ? kOfSaturated : kSideLobe) *
                        loudest_[static_cast<std::size_t>(k)])
          out.set_blind(b, k);
      }
    }
  }
  for (int k = g.first_bin; k < bins; ++k) {
    if (loudest_[static_cast<std::size_t>(k)] > saturated_) drop_skirts(out, k);
  }
}

/// The main lobe of a clipped echo is clipped beside the body too, as far as it cannot be told: on either side the
/// outermost of three and more such cells.
void FanDetector::State::drop_skirts(EchoDecisions& out, int bin) const {
  const auto is_clipped = [&](int b) {
    return b < out.beams() &&
           power_[static_cast<std::size_t>(b) * static_cast<std::size_t>(out.bins()) + static_cast<std::size_t>(bin)] >
               saturated_;
  };
  for (int b = 0; b < out.beams(); ++b) {
    const int first = b;
    while (is_clipped(b)) ++b;
    if (b - first < kClippedRun) continue;
    out.set_blind(first, bin);
    out.set_blind(b - 1, bin);
  }
}

/// Behind a body with a loud echo stands its shadow, and what comes from there went round by bottom, surface or the
/// body itself; an echo of a like power is another body that the first one does not hide. Sound goes past what is
/// narrower than that: behind it only weak echoes say nothing, which may be its own by way of bottom or surface.
void FanDetector::State::hide_shadows(const Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins(), beams = out.beams();
  const int thick = std::max(kThickCells, static_cast<int>(std::lround(kThick_m / g.cells.window().bin_m)));
  body_.assign(static_cast<std::size_t>(beams), Front{bins});
  any_.assign(static_cast<std::size_t>(beams), Front{bins});
  for (int b = 0; b < beams; ++b) {
    cast(any_, b, first_loud(g, out, b, false), 1);
    cast(body_, b, first_loud(g, out, b, true), thick);
  }
  for (int b = 0; b < beams; ++b) {
    const float* power = power_.data() + static_cast<std::ptrdiff_t>(b) * bins;
    const Front &body = body_[static_cast<std::size_t>(b)], &any = any_[static_cast<std::size_t>(b)];
    for (int k = any.dark_from; k < bins; ++k) {
      const bool hit = out.hit(b, k);
      const float faint = (k >= any.dark_from + thick ? kGhost : kSkirt) * any.power;
      if (k >= body.dark_from ? !(hit && power[k] >= kBehind * body.power) : hit && power[k] < faint)
        out.set_blind(b, k);
    }
  }
}

/// What the cell in front hides in its own beam and those beside it.
void FanDetector::State::cast(std::vector<Front>& fronts, int beam, int bin, int thick) const {
  const int beams = static_cast<int>(fronts.size()), bins = last_->cells.bins();
  if (bin >= bins) return;
  const float power =
      power_[static_cast<std::size_t>(beam) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(bin)];
  for (int c = std::max(0, beam - kShadowBeams); c <= std::min(beams - 1, beam + kShadowBeams); ++c) {
    Front& front = fronts[static_cast<std::size_t>(c)];
    front.dark_from = std::min(front.dark_from, bin + thick);
    front.power = std::max(front.power, power);
  }
}

/// Whether a loud echo goes on in the beams beside it: what is narrower than a beam lets sound past it, however loud.
bool FanDetector::State::is_body(const Geometry& g, int beam, int bin) const {
  int wide = 1;
  for (const int side : {-1, 1}) {
    int at = bin;
    for (int b = beam + side; b >= 0 && b < g.cells.beams(); b += side) {
      int next = -1;
      for (int k = std::max(0, at - kBodyStep); k <= std::min(g.cells.bins() - 1, at + kBodyStep); ++k) {
        if (is_loud(g, b, k) && (next < 0 || std::abs(k - at) < std::abs(next - at))) next = k;
      }
      if (next < 0) break;
      if (++wide >= kBodyBeams) return true;
      at = next;
    }
  }
  return false;
}

/// The nearest cell of a beam with a loud echo, or with one of a body; bins() without one.
int FanDetector::State::first_loud(const Geometry& g, const EchoDecisions& out, int beam, bool body) const {
  for (int w = 0; w < out.words(); ++w) {
    for (std::uint64_t left = out.hits(beam)[w]; left != 0; left &= left - 1) {
      const int k = 64 * w + std::countr_zero(left);
      if (is_loud(g, beam, k) && (!body || is_body(g, beam, k))) return k;
    }
  }
  return g.cells.bins();
}

void FanDetector::State::suspect(const Geometry& g) {
  const int bins = g.cells.bins();
  const float loud = kLoud * g.background.quiet();
  suspects_.assign(power_.size(), 0);
  for (int b = 0; b < g.cells.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    const float *u = ratios_.data() + row, *level = g.background.level().data() + row;
    std::uint8_t* out = suspects_.data() + row;
    for (int k = g.first_bin; k < bins; ++k)
      out[k] = u[k] >= suspect_[static_cast<std::size_t>(stratum(g, b, k, level[k] > loud))] ? 1 : 0;
  }
}

/// What looks like targets in all parts of the fan is clutter: the spikes of a sea, which stay for seconds.
bool FanDetector::State::is_cluttered(const Geometry& g) const {
  auto shares = g.marked;
  std::nth_element(shares.begin(), shares.begin() + kClutteredThirds, shares.end());
  return shares[kClutteredThirds] > kClutter;
}

void FanDetector::State::learn(Geometry& g) {
  const int bins = g.cells.bins(), beams = g.cells.beams();
  mark_targets(beams, bins, g.first_bin);
  const bool cluttered = is_cluttered(g);
  std::array<float, kThirds * kThirds> marked{};
  const float loud = kLoud * g.background.quiet();
  for (int b = 0; b < beams; ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    const float *u = ratios_.data() + row, *level = g.background.level().data() + row;
    std::uint8_t* heat = g.heat.data() + row;
    const int end = body_.empty() ? bins : std::min(bins, body_[static_cast<std::size_t>(b)].dark_from);
    for (int k = g.first_bin; k < bins; ++k) {
      std::uint8_t& target = target_[static_cast<std::size_t>(row + k)];
      if (heat[k] >= kHeat * kHeatMemory) target = 1;
      if (heat[k] > 0) --heat[k];
      marked[static_cast<std::size_t>(stratum(g, b, k, false))] += target;
      if (cluttered) target = 0;
      if (!(u[k] >= 0) || target || k >= end || loudest_[static_cast<std::size_t>(k)] > 0) continue;
      const auto i = static_cast<std::size_t>(stratum(g, b, k, level[k] > loud));
      g.laws[i].add(u[k]);
      g.all.add(u[k]);
      g.watch.add(i, u[k]);
    }
  }
  const float cells = static_cast<float>(beams * (bins - g.first_bin)) / (kThirds * kThirds);
  const float a = std::max(1.f / static_cast<float>(g.pings + 1), kClutterMemory);
  for (std::size_t i = 0; i < marked.size(); ++i) g.marked[i] += a * (marked[i] / std::max(cells, 1.f) - g.marked[i]);
  for (int b = 0; b < beams; ++b) {
    for (int k = g.first_bin; k < bins; ++k) {
      if (!suspects_[static_cast<std::size_t>(b) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k)])
        continue;
      for_around(b, k, beams, bins, [&g](std::size_t at) {
        g.heat[at] = static_cast<std::uint8_t>(std::min(g.heat[at] + kHeatMemory, 6 * kHeatMemory));
      });
    }
  }
}

/// Suspects side by side, and what stands around them: the skirts of an echo in range and direction. Not where a wide
/// neighbourhood is full of suspects: that is reverberation whose level is not known yet.
void FanDetector::State::mark_targets(int beams, int bins, int first_bin) {
  target_.assign(suspects_.size(), 0);
  sum_suspects(beams, bins);
  const auto row = static_cast<std::size_t>(bins) + 1;
  for (int b = 0; b < beams; ++b) {
    for (int k = first_bin; k < bins; ++k) {
      const std::size_t at = static_cast<std::size_t>(b) * static_cast<std::size_t>(bins) + static_cast<std::size_t>(k);
      if (!suspects_[at] || company(b, k, beams, bins) < 2) continue;
      const int b0 = std::max(0, b - kWideBeams), b1 = std::min(beams, b + kWideBeams + 1);
      const int k0 = std::max(0, k - kWideBins), k1 = std::min(bins, k + kWideBins + 1);
      const auto sum = [&](int beam, int bin) {
        return suspect_sums_[static_cast<std::size_t>(beam) * row + static_cast<std::size_t>(bin)];
      };
      const std::uint32_t inside = sum(b1, k1) - sum(b0, k1) - sum(b1, k0) + sum(b0, k0);
      if (inside > kFull * static_cast<double>((b1 - b0) * (k1 - k0))) continue;
      for (int c = std::max(0, b - kSkirtBeams); c <= std::min(beams - 1, b + kSkirtBeams); ++c) {
        const auto from = target_.begin() + static_cast<std::ptrdiff_t>(c) * bins;
        std::fill(from + std::max(0, k - kSkirtBins), from + std::min(bins, k + kSkirtBins + 1), std::uint8_t{1});
      }
    }
  }
}

void FanDetector::State::sum_suspects(int beams, int bins) {
  const auto row = static_cast<std::size_t>(bins) + 1;
  suspect_sums_.assign((static_cast<std::size_t>(beams) + 1) * row, 0);
  for (std::size_t b = 0; b < static_cast<std::size_t>(beams); ++b) {
    std::uint32_t along = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(bins); ++k) {
      along += suspects_[b * static_cast<std::size_t>(bins) + k];
      suspect_sums_[(b + 1) * row + k + 1] = suspect_sums_[b * row + k + 1] + along;
    }
  }
}

/// Other cells beside this one that may hold an echo.
int FanDetector::State::company(int beam, int bin, int beams, int bins) const {
  int count = -1;
  for_around(beam, bin, beams, bins, [&](std::size_t at) { count += suspects_[at]; });
  return count;
}

void FanDetector::State::describe(const Geometry& g, EchoDecisions& out) {
  const int bins = g.cells.bins();
  out.false_alarm = config_.false_alarm;
  for (int k = 0; k < bins; ++k) {
    if (k < g.first_bin) {
      out.set_unusable(k);
    } else {
      out.p_detect[static_cast<std::size_t>(k)] = static_cast<float>(config_.p_detect);
    }
  }
  const float loud = kLoud * g.background.quiet();
  p_dim_.assign(static_cast<std::size_t>(bins), 0);
  for (int b = 0; b < out.beams(); ++b) {
    const auto row = static_cast<std::ptrdiff_t>(b) * bins;
    const float *u = ratios_.data() + row, *level = g.background.level().data() + row;
    dim_.assign(static_cast<std::size_t>(out.words()), 0);
    bool any = false;
    for (int k = g.first_bin; k < bins; ++k) {
      // Where the threshold is beyond the largest sample no echo can stand out.
      const bool deaf =
          u[k] < 0 || level[k] * thresholds_[static_cast<std::size_t>(stratum(g, b, k, level[k] > loud))] > largest_;
      if (!deaf && level[k] <= loud) continue;
      const double p =
          deaf ? 0 : hidden_p_detect(double{level[k]} / g.background.quiet(), config_.p_detect, config_.false_alarm);
      p_dim_[static_cast<std::size_t>(k)] = p < kMinTelling * config_.false_alarm ? 0.f : static_cast<float>(p);
      dim_[static_cast<std::size_t>(k / 64)] |= std::uint64_t{1} << (k % 64);
      any = true;
    }
    if (any) out.set_dim(b, dim_.data(), p_dim_.data());
  }
}

void FanDetector::State::spread_to_samples(const Ping& ping, const Geometry& g, const EchoDecisions& cells,
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

void FanDetector::State::detect(const Ping& ping, const WaterColumn& water, EchoDecisions& samples, FanLooks& looks) {
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

FanModel FanDetector::State::learnt() const {
  FanModel model;
  if (!last_) return model;
  last_->watch.describe(model);
  set_sonar(model, *last_->fan);
  model.relief = last_->background.relief();
  return model;
}

/// Of the setting with most pings, the model's own before others.
std::optional<FanDeparture> FanDetector::State::departure() const {
  if (!model_ || geometries_.empty()) return std::nullopt;
  const auto heard = [](const auto& g) { return std::pair(g->of_model, g->watch.pings()); };
  const auto& g = *std::max_element(geometries_.begin(), geometries_.end(),
                                    [&](const auto& a, const auto& b) { return heard(a) < heard(b); });
  std::array<float, kStrata> thresholds{};
  for (std::size_t i = 0; i < kStrata; ++i)
    thresholds[i] = threshold_of(model_->laws[i], model_->all, config_.false_alarm);
  FanDeparture d = g->watch.departure(*model_, thresholds, config_.false_alarm, g->of_model);
  d.dropped = dropped_;
  return d;
}

float FanDetector::threshold_of(const TailLaw& own, const TailLaw& all, double false_alarm) {
  const TailLaw& law = own.total() >= kOwnLaw ? own : all;
  const float wanted = std::min(law.threshold(false_alarm), kMaxSkew * law.robust_threshold(false_alarm));
  return &law == &own ? std::min(wanted, kMaxApart * all.robust_threshold(false_alarm)) : wanted;
}

FanDetector::FanDetector(const FanDetectorConfig& config) : state_(std::make_unique<State>(config)) {}
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

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/perception/fan_mapper.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

using std::numbers::pi;
constexpr double kExplained = 1.0 / (1 << 14);  // unit of `explained_`
constexpr int kBlocksAPiece = 8, kBeamsAPiece = 64;

/// -ln(1 - P / n): of a voxel's being the source of an echo in one of its n cells.
std::int32_t explanation(double probability, const MixedVoxel& voxel) {
  constexpr double kSmall = 0.05;  // what the series leaves out is then a hundredth of the unit, and less
  const int cells = (voxel.beam_end - voxel.beam) * (voxel.bin_end - voxel.bin);
  const double p = probability / cells;
  const double exact = p < kSmall ? p * (1 + p * (1.0 / 2 + p * (1.0 / 3 + p / 4))) : -std::log1p(-p);
  return static_cast<std::int32_t>((exact + kExplained / 2) / kExplained);
}

/// exp(-n kExplained) from two tables, to 2e-16 of it; n from 0.
class EmptyShare {
 public:
  EmptyShare() {
    for (std::size_t i = 0; i < fine_.size(); ++i) fine_[i] = std::exp(-kExplained * static_cast<double>(i));
    for (std::size_t i = 0; i < coarse_.size(); ++i) coarse_[i] = std::exp(-kExplained * 256 * static_cast<double>(i));
  }
  double operator()(std::int32_t n) const {
    const auto whole = static_cast<std::uint32_t>(n);
    return whole >> 8 < coarse_.size() ? coarse_[whole >> 8] * fine_[whole & 255] : 0.0;
  }

 private:
  std::array<double, 256> fine_;
  std::array<double, 40 * 64> coarse_;  ///< to exp(-40)
};
const EmptyShare& empty_share() {
  static const EmptyShare share;
  return share;
}

/// 1 / (1 + exp(-l)) of whole units of log-odds, an entry each: what evidence and a prior can be together.
class Probabilities {
 public:
  Probabilities() : of_(2 * kMost + 1) {
    for (std::size_t i = 0; i < of_.size(); ++i) {
      of_[i] = 1 / (1 + std::exp(-kEvidenceUnit * (static_cast<double>(i) - kMost)));
    }
  }
  double operator()(int log_odds) const {
    const int at = std::clamp(log_odds, -kMost, kMost) + kMost;
    return of_[static_cast<std::size_t>(at)];
  }

 private:
  static constexpr int kMost = 48 * 1024;
  std::vector<double> of_;
};
const Probabilities& probabilities() {
  static const Probabilities all;
  return all;
}

/// Beyond upright there is nothing more to ensonify.
double sine_of_half(const BeamFan& fan) { return std::sin(std::min(0.5 * pi, 0.5 * fan.height.radians())); }

bool bit(const std::uint64_t* words, int i) { return (words[i / 64] >> (i % 64) & 1) != 0; }

}  // namespace

std::vector<Field> fields(FanMapperConfig& c) {
  using Rule = FanMapperConfig::Rule;
  std::vector<Field> all{
      Field::choice("rule", &c.rule,
                    {{"aspects", Rule::kAspects},
                     {"marginal", Rule::kMarginal},
                     {"stamp", Rule::kStamp},
                     {"hit_and_miss", Rule::kHitAndMiss}},
                    "What an echo says of each voxel of its elevation arc."),
      Field::real("hit", &c.hit, {0, 10}, "1", "Log-odds of an echo by the rule hit_and_miss."),
      Field::real("miss", &c.miss, {-10, 0}, "1", "Log-odds of no echo by the rule hit_and_miss."),
      Field::real("answers", &c.answers, {0.01, 1}, "1",
                  "Share of the looks at an occupied voxel in which it can echo at all."),
      Field::real("most_looks", &c.most_looks, {1, 1000}, "1", "Independent looks of one ping at one voxel, at most."),
      Field::integer("shadow_bins", &c.shadow_bins, {0, 1000}, "bins",
                     "An echo of so many bins in a row hides what stands behind it; 0: none does."),
  };
  for (Field& field : fields(c.aspects)) all.push_back(std::move(field));
  return all;
}

FanMapper::FanMapper(const FanMapperConfig& config, double voxel_m, double prior)
    : config_(config),
      voxel_m_(voxel_m),
      prior_(static_cast<int>(std::lround(prior / kEvidenceUnit))),
      law_(config.aspects) {
  ISOBATH_ASSERT(voxel_m > 0 && std::isfinite(prior));
  if (config.rule != FanMapperConfig::Rule::kAspects) return;
  saturation_.resize(FanView::kSteps);
  for (int i = 0; i < FanView::kSteps; ++i) {
    const double middle = (i + FanView::kLeastStep + 0.5) * (1 << FanView::kStepLog2);
    saturation_[static_cast<std::size_t>(i)] = static_cast<float>(law_.share(kEvidenceUnit * middle));
  }
}

// An update ---------------------------------------------------------------------------------------------------------

/// What of W the fan can touch, in F.
struct FanMapper::Sector {
  Sector(const Pose& X_WF, const RangeWindow& window, double half_width, double sine_of_half_height, double voxel_m)
      : X_FW(X_WF.inverse()), near(window.start_m), far(window.end_m()), sine(sine_of_half_height), half(half_width) {
    constexpr double kStep = pi / 18;
    least = most = X_WF.translation;
    const int steps = static_cast<int>(std::ceil(2 * half / kStep));
    for (int i = 0; i <= steps; ++i) {
      const double azimuth = half * (2.0 * i / steps - 1);
      for (const double s : {-sine, 0.0, sine}) {
        const double flat = far * std::sqrt(1 - s * s);
        const Vector3d p = X_WF * Vector3d(flat * std::cos(azimuth), flat * std::sin(azimuth), far * s);
        least = least.cwiseMin(p);
        most = most.cwiseMax(p);
      }
    }
    const double margin = far * (1 - std::cos(kStep / 2)) + 2 * voxel_m;  // the arc bulges out between the steps
    least.array() -= margin;
    most.array() += margin;
  }
  /// Whether a ball about a point of W may reach into it.
  [[nodiscard]] bool meets(const Vector3d& p_W, double radius) const {
    const Vector3d p = X_FW * p_W;
    const double range = p.norm(), flat = p.head<2>().norm();
    if (range - radius > far || range + radius < near) return false;
    if (std::abs(p.z()) - radius > (range + radius) * sine) return false;
    return flat <= radius || std::abs(std::atan2(p.y(), p.x())) - half <= std::asin(radius / flat);
  }

  Pose X_FW;
  double near, far, sine, half;
  Vector3d least, most;
};

void FanMapper::aim(const Pose& X_WF) {
  const Rotation R_FW = X_WF.rotation.inverse();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d along = voxel_m_ * (R_FW * Vector3d::Unit(axis));
    for (int c = 0; c < 3; ++c) view_.step[axis][c] = static_cast<float>(along[c]);
  }
  view_.ceiling_m = static_cast<float>(std::max(surface_m_ - X_WF.translation.z(), -1e9));
  view_.slab_m = static_cast<float>(0.5 * voxel_m_ * (X_WF.rotation * Vector3d::UnitZ()).lpNorm<1>());
}

std::vector<FanMapper::Part> FanMapper::parts_of(const Pose& X_WF) const {
  const double block_m = VoxelBlocks::kSide * voxel_m_, radius = 0.5 * std::sqrt(3.0) * (block_m + 2 * voxel_m_);
  const Sector sector(X_WF, window_, half_width_, sine_, voxel_m_);
  std::vector<Part> parts;
  const VoxelIndex least = floor_of(sector.least / block_m), most = floor_of(sector.most / block_m);
  for (int i = least.x(); i <= most.x(); ++i) {
    for (int j = least.y(); j <= most.y(); ++j) {
      for (int k = least.z(); k <= most.z(); ++k) {
        const VoxelIndex corner = VoxelBlocks::kSide * VoxelIndex(i, j, k);
        const Vector3d middle = (Vector3d(i, j, k).array() + 0.5) * block_m;
        if (!sector.meets(middle, radius) || !VoxelBlocks::holds(corner)) continue;
        const Vector3d first = (corner.cast<double>().array() + 0.5).matrix() * voxel_m_ - X_WF.translation;
        parts.push_back({corner,
                         {static_cast<float>(first.x()), static_cast<float>(first.y()), static_cast<float>(first.z())},
                         nullptr});
      }
    }
  }
  return parts;
}

int FanMapper::update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, VoxelBlocks& layer,
                      int threads) {
  ISOBATH_ASSERT(decisions.beams() == ping.fan->beams() && decisions.bins() == ping.window.bins);
  if (ping.fan != fan_ || ping.window != window_) take_geometry(ping);
  if (!pool_ || pool_->threads() != std::max(1, threads)) pool_ = std::make_unique<ThreadPool>(threads);
  take_decisions(decisions, *pool_);
  const Pose X_WF = X_WB * ping.X_BS * X_SF_;
  aim(X_WF);

  if (last_W_) moved_W_ = X_WF.translation - *last_W_;
  last_W_ = X_WF.translation;

  // The blocks are found and made one after another, in one order; then each is one thread's.
  std::vector<Part> parts = parts_of(X_WF);
  for (Part& part : parts) part.evidence = layer.touch(part.corner);
  const int count = static_cast<int>(parts.size());
  const bool aspects = config_.rule == FanMapperConfig::Rule::kAspects;
  const bool marginal = config_.rule == FanMapperConfig::Rule::kMarginal || aspects;
  if (mixed_.size() < parts.size()) mixed_.resize(parts.size());
  if (marginal) explained_.assign(static_cast<std::size_t>(decisions.beams()) * decisions.bins(), 0);
  const bool alone = pool_->threads() == 1;
  pool_->share(count, kBlocksAPiece, [&](int begin, int end) {
    for (int n = begin; n < end; ++n) {
      const Part& part = parts[static_cast<std::size_t>(n)];
      std::vector<MixedVoxel>& mixed = mixed_[static_cast<std::size_t>(n)];
      mixed.clear();
      look_at_block(view_, part.first, layer.bounds(), part.evidence, mixed);
      if (!marginal) continue;
      for (MixedVoxel& v : mixed) explain(v, part.evidence, alone);
    }
  });
  pool_->share(count, kBlocksAPiece, [&](int begin, int end) {
    for (int n = begin; n < end; ++n) {
      const Part& part = parts[static_cast<std::size_t>(n)];
      for (const MixedVoxel& v : mixed_[static_cast<std::size_t>(n)])
        aspects ? settle_aspect(v, decisions, layer.bounds(), part)
                : settle(v, decisions, layer.bounds(), part.evidence);
    }
  });
  return count;
}

/// Calls visit(beam, bin) for each cell of a voxel that holds an echo.
template <class Visit>
void FanMapper::each_echo(const MixedVoxel& voxel, const Visit& visit) const {
  const int first = voxel.bin / 64, last = (voxel.bin_end - 1) / 64;
  for (int beam = voxel.beam; beam < voxel.beam_end; ++beam) {
    const std::uint64_t* echoes = echoes_.data() + static_cast<std::size_t>(beam) * words_;
    for (int word = first; word <= last; ++word) {
      std::uint64_t left = echoes[word];
      if (word == first) left &= ~std::uint64_t{0} << voxel.bin % 64;
      if (word == last) left &= ~std::uint64_t{0} >> (63 - (voxel.bin_end - 1) % 64);
      for (; left != 0; left &= left - 1) visit(beam, 64 * word + std::countr_zero(left));
    }
  }
}

/// Counts a voxel among those that may have given the echoes of its cells. Whole numbers: in any order the same.
void FanMapper::explain(MixedVoxel& voxel, const LogOdds16* block, bool alone) {
  if (counts(voxel).second == 0) return;
  const double answers = config_.rule == FanMapperConfig::Rule::kAspects ? config_.aspects.answers : 1.0;
  voxel.own = explanation(answers * probability(block[voxel.offset]), voxel);
  each_echo(voxel, [&](int beam, int bin) {
    std::int32_t& cell = explained_[static_cast<std::size_t>(beam) * window_.bins + bin];
    if (alone) {
      cell += voxel.own;
    } else {
      std::atomic_ref(cell).fetch_add(voxel.own, std::memory_order_relaxed);
    }
  });
}

/// A voxel whose cells do not all say the same.
void FanMapper::settle(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
                       LogOdds16* block) const {
  using Rule = FanMapperConfig::Rule;
  LogOdds16& evidence = block[voxel.offset];
  const int beams = voxel.beam_end - voxel.beam, cells = beams * (voxel.bin_end - voxel.bin);
  const bool marginal = config_.rule == Rule::kMarginal;
  const bool graded = decisions.ratios(0) != nullptr;
  const double f = decisions.false_alarm;
  const EmptyShare& empty_of = empty_share();
  double ratios = 0;
  each_echo(voxel, [&](int beam, int bin) {
    const std::uint64_t* dim = decisions.dim(beam);
    const bool is_dim = dim && bit(dim, bin);
    const double heard = is_dim ? decisions.p_dim(beam, bin) : decisions.p_detect[bin];
    const double p = p_voxel(heard, f);
    const std::size_t cell = static_cast<std::size_t>(beam) * decisions.bins() + bin;
    const double empty = marginal ? empty_of(explained_[cell] - voxel.own) : 1.0;
    if (graded && !is_dim) {
      const double ratio = 1 + config_.answers * (static_cast<double>(decisions.ratios(beam)[bin]) - 1);
      ratios += ratio / (ratio * (1 - empty) + empty);
      return;
    }
    ratios += p / (p * (1 - empty) + f * empty);
  });
  const auto [told, hits] = counts(voxel);
  const double clear = clear_ratio_[std::min(window_.bins - 1, (voxel.bin + voxel.bin_end) / 2)];
  ratios += (told - hits) * clear + (cells - told);
  const double looks = std::clamp(beams * static_cast<double>(view_.looks_per_beam), 1.0, config_.most_looks);
  const double more =
      config_.rule == Rule::kHitAndMiss ? (hits > 0 ? config_.hit : config_.miss) : looks * std::log(ratios / cells);
  const double total = (evidence == kUnseen ? 0 : evidence) + more / kEvidenceUnit;
  const double kept = std::clamp<double>(total, bounds.least, bounds.most);
  evidence = static_cast<LogOdds16>(kept + (kept < 0 ? -0.5 : 0.5));
}

/// The same by the rule `aspects`.
void FanMapper::settle_aspect(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
                              const Part& part) const {
  LogOdds16& evidence = part.evidence[voxel.offset];
  const int old = evidence == kUnseen ? 0 : evidence;
  const int cells = (voxel.beam_end - voxel.beam) * (voxel.bin_end - voxel.bin);
  const auto [told, hits] = counts(voxel);
  const int step = std::clamp((old >> FanView::kStepLog2) - FanView::kLeastStep, 0, FanView::kSteps - 1);
  const double silence = static_cast<double>(clear_[std::min(window_.bins - 1, (voxel.bin + voxel.bin_end) / 2)]) *
                         static_cast<double>(saturation_[static_cast<std::size_t>(step)]);
  double more = silence * told / cells;  // units of evidence
  if (hits > 0) {
    const bool graded = decisions.ratios(0) != nullptr;
    const double any = -std::expm1(told * std::log1p(-decisions.false_alarm));  // P(an echo | empty water)
    const EmptyShare& empty_of = empty_share();
    double ratios = 0;
    each_echo(voxel, [&, cells_told = told](int beam, int bin) {
      const std::uint64_t* dim = decisions.dim(beam);
      const bool is_dim = dim && bit(dim, bin);
      const double p = is_dim ? decisions.p_dim(beam, bin) : decisions.p_detect[bin];
      const double empty = empty_of(explained_[static_cast<std::size_t>(beam) * decisions.bins() + bin] - voxel.own);
      const double ratio = graded && !is_dim ? static_cast<double>(decisions.ratios(beam)[bin]) / cells_told : p / any;
      ratios += ratio / (ratio * (1 - empty) + empty);
    });
    const VoxelIndex at = VoxelBlocks::place_of(voxel.offset);
    const Vector3d p = Eigen::Map<const Eigen::Vector3f>(part.first).cast<double>() + voxel_m_ * at.cast<double>();
    const double turned = law_.turned(p, moved_W_, voxel_m_);
    more = law_.echo(to_log_odds(static_cast<LogOdds16>(old)), ratios / hits, turned) / kEvidenceUnit;
    more = std::min(more, -silence * (1 - any) / any);  // of empty water the evidence must not rise on average
  }
  const double kept = std::clamp<double>(old + more, bounds.least, bounds.most);
  evidence = static_cast<LogOdds16>(kept + (kept < 0 ? -0.5 : 0.5));
}

double FanMapper::probability(LogOdds16 evidence) const {
  return probabilities()(prior_ + (evidence == kUnseen ? 0 : evidence));
}

/// Of a voxel's cells: those that tell anything, and of these those that hold an echo.
std::pair<int, int> FanMapper::counts(const MixedVoxel& voxel) const {
  const auto before = [&](int beam, int bin) {
    return static_cast<std::uint32_t>(sums_[static_cast<std::size_t>(beam) * (window_.bins + 1) + bin]);
  };
  const std::uint32_t both = before(voxel.beam_end, voxel.bin_end) - before(voxel.beam, voxel.bin_end) -
                             before(voxel.beam_end, voxel.bin) + before(voxel.beam, voxel.bin);
  return {static_cast<int>(both >> 16), static_cast<int>(both & 0xFFFF)};
}

std::vector<EchoForecast> FanMapper::forecast(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                                              const VoxelMap& map) {
  ISOBATH_ASSERT(map.voxel_m() == voxel_m_);
  if (ping.fan != fan_ || ping.window != window_) take_geometry(ping);
  const int beams = ping.fan->beams(), bins = ping.window.bins;
  EchoDecisions echoes_everywhere;  // so that the kernel lists every voxel with its cells
  echoes_everywhere.reset(beams, bins);
  echoes_everywhere.p_detect.assign(static_cast<std::size_t>(bins), 1);
  for (int beam = 0; beam < beams; ++beam) {
    std::copy_n(echoes_everywhere.usable(), echoes_everywhere.words(), echoes_everywhere.hits(beam));
  }
  ThreadPool alone(1);
  take_decisions(echoes_everywhere, alone);
  const Pose X_WF = X_WB * ping.X_BS * X_SF_;
  aim(X_WF);
  struct Cell {
    std::int64_t explained = 0;
    int voxels = 0, seen = 0;
  };
  std::vector<Cell> cells(static_cast<std::size_t>(beams) * bins);
  std::vector<LogOdds16> nothing(VoxelBlocks::kVolume, kUnseen);
  std::vector<MixedVoxel> all;
  for (const Part& part : parts_of(X_WF)) {
    all.clear();
    look_at_block(view_, part.first, {}, nothing.data(), all);
    for (const MixedVoxel& v : all) {
      const VoxelIndex at = part.corner + VoxelBlocks::place_of(v.offset);
      const std::int32_t own = explanation(map.probability(at), v);
      const int seen = map.is_seen(at) ? 1 : 0;
      for (int beam = v.beam; beam < v.beam_end; ++beam) {
        for (int bin = v.bin; bin < v.bin_end; ++bin) {
          Cell& cell = cells[static_cast<std::size_t>(beam) * bins + bin];
          cell.explained += own;
          cell.seen += seen;
          ++cell.voxels;
        }
      }
    }
  }
  std::vector<EchoForecast> forecast(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double f = decisions.false_alarm, p = p_voxel(decisions.p_detect[i % static_cast<std::size_t>(bins)], f);
    forecast[i].p_echo =
        static_cast<float>(f + (p - f) * -std::expm1(-kExplained * static_cast<double>(cells[i].explained)));
    forecast[i].seen = static_cast<float>(cells[i].seen) / static_cast<float>(std::max(1, cells[i].voxels));
  }
  return forecast;
}

// The decisions of a ping --------------------------------------------------------------------------------------------

/// Behind the first echo of enough bins, clear bins tell nothing.
void FanMapper::hide_shadows(const EchoDecisions& decisions, int beam, std::uint64_t* tells) const {
  const std::uint64_t* hits = decisions.hits(beam);
  int run = 0, bin = 0;
  for (; bin < decisions.bins() && run < config_.shadow_bins; ++bin)
    run = bit(tells, bin) && bit(hits, bin) ? run + 1 : 0;
  if (run < config_.shadow_bins) return;
  for (int word = bin / 64; word < decisions.words(); ++word) {
    const std::uint64_t behind = word == bin / 64 ? ~std::uint64_t{0} << (bin % 64) : ~std::uint64_t{0};
    tells[word] &= ~behind | hits[word];
  }
}

/// What a beam tells, and the sums over its own bins.
void FanMapper::take_beam(const EchoDecisions& decisions, int beam) {
  const auto row = static_cast<std::size_t>(beam) * words_;
  std::uint64_t *tells = heard_.data() + row, *echoes = echoes_.data() + row;
  const std::uint64_t *dim = decisions.dim(beam), *hits = decisions.hits(beam);
  for (int w = 0; w < words_; ++w) {
    tells[w] = decisions.usable()[w] & fit_[w];
    if (!dim) continue;
    tells[w] &= ~dim[w] | hits[w];
    for (std::uint64_t loud = dim[w] & tells[w]; loud != 0; loud &= loud - 1) {
      const int bin = 64 * w + std::countr_zero(loud);
      if (!(decisions.p_dim(beam, bin) > decisions.false_alarm)) tells[w] &= ~(loud & -loud);
    }
  }
  if (config_.shadow_bins > 0) hide_shadows(decisions, beam, tells);
  std::uint32_t sum = 0;  // two counters that wrap around; their differences over a rectangle do not
  std::int32_t* sums =
      sums_.data() + (static_cast<std::size_t>(beam) + 1) * (static_cast<std::size_t>(window_.bins) + 1);
  sums[0] = 0;
  for (int w = 0, bin = 0; w < words_; ++w) {
    echoes[w] = tells[w] & hits[w];
    std::uint64_t told = tells[w], hit = echoes[w];
    for (const int end = std::min(64 * (w + 1), window_.bins); bin < end; ++bin, told >>= 1, hit >>= 1) {
      sum += (static_cast<std::uint32_t>(told & 1) << 16) + static_cast<std::uint32_t>(hit & 1);
      sums[bin + 1] = static_cast<std::int32_t>(sum);
    }
  }
}

void FanMapper::take_decisions(const EchoDecisions& decisions, ThreadPool& pool) {
  const int beams = decisions.beams(), bins = decisions.bins();
  words_ = decisions.words();
  fit_.assign(static_cast<std::size_t>(words_), 0);
  for (int bin = 0; bin < bins; ++bin) {
    if (decisions.p_detect[bin] > decisions.false_alarm) fit_[bin / 64] |= std::uint64_t{1} << (bin % 64);
  }
  const auto stride = static_cast<std::size_t>(bins) + 1;
  heard_.resize(static_cast<std::size_t>(beams) * words_);
  echoes_.resize(heard_.size());
  sums_.resize((static_cast<std::size_t>(beams) + 1) * stride);
  std::fill_n(sums_.begin(), stride, 0);
  pool.share(beams, kBeamsAPiece, [&](int begin, int end) {
    for (int beam = begin; beam < end; ++beam) take_beam(decisions, beam);
  });
  for (std::size_t i = stride; i < sums_.size(); ++i) {  // of the beams before it, too
    sums_[i] =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(sums_[i]) + static_cast<std::uint32_t>(sums_[i - stride]));
  }
  view_.sums = sums_.data();

  clear_.resize(static_cast<std::size_t>(bins));
  clear_ratio_.resize(static_cast<std::size_t>(bins));
  for (int bin = 0; bin < bins; ++bin) {
    const double ratio =
        std::max(1e-6, (1 - p_voxel(decisions.p_detect[bin], decisions.false_alarm)) / (1 - decisions.false_alarm));
    const bool counted = config_.rule == FanMapperConfig::Rule::kHitAndMiss;
    clear_ratio_[bin] = static_cast<float>(ratio);
    if (config_.rule == FanMapperConfig::Rule::kAspects) {
      const double silence = law_.silence(decisions.p_detect[bin], decisions.false_alarm);
      clear_[bin] = static_cast<float>(silence / kEvidenceUnit);
      continue;
    }
    clear_[bin] = static_cast<float>((counted ? config_.miss : std::log(ratio)) / kEvidenceUnit);
  }
  view_.clear = clear_.data();
  view_.saturation = saturation_.empty() ? nullptr : saturation_.data();
  const bool uniform = std::all_of(clear_.begin(), clear_.end(), [&](float c) { return c == clear_.front(); });
  view_.uniform_clear = uniform ? clear_.front() : 0;
}

// The geometry of a sonar --------------------------------------------------------------------------------------------

const char* FanMapper::fault_of(const Ping& ping, double voxel_m) {
  constexpr double kMostVoxels = 1e9, kMostAcross = 4000;
  const BeamFan& fan = *ping.fan;
  const double range = ping.window.end_m() / voxel_m;
  const double cells = (std::sqrt(3.0) * voxel_m / ping.window.bin_m + 2) * fan.beams();
  if (!(cells < 65536)) return "voxels far too large for the bins of a ping";
  const Angle span = fan.azimuth.back() - fan.azimuth.front() + fan.width.front() * 0.5 + fan.width.back() * 0.5;
  const double angle = std::min(2 * pi, span.radians()) * 2 * std::max(sine_of_half(fan), 1 / range);  // steradians
  if (!(range < kMostAcross && angle * range * range * range / 3 < kMostVoxels)) {
    return "voxels far too small for the range of a ping";
  }
  return nullptr;
}

void FanMapper::take_geometry(const Ping& ping) {
  const BeamFan& fan = *ping.fan;
  const auto beams = static_cast<std::size_t>(fan.beams());
  if (const char* fault = fault_of(ping, voxel_m_)) {
    throw Error(fmt::format("voxels of {:g} m, bins of {:g} m to {:g} m in {} beams: {}", voxel_m_, ping.window.bin_m,
                            ping.window.end_m(), beams, fault),
                {}, "", "set voxel_m");
  }
  fan_ = ping.fan;
  window_ = ping.window;

  // A beam ends half way to the next, or where its width does.
  const auto radians = [](Angle a) { return a.radians(); };
  std::vector<double> left(beams), right(beams);
  double spacing = 0;
  for (std::size_t b = 0; b < beams; ++b) {
    const double azimuth = radians(fan.azimuth[b]), half = 0.5 * radians(fan.width[b]);
    left[b] = b > 0 ? std::max(azimuth - half, 0.5 * (radians(fan.azimuth[b - 1]) + azimuth)) : azimuth - half;
    right[b] = b + 1 < beams ? std::min(azimuth + half, 0.5 * (azimuth + radians(fan.azimuth[b + 1]))) : azimuth + half;
    if (b > 0) spacing += (azimuth - radians(fan.azimuth[b - 1])) / radians(fan.width[b]);
  }
  const double middle = 0.5 * (left.front() + right.back());
  X_SF_ = {Rotation::from_heading(Angle::radians(middle)), Vector3d::Zero()};
  half_width_ = std::min(pi, 0.5 * (right.back() - left.front()));
  sine_ = sine_of_half(fan);
  beams_at_.assign(FanView::kDirections, 0);
  const auto index_of = [&](double azimuth) {
    const double a = std::clamp(azimuth - middle, -pi, pi);
    return direction_index(static_cast<float>(std::cos(a)), static_cast<float>(std::sin(a)));
  };
  std::vector<std::int32_t> ended(FanView::kDirections + 1, 0), begun(FanView::kDirections + 1, 0);
  for (std::size_t b = 0; b < beams; ++b) {
    ++begun[static_cast<std::size_t>(index_of(left[b]))];
    ++ended[static_cast<std::size_t>(index_of(right[b])) + 1];
  }
  std::int32_t left_of = 0, begin = 0;
  for (std::size_t e = 0; e < FanView::kDirections; ++e) {
    left_of += ended[e];
    begin += begun[e];
    beams_at_[e] = left_of | begin << 16;
  }

  view_.voxel_m = static_cast<float>(voxel_m_);
  view_.sine = static_cast<float>(sine_);
  view_.start_m = static_cast<float>(window_.start_m);
  view_.bins_per_m = static_cast<float>(1 / window_.bin_m);
  view_.beams = fan.beams();
  view_.bins = window_.bins;
  view_.most_looks = static_cast<float>(config_.most_looks);
  view_.looks_per_beam = static_cast<float>(beams > 1 ? std::min(1.0, spacing / static_cast<double>(beams - 1)) : 1.0);
  view_.beams_at = beams_at_.data();
}

}  // namespace isobath

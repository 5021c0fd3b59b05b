#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/perception/fan_mapper.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kExplained = 1.0 / (1 << 14);  // unit of `explained_`
constexpr int kBlocksAPiece = 8;

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
  Probabilities() : of_(2 * kMax + 1) {
    for (std::size_t i = 0; i < of_.size(); ++i) {
      of_[i] = 1 / (1 + std::exp(-kEvidenceUnit * (static_cast<double>(i) - kMax)));
    }
  }
  double operator()(int log_odds) const {
    const int at = std::clamp(log_odds, -kMax, kMax) + kMax;
    return of_[static_cast<std::size_t>(at)];
  }

 private:
  static constexpr int kMax = 48 * 1024;
  std::vector<double> of_;
};
const Probabilities& probabilities() {
  static const Probabilities all;
  return all;
}

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
      Field::real("visibility", &c.visibility, {0.01, 1}, "1",
                  "Share of the looks at an occupied voxel in which it can echo at all.")
          .was("answers"),
      Field::real("max_looks", &c.max_looks, {1, 1000}, "1", "Independent looks of one ping at one voxel, at most.")
          .was("most_looks"),
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
      law_(config.aspects),
      sector_(voxel_m) {
  ISOBATH_ASSERT(voxel_m > 0 && std::isfinite(prior));
  if (config.rule != FanMapperConfig::Rule::kAspects) return;
  saturation_.resize(FanView::kSteps);
  for (int i = 0; i < FanView::kSteps; ++i) {
    const double middle = (i + FanView::kMinStep + 0.5) * (1 << FanView::kStepLog2);
    saturation_[static_cast<std::size_t>(i)] = static_cast<float>(law_.share(kEvidenceUnit * middle));
  }
}

int FanMapper::update(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB, VoxelBlocks& layer,
                      int threads) {
  ISOBATH_ASSERT(decisions.beams() == ping.fan->beams() && decisions.bins() == ping.window.bins);
  take_ping(ping);
  if (!pool_ || pool_->threads() != std::max(1, threads)) pool_ = std::make_unique<ThreadPool>(threads);
  take_decisions(decisions, *pool_);
  const Pose X_WF = X_WB * ping.X_BS * sector_.X_SF();
  sector_.aim(X_WF, surface_m_, view_);

  if (last_W_) moved_W_ = X_WF.translation - *last_W_;
  last_W_ = X_WF.translation;

  // The blocks are found and made one after another, in one order; then each is one thread's.
  std::vector<EnsonifiedBlock> parts = sector_.blocks(X_WF);
  for (EnsonifiedBlock& part : parts) part.evidence = layer.touch(part.corner);
  const int count = static_cast<int>(parts.size());
  const bool aspects = config_.rule == FanMapperConfig::Rule::kAspects;
  const bool marginal = config_.rule == FanMapperConfig::Rule::kMarginal || aspects;
  if (mixed_.size() < parts.size()) mixed_.resize(parts.size());
  if (marginal) explained_.assign(static_cast<std::size_t>(decisions.beams()) * decisions.bins(), 0);
  const bool alone = pool_->threads() == 1;
  pool_->share(count, kBlocksAPiece, [&](int begin, int end) {
    for (int n = begin; n < end; ++n) {
      const EnsonifiedBlock& part = parts[static_cast<std::size_t>(n)];
      std::vector<MixedVoxel>& mixed = mixed_[static_cast<std::size_t>(n)];
      mixed.clear();
      look_at_block(view_, part.first, layer.bounds(), part.evidence, mixed);
      if (!marginal) continue;
      for (MixedVoxel& v : mixed) explain(v, part.evidence, alone);
    }
  });
  pool_->share(count, kBlocksAPiece, [&](int begin, int end) {
    for (int n = begin; n < end; ++n) {
      const EnsonifiedBlock& part = parts[static_cast<std::size_t>(n)];
      for (const MixedVoxel& v : mixed_[static_cast<std::size_t>(n)])
        aspects ? settle_aspect(v, decisions, layer.bounds(), part)
                : settle(v, decisions, layer.bounds(), part.evidence);
    }
  });
  return count;
}

/// Counts a voxel among those that may have given the echoes of its cells. Whole numbers: in any order the same.
void FanMapper::explain(MixedVoxel& voxel, const LogOdds16* block, bool alone) {
  if (cells_.counts(voxel).second == 0) return;
  const double visibility = config_.rule == FanMapperConfig::Rule::kAspects ? config_.aspects.visibility : 1.0;
  voxel.own = explanation(visibility * probability(block[voxel.offset]), voxel);
  cells_.each_echo(voxel, [&](int beam, int bin) {
    std::int32_t& cell = explained_[static_cast<std::size_t>(beam) * sector_.window().bins + bin];
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
  cells_.each_echo(voxel, [&](int beam, int bin) {
    const bool is_dim = decisions.is_dim(beam, bin);
    const double heard = decisions.p_of(beam, bin);
    const double p = p_voxel(heard, f);
    const std::size_t cell = static_cast<std::size_t>(beam) * decisions.bins() + bin;
    const double empty = marginal ? empty_of(explained_[cell] - voxel.own) : 1.0;
    if (graded && !is_dim) {
      const double ratio = 1 + config_.visibility * (static_cast<double>(decisions.ratios(beam)[bin]) - 1);
      ratios += ratio / (ratio * (1 - empty) + empty);
      return;
    }
    ratios += p / (p * (1 - empty) + f * empty);
  });
  const auto [told, hits] = cells_.counts(voxel);
  const double clear = clear_ratio_[std::min(sector_.window().bins - 1, (voxel.bin + voxel.bin_end) / 2)];
  ratios += (told - hits) * clear + (cells - told);
  const double looks = std::clamp(beams * static_cast<double>(view_.looks_per_beam), 1.0, config_.max_looks);
  const double more =
      config_.rule == Rule::kHitAndMiss ? (hits > 0 ? config_.hit : config_.miss) : looks * std::log(ratios / cells);
  const double total = (evidence == kUnseen ? 0 : evidence) + more / kEvidenceUnit;
  const double kept = std::clamp<double>(total, bounds.least, bounds.most);
  evidence = static_cast<LogOdds16>(kept + (kept < 0 ? -0.5 : 0.5));
}

/// The same by the rule `aspects`.
void FanMapper::settle_aspect(const MixedVoxel& voxel, const EchoDecisions& decisions, const EvidenceBounds& bounds,
                              const EnsonifiedBlock& part) const {
  LogOdds16& evidence = part.evidence[voxel.offset];
  const int old = evidence == kUnseen ? 0 : evidence;
  const int cells = (voxel.beam_end - voxel.beam) * (voxel.bin_end - voxel.bin);
  const auto [told, hits] = cells_.counts(voxel);
  const int step = std::clamp((old >> FanView::kStepLog2) - FanView::kMinStep, 0, FanView::kSteps - 1);
  const double silence =
      static_cast<double>(clear_[std::min(sector_.window().bins - 1, (voxel.bin + voxel.bin_end) / 2)]) *
      static_cast<double>(saturation_[static_cast<std::size_t>(step)]);
  double more = silence * told / cells;  // units of evidence
  if (hits > 0) {
    const bool graded = decisions.ratios(0) != nullptr;
    const double any = -std::expm1(told * std::log1p(-decisions.false_alarm));  // P(an echo | empty water)
    const EmptyShare& empty_of = empty_share();
    double ratios = 0;
    cells_.each_echo(voxel, [&, cells_told = told](int beam, int bin) {
      const bool is_dim = decisions.is_dim(beam, bin);
      const double p = decisions.p_of(beam, bin);
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

std::vector<EchoForecast> FanMapper::forecast(const Ping& ping, const EchoDecisions& decisions, const Pose& X_WB,
                                              const VoxelMap& map) {
  ISOBATH_ASSERT(map.voxel_m() == voxel_m_);
  take_ping(ping);
  const int beams = ping.fan->beams(), bins = ping.window.bins;
  EchoDecisions echoes_everywhere;  // so that the kernel lists every voxel with its cells
  echoes_everywhere.reset(beams, bins);
  echoes_everywhere.p_detect.assign(static_cast<std::size_t>(bins), 1);
  for (int beam = 0; beam < beams; ++beam) {
    std::copy_n(echoes_everywhere.usable(), echoes_everywhere.words(), echoes_everywhere.hits(beam));
  }
  ThreadPool alone(1);
  take_decisions(echoes_everywhere, alone);
  const Pose X_WF = X_WB * ping.X_BS * sector_.X_SF();
  sector_.aim(X_WF, surface_m_, view_);
  struct Cell {
    std::int64_t explained = 0;
    int voxels = 0, seen = 0;
  };
  std::vector<Cell> cells(static_cast<std::size_t>(beams) * bins);
  std::vector<LogOdds16> nothing(VoxelBlocks::kVolume, kUnseen);
  std::vector<MixedVoxel> all;
  for (const EnsonifiedBlock& part : sector_.blocks(X_WF)) {
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

void FanMapper::take_ping(const Ping& ping) {
  if (sector_.is_of(ping)) return;
  sector_.update(ping, view_);
  view_.max_looks = static_cast<float>(config_.max_looks);
}

void FanMapper::take_decisions(const EchoDecisions& decisions, ThreadPool& pool) {
  const int bins = decisions.bins();
  cells_.update(decisions, config_.shadow_bins, pool);
  view_.sums = cells_.sums();

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

}  // namespace isobath

#include <algorithm>
#include <cmath>
#include <isobath/perception/depth_update.hpp>
#include <isobath/perception/scan_conversion.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSteep = 80 * std::numbers::pi / 180;
constexpr double kWrongDepths = 10;  // m: span of possible depths of a wrong echo (S1-73)

/// Log-odds that a reading that agrees within the margin does so because it is right (S1-73).
double evidence_of(double sigma_m, double margin_m) {
  const double right = std::clamp(std::erf(margin_m / (std::numbers::sqrt2 * sigma_m)), 1e-6, 1 - 1e-6);
  const double wrong = std::min(2 * margin_m / kWrongDepths, 0.5);
  return std::max(0.0, std::log(right / wrong));
}

Claim claim_of(PixelEvidence::Kind kind) {
  switch (kind) {
    case PixelEvidence::Kind::kBottom: return Claim::kBottomAt;
    case PixelEvidence::Kind::kClear: return Claim::kAtLeast;
    case PixelEvidence::Kind::kObstructed: return Claim::kAtMost;
    case PixelEvidence::Kind::kConfirm: break;
  }
  return Claim::kSomewhere;
}

/// Nearest integer of |x| < 2^22, ties to even, like lrint but without a call: the compiler cannot inline lrint while
/// it has to keep errno.
std::int32_t rounded(float x) {
  constexpr double kShift = 6755399441055744;  // 1.5 * 2^52: the fraction is rounded off
  return static_cast<std::int32_t>((static_cast<double>(x) + kShift) - kShift);
}

}  // namespace

double evidence_share(double sigma_m, double margin_m) {
  return std::min(1.0, evidence_of(std::max(sigma_m, 0.01), margin_m) / evidence_of(margin_m / 3, margin_m));
}

DepthUpdate::DepthUpdate(const DepthMapperParts& parts, const PixelGrid& grid)
    : config_(parts.mapper),
      rules_(parts.rules),
      grid_(grid),
      cos_depth_within_(std::cos(parts.evidence.depth_within.radians())),
      evidence_(parts.evidence, grid),
      deviation_(parts.evidence.deviation),
      predictor_(parts.evidence.deviation, grid) {
  spans_.reserve(static_cast<std::size_t>(std::ceil(kTrackBreak / grid.pixel_m)) + 3);
}

std::optional<BeamCone> DepthUpdate::cone(const RangeReading& reading, const Pose& X_WB) const {
  auto found = evidence_.cone(reading, X_WB);
  if (found && !has_pixels(found->apex().head<2>())) found.reset();
  return found;
}

std::optional<DepthUpdate::Bottom> DepthUpdate::bottom_of(const DepthLook& look) const {
  const double spread = config_.spread_sigmas * look.sigma_m;
  if (look.kind == DepthLook::Kind::kSounding) {
    if (look.in_water || !has_pixels(look.p.head<2>())) return std::nullopt;
    return Bottom{look.p, look.range_m * std::tan(look.half_angle.radians()) + spread};
  }
  if (look.kind != DepthLook::Kind::kRange || !look.depth_sonar || !is_echo(look.reading, true)) return std::nullopt;
  const auto beam = cone(look.reading, look.X_WB);
  if (!beam) return std::nullopt;
  const double range = *look.reading.range_m;
  return Bottom{beam->apex() + range * beam->axis(), range * std::tan(beam->half_angle().radians()) + spread};
}

bool DepthUpdate::has_pixels(const Vector2d& north_east) const {
  // maxCoeff may ignore NaN, so finiteness is checked first.
  return north_east.allFinite() && (north_east - grid_.corner_m).cwiseAbs().maxCoeff() < grid_.pixel_m * (1 << 28);
}

PixelWindow DepthUpdate::reach(const DepthLook& look) const {
  Vector2d middle = look.X_WB.translation.head<2>();
  double radius = 0;  // m
  const double spread = config_.spread_sigmas * look.sigma_m;
  constexpr double kLongest = 10;  // largest axis ratio of a footprint ellipse
  switch (look.kind) {
    case DepthLook::Kind::kRange: {
      // A prediction reads pixels up to a tenth beyond the range, along a cone that may be wide.
      const double cap = evidence_.config().range_cap_m;
      const double range = std::max(cap, look.reading.range_m.value_or(0));
      const double spot = cap * std::tan(look.reading.width.radians() / 2);
      radius = look.reading.X_BS.translation.norm() + 2 * range + kLongest * (2 * spot * range / cap + spread);
      if (!look.depth_sonar)
        radius = look.reading.X_BS.translation.norm() + 1.2 * evidence_.config().range_cap_m + spot;
      break;
    }
    case DepthLook::Kind::kSounding:
      middle = look.p.head<2>();
      radius = kLongest * (look.range_m * std::tan(look.half_angle.radians()) + spread);
      break;
    case DepthLook::Kind::kTrack:
      middle = look.q;
      radius = (look.p.head<2>() - look.q).norm();
      break;
  }
  const double pixels = std::ceil(radius / grid_.pixel_m) + evidence_.config().extension_px + 2;
  if (!(pixels < (1 << 28)) || !has_pixels(middle)) return {-(1 << 29), -(1 << 29), 1 << 30, 1 << 30};
  const auto n = static_cast<std::int32_t>(pixels);
  const Pixel at = grid_.at(middle);
  return {at.column - n, at.row - n, 2 * n + 1, 2 * n + 1};
}

UpdateOutcome DepthUpdate::apply(DepthWindow& window, const DepthLook& look, const Listener* listener) {
  if (listener != nullptr && !*listener) listener = nullptr;
  switch (look.kind) {
    case DepthLook::Kind::kTrack: return apply_track(window, look, listener);
    case DepthLook::Kind::kSounding: return apply_sounding(window, look, listener);
    case DepthLook::Kind::kRange: break;
  }
  return apply_range(window, look, listener);
}

UpdateOutcome DepthUpdate::apply_sounding(DepthWindow& window, const DepthLook& look, const Listener* listener) {
  ReadingContext context;
  context.count = look.count;
  if (look.sigma_m > 0) context.navigation_m = look.sigma_m;
  context.window = window.extent();
  const double spread = config_.spread_sigmas * look.sigma_m;
  const double radius = look.range_m * std::tan(look.half_angle.radians()) + spread;
  const Angle half = look.range_m > 0 ? Angle::radians(std::atan(radius / look.range_m)) : Angle();
  const Evidence found = evidence_.add_sounding(look.p, look.u, look.range_m, half, look.depth_sigma_m, context);
  return apply_evidence(window, found, look, kSeenByDepth, listener);
}

UpdateOutcome DepthUpdate::apply_range(DepthWindow& window, const DepthLook& look, const Listener* listener) {
  ReadingContext context;
  context.count = look.count;
  if (look.sigma_m > 0) context.navigation_m = look.sigma_m;
  context.window = window.extent();
  if (look.depth_sonar) {
    const double spread = config_.spread_sigmas * look.sigma_m;
    if (!(spread > 0 && look.reading.range_m)) {
      return apply_evidence(window, evidence_.add_reading(look.reading, look.X_WB, context), look, kSeenByDepth,
                            listener);
    }
    RangeReading reading = look.reading;
    reading.width = Angle::radians(2 * std::atan(std::tan(reading.width.radians() / 2) + spread / *reading.range_m));
    return apply_evidence(window, evidence_.add_reading(reading, look.X_WB, context), look, kSeenByDepth, listener);
  }
  std::optional<RangePrediction> prediction;
  if (config_.affirm_predicted && is_echo(look.reading, false)) {
    if (const auto beam = cone(look.reading, look.X_WB)) {
      prediction = predict(window, *beam, evidence_.max_range_m(look.reading));
      if (prediction) context.prediction = &*prediction;
    }
  }
  const Evidence found = evidence_.add_reading(look.reading, look.X_WB, context);
  return apply_evidence(window, found, look, kSeenByObstacle, listener);
}

/// The expected range; empty if no bottom is within reach. Tests blocks of 8 x 8 pixels first, and then reads only the
/// rectangle around the blocks within reach.
std::optional<RangePrediction> DepthUpdate::predict(const DepthWindow& window, const BeamCone& cone,
                                                    double max_range_m) {
  const PixelWindow all = overlap(predictor_.window(cone, max_range_m), window.extent());
  if (all.width <= 0 || all.height <= 0) return std::nullopt;
  const double down = std::min(cone.depression().radians() + cone.half_angle().radians(), std::numbers::pi / 2);
  const double deepest = cone.apex().z() + RangePredictor::kBeyond * max_range_m * std::sin(down);
  const auto reach_cm = static_cast<std::int32_t>(std::ceil(100 * std::clamp(deepest, -1e6, 1e6)));
  constexpr int kA = DepthBlock::kPixels;
  // At shorter distances the lower side of the beam is still above the ground of a block.
  const bool slants = down < kSteep;
  const double fall = slants ? std::tan(down) : 0;
  const double corner = grid_.pixel_m * kA * std::numbers::sqrt2 / 2;
  const Vector2d home = cone.apex().head<2>();
  const auto too_near = [&](int column, int row, std::int32_t ground_cm) {
    if (!slants) return false;
    constexpr double kHalf = 0.5 * kA;
    const Vector2d middle{grid_.corner_m.x() - (row + kHalf) * grid_.pixel_m,
                          grid_.corner_m.y() + (column + kHalf) * grid_.pixel_m};
    const double farthest = (middle - home).norm() + corner;
    const double below = 0.01 * ground_cm - cone.apex().z();
    const double doubt = deviation_.vertical_m + deviation_.attitude.radians() * (farthest + std::abs(below));
    return farthest * fall < below - doubt;
  };
  int west = all.column + all.width, east = all.column, north = all.row + all.height, south = all.row;
  for (int row = all.row & ~(kA - 1); row < all.row + all.height; row += kA) {
    for (int column = all.column & ~(kA - 1); column < all.column + all.width; column += kA) {
      const DepthTile& tile = *window.tile(DepthWindow::tile_of({column, row}));
      const int block = ((row & 31) / kA) * DepthTile::kBlocks + (column & 31) / kA;
      const std::int32_t ground_cm = tile.blocks[static_cast<std::size_t>(block)].min_cm;
      if (ground_cm > reach_cm || too_near(column, row, ground_cm)) continue;
      west = std::min(west, column);
      east = std::max(east, column + kA);
      north = std::min(north, row);
      south = std::max(south, row + kA);
    }
  }
  const PixelWindow wanted = overlap(all, {west, north, east - west, south - north});
  if (wanted.width <= 0 || wanted.height <= 0) return std::nullopt;
  const auto size = static_cast<std::size_t>(wanted.width) * static_cast<std::size_t>(wanted.height);
  if (patch_.size() < size) patch_.resize(size);
  for (const PixelSpan& span : predictor_.pixels(cone, max_range_m, wanted)) {
    float* to = patch_.data() + std::ptrdiff_t{span.row - wanted.row} * wanted.width - wanted.column;
    for (int column = span.column_begin; column < span.column_end;) {
      const DepthTile& tile = *window.tile(DepthWindow::tile_of({column, span.row}));
      const int end = std::min(span.column_end, (column | 31) + 1);
      for (; column < end; ++column) {
        const DepthPixel& pixel = tile.pixels[static_cast<std::size_t>(DepthWindow::index_in_tile({column, span.row}))];
        to[column] = vouched(pixel) ? static_cast<float>(pixel.depth_m()) : std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  return predictor_.predict_listed(cone, max_range_m, {wanted, std::span(patch_).first(size)});
}

/// Confidence units: the weight if sigma is at most a third of the margin, less if it is larger. A reading worth less
/// than half a unit counts as one unit at random, with a probability equal to its worth. So many weak readings that
/// agree count in the end, and a wrong chart does not stand permanently in water that is only seen from afar.
int DepthUpdate::step_of(const Evidence& found, double lot) const {
  if (!config_.range_weighting) return found.weight;
  const double margin = std::max(static_cast<double>(found.margin_m), evidence_.config().margin_m);
  const double units = found.weight * evidence_share(static_cast<double>(found.sigma_m), margin);
  return units < 0.5 ? static_cast<int>(lot < units) : static_cast<int>(std::lround(units));
}

UpdateOutcome DepthUpdate::apply_evidence(DepthWindow& window, const Evidence& found, const DepthLook& look,
                                          PixelFlag flag, const Listener* listener) {
  UpdateOutcome out;
  out.useless = found.outcome == Evidence::Outcome::kNothing;
  if (out.useless) return out;
  const int step = step_of(found, look.lot);
  out.outside = found.pixels.empty();
  out.examined = static_cast<std::uint32_t>(found.pixels.size());
  out.weak = step == 0;
  out.explained = found.explained;
  PixelReading says{.step = step, .flag = flag, .minute = look.minute};
  says.margin_cm = static_cast<std::int32_t>(std::lround(100 * found.margin_m));
  TilePtr* tile = nullptr;
  Pixel tile_at;
  for (const PixelEvidence& e : found.pixels) {
    const Pixel pixel{e.column, e.row};
    const Pixel at = DepthWindow::tile_of(pixel);
    if (tile == nullptr || !(at == tile_at)) {
      tile = &window.tile(at);
      tile_at = at;
    }
    const int index = DepthWindow::index_in_tile(pixel);
    const DepthPixel before = (*tile)->pixels[static_cast<std::size_t>(index)];
    says.claim = claim_of(e.kind);
    says.depth_cm = rounded(100 * e.bound_m);
    // Most pixels of most beams are clear water over a bottom far below.
    if (judge(before, says) == Verdict::kIrrelevant) continue;
    // An obstacle counts however uncertain it is: uncertainty may only make the vehicle more careful.
    says.step = says.claim == Claim::kAtMost ? std::max(step, 1) : step;
    const bool shallower = says.claim == Claim::kBottomAt && says.depth_cm < before.depth_cm();
    if (says.step == 0 && before.known() && !(rules_.unsure(before) && shallower)) continue;
    DepthPixel after = before;
    const Verdict verdict = isobath::apply(after, says, rules_);
    out.affirmed += verdict == Verdict::kAffirmed;
    out.conflicted += verdict == Verdict::kConflicted;
    out.replaced += verdict == Verdict::kReplaced;
    if (after == before) continue;
    out.changed = true;
    DepthWindow::set(tile->own(), index, after);
    if (listener != nullptr) (*listener)({pixel, before, after});
  }
  return out;
}

UpdateOutcome DepthUpdate::apply_track(DepthWindow& window, const DepthLook& look, const Listener* listener) {
  UpdateOutcome out;
  const auto leg = thick_segment(pixel_coordinates(grid_, look.p.head<2>()), pixel_coordinates(grid_, look.q), 0);
  pixels_touched(leg, window.extent(), spans_);
  for (const PixelSpan& span : spans_) {
    for (int column = span.column_begin; column < span.column_end; ++column) {
      const Pixel p{column, span.row};
      const DepthPixel before = window.at(p);
      if (before.has(kTrack)) continue;
      DepthPixel after = before;
      after.state_word = DepthPixel::word_of_state(before.confidence(), before.flags() | kTrack, before.minute());
      window.set(p, after);
      out.changed = true;
      if (listener != nullptr) (*listener)({p, before, after});
    }
  }
  return out;
}

}  // namespace isobath

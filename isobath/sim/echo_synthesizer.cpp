#include <algorithm>
#include <cmath>
#include <isobath/base/split_work.hpp>
#include <isobath/sim/echo_synthesizer.hpp>
#include <isobath/sim/fan_loops.hpp>
#include <isobath/sim/field_of_view.hpp>
#include <isobath/sim/scattering.hpp>
#include <numbers>

namespace isobath {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kSurfaceLoss = 0.7;   // intensity kept in a bounce off a rough surface (APL-UW TR 9407, about 1.5 dB)
constexpr double kLeastGain = 3e-5;    // gain of a receive beam below which an echo is ignored
constexpr double kLeastChange = 0.07;  // relative change of range within a cell above which the cell is divided
constexpr int kMostPieces = 64;
constexpr double kTilt = 0.6;           // largest depth of a cell along the ray, as a share of the range
constexpr double kLoudestSurface = 16;  // largest sigma of a glint
constexpr double kSmall = 4;            // a body smaller than so many cells in one direction gets cells of its own

double from_db(double db) { return std::pow(10, db / 10); }

struct Span {
  double near, far;
};

/// The ranges between which a cell meets the tangent plane of the surface at `range`. All vectors in one frame.
Span span_of(const ViewCell& cell, double range, const Vector3d& u, const Vector3d& across, const Vector3d& up,
             const Vector3d& normal) {
  const double straight = normal.dot(u);
  const double slant_across = cell.half_across * normal.dot(across), slant_up = cell.half_up * normal.dot(up);
  const double tilt = std::min(std::abs(slant_across) + std::abs(slant_up), kTilt * std::abs(straight));
  return {range * straight / (straight - tilt), range * straight / (straight + tilt)};
}

}  // namespace

void EchoImage::resize(int beam_count, int bin_count) {
  beams = beam_count;
  bins = bin_count;
  const std::size_t size = static_cast<std::size_t>(beams) * static_cast<std::size_t>(bins);
  rough.resize(size);
  steady.resize(size);
  strongest.resize(size);
  labels.resize(size);
}

struct EchoSynthesizer::State {
  SonarConfig config;
  const World& world;
  const Water& water;
  int threads;
  double floor = 0;
  std::vector<float> by_bin;  ///< gain of the receiver, 1 at its largest
  FieldOfView view;
  /// Echoes of each direction, before the receive patterns.
  struct Row {
    std::vector<float> power, strongest;
    std::vector<EchoLabel> labels;
    float loudest = 0;           ///< after the gain of the receiver
    std::vector<double> volume;  ///< differences along the bins of the (gain x solid angle) of open water
  };
  std::vector<Row> rows;

  struct Point {
    double azimuth;
    Span span;
    double power;
    EchoLabel label;
  };
  std::vector<Point> points;  ///< points of small bodies

  // State of the present ping.
  Pose X_WS;
  Eigen::Matrix3d R_WS = Eigen::Matrix3d::Identity();
  double head_reflection = 0;
  SeaSurface sea;
  double absorb = 0;                  ///< per metre, one way, natural
  std::vector<double> back_from;      ///< two-way attenuation of each bin
  std::vector<bool> small;            ///< by body: whether it has cells of its own
  std::vector<Scatterer> scatterers;  ///< by target, from the bottom on

  State(const SonarConfig& c, const World& w, const Water& wa, int t)
      : config(c), world(w), water(wa), threads(t), view(c), sea(wa.config().wind, c.frequency) {
    head_reflection = from_db(config.head_reflection_db);
    by_bin.assign(static_cast<std::size_t>(config.bins), 1.f);
    back_from = std::vector<double>(by_bin.size());
    scatterers.emplace_back(world.material(kBottom));
    for (const WorldBody& body : world.bodies()) scatterers.emplace_back(*body.material);
    rows.resize(view.directions.size());
    for (Row& row : rows) {
      const auto bins = static_cast<std::size_t>(config.bins), padded = bins + kLoopPad;
      row.power.resize(padded);
      row.strongest.resize(padded);
      row.labels.resize(padded);
      row.volume.resize(bins + 1);
    }
  }

  /// Within one cell a surface at grazing incidence spans many ranges. Its tangent plane is divided along the
  /// elevation, and each piece has its own range and power. Calls visit(piece, range, direction, up).
  template <class Visit>
  void pieces(const ViewCell& cell, double range, const Vector3d& u, const Vector3d& up, const Vector3d& normal,
              const Visit& visit) const {
    const double straight = -normal.dot(u), across_up = std::abs(2 * cell.half_up * normal.dot(up));
    // All of it is beyond the window: kTilt and the speed of sound bring an echo nearer by less than one half.
    if (straight * range > 2 * (config.range_m + config.resolution_m) * (straight + across_up)) return;
    const double change = across_up / std::max(straight, 1e-6);
    const double loudest = 0.003 * cell.gain * attenuation(2 * range) * cell.solid_angle / (range * range);
    if (change < kLeastChange || loudest < floor) return visit(cell, range, u, up);
    const double bins = change * range / bin_m();
    if (bins < 1) return visit(cell, range, u, up);
    const int count = std::min(kMostPieces, 1 + static_cast<int>(std::min(change / kLeastChange, bins)));
    ViewCell piece = cell;
    piece.half_up /= count;
    piece.solid_angle /= count;
    for (int i = 0; i < count; ++i) {
      const double offset = cell.half_up * ((2.0 * i + 1) / count - 1);
      const double square = offset * offset;  // cells are small: the series are exact to 1e-6
      const double cosine = 1 - square * (0.5 - square / 24), sine = offset * (1 - square * (1.0 / 6 - square / 120));
      const Vector3d v = cosine * u + sine * up;
      const double towards = -normal.dot(v), r = straight * range / std::max(towards, 1e-9);
      if (towards < 1e-4 || r > 2 * config.range_m) continue;  // over the horizon
      piece.elevation = cell.elevation + offset;
      piece.gain = view.height.gain(piece.elevation);
      visit(piece, r, v, Vector3d(cosine * up - sine * u));
    }
  }

  // One ray ----------------------------------------------------------------------------------------------------------

  [[nodiscard]] double bin_m() const { return config.range_m / config.bins; }
  [[nodiscard]] double attenuation(double path) const { return std::exp(-absorb * path); }
  /// Whether all echoes at these ranges, and their multiples, lie beyond the window.
  [[nodiscard]] bool too_far(const Span& read) const { return read.near - config.resolution_m >= config.range_m; }
  /// Factor from true range to the range that the device reads.
  [[nodiscard]] double stretch(double depth) const {
    return config.sound_speed / water.mean_sound_speed(X_WS.translation.z(), depth);
  }
  [[nodiscard]] bool has_own_cells(int target) const {
    return target >= kFirstBody && small[static_cast<std::size_t>(target - kFirstBody)];
  }
  [[nodiscard]] double reflection(int target) const {
    return target == kSurface ? kSurfaceLoss : scatterer(target).mirror;
  }

  /// Calls put(span, power, label) for every echo of a cell. `only`: the body that the cell was made for, or kNothing.
  template <class Put>
  void trace(const ViewCell& cell, int only, double& open_range, const Put& put) const {
    const Vector3d p = X_WS.translation, u = R_WS * cell.u;
    const double reach = 3 * config.range_m;  // part of a cell can be much nearer than its middle
    const double to_surface = u.z() < -1e-9 && p.z() > 0 ? -p.z() / u.z() : 1e30;
    const auto hit = world.cast(p, u, std::min(reach, to_surface));
    if (!hit) {
      open_range = std::min(reach, to_surface);
      if (only == kNothing && to_surface < 4 * reach) meet_surface(cell, p, u, to_surface, put);
      return;
    }
    open_range = hit->range;
    if (only != kNothing ? hit->target != only : has_own_cells(hit->target)) return;
    const Vector3d across_W = R_WS * cell.across, up_W = R_WS * cell.up;
    const bool silent = hit->target == kBottom && !config.bottom_reverberation;
    pieces(cell, hit->range, u, up_W, hit->normal,
           [&](const ViewCell& piece, double range, const Vector3d& v, const Vector3d& up) {
             const Span span = span_of(piece, range, v, across_W, up, hit->normal);
             const double k = stretch(p.z() + range * v.z());
             const Span read{k * span.near, k * span.far};
             if (too_far(read)) return;
             if (!silent) put(read, echo(piece, range, *hit, v), EchoLabel(hit->target, EchoPath::kDirect));
             if (config.multiple) repeat(piece, range, *hit, v, read, put);
           });
    if (only == kNothing && (hit->target == kBottom ? config.bottom_bounce : config.body_bounce)) {
      go_on(cell, p, u, hit->range, hit->normal, hit->target, put);
    }
  }

  [[nodiscard]] const Scatterer& scatterer(int target) const {
    return scatterers[static_cast<std::size_t>(target - kBottom)];
  }

  /// sigma for this cell where a ray along v meets a surface after `range` of path.
  [[nodiscard]] double sigma_of(const ViewCell& cell, double range, const RayHit& hit, const Vector3d& v) const {
    const double size = std::max(2 * cell.half_across, 2 * cell.half_up);  // change of the ray within the cell, rad
    if (hit.curvature == 0) return scatterer(hit.target)(v, hit.normal, any_tangent(hit.normal), size, size);
    const double cosine = std::max(-hit.normal.dot(v), 0.2);
    const double bent = size * (1 + range * hit.curvature / cosine);
    if (hit.straight.isZero()) return scatterer(hit.target)(v, hit.normal, any_tangent(hit.normal), bent, bent);
    return scatterer(hit.target)(v, hit.normal, hit.straight, size, bent);
  }

  static Vector3d any_tangent(const Vector3d& n) {
    return std::abs(n.z()) < 0.7 ? Vector3d(-n.y(), n.x(), 0).normalized() : Vector3d(0, -n.z(), n.y()).normalized();
  }

  /// Power of the echo that a cell meets after `range` of path and that returns by the same path. `cell.gain` is
  /// two-way, so the pattern is applied once.
  [[nodiscard]] double echo(const ViewCell& cell, double range, const RayHit& hit, const Vector3d& u) const {
    const double cosine = std::max(-hit.normal.dot(u), kLeastCosine);
    return cell.gain * attenuation(2 * range) * sigma_of(cell, range, hit, u) * cell.solid_angle /
           (cosine * range * range);
  }

  template <class Put>
  void meet_surface(const ViewCell& cell, const Vector3d& p, const Vector3d& u, double range, const Put& put) const {
    const Vector3d normal(0, 0, 1);
    if (config.surface_reverberation) {
      const double k = stretch(0);
      const Vector3d across_W = R_WS * cell.across, up_W = R_WS * cell.up;
      pieces(cell, range, u, up_W, normal, [&](const ViewCell& piece, double r, const Vector3d& v, const Vector3d& up) {
        const Span span = span_of(piece, r, v, across_W, up, normal);
        const Span read{k * span.near, k * span.far};
        if (too_far(read)) return;
        const double sine = std::max(-v.z(), kLeastCosine);
        const double sigma = sea(sine);
        put(read, piece.gain * attenuation(2 * r) * sigma * piece.solid_angle / (sine * r * r),
            EchoLabel(kSurface, EchoPath::kDirect));
      });
    }
    if (config.surface_bounce) go_on(cell, p, u, range, normal, kSurface, put);
  }

  /// A multiple: wall, housing, wall. By the image law its amplitude is that of the first echo times R H / 2.
  template <class Put>
  void repeat(const ViewCell& cell, double range, const RayHit& hit, const Vector3d& u, const Span& read,
              const Put& put) const {
    if (-hit.normal.dot(u) < 0.9) return;
    const double again = 0.25 * scatterer(hit.target).mirror * head_reflection;
    put(Span{2 * read.near, 2 * read.far}, echo(cell, range, hit, u) * cell.gain * again * attenuation(2 * range),
        EchoLabel(hit.target, EchoPath::kMultiple));
  }

  /// Traces the ray that a mirror reflects after `first` metres, and the echo that it meets.
  template <class Put>
  void go_on(const ViewCell& cell, const Vector3d& p, const Vector3d& u, double first, const Vector3d& mirror,
             int mirror_target, const Put& put) const {
    const double kept = reflection(mirror_target);
    const double best = cell.gain * kept * attenuation(2 * first) * cell.solid_angle / (first * first);  // at sigma 1
    if (best < 0.01 * floor || first > config.range_m) return;
    const auto reflect = [&mirror](const Vector3d& v) -> Vector3d { return v - 2 * v.dot(mirror) * mirror; };
    const Vector3d q = p + first * u, v = reflect(u);
    const double to_surface = v.z() < -1e-9 ? -q.z() / v.z() : 1e30;
    const auto hit = world.cast(q + 1e-3 * mirror, v, std::min(2 * config.range_m - first, to_surface));
    if (!hit || has_own_cells(hit->target)) return;
    follow(cell, p, q, v, first, *hit, reflect(R_WS * cell.across), reflect(R_WS * cell.up), kept,
           bounce(mirror_target), put);
  }

  static EchoPath bounce(int mirror_target) {
    return mirror_target == kSurface  ? EchoPath::kSurfaceBounce
           : mirror_target == kBottom ? EchoPath::kBottomBounce
                                      : EchoPath::kBodyBounce;
  }

  /// The two return paths of an echo whose outward path was over a mirror: over the mirror again, or direct. The direct
  /// path counts twice, since sound also takes it in the opposite sense.
  template <class Put>
  void follow(const ViewCell& cell, const Vector3d& p, const Vector3d& q, const Vector3d& v, double first,
              const RayHit& hit, const Vector3d& across_v, const Vector3d& up_v, double kept, EchoPath path,
              const Put& put) const {
    const double range = first + hit.range;
    const Vector3d at = q + hit.range * v;
    const double k = stretch(at.z());
    const Span span = span_of(cell, range, v, across_v, up_v, hit.normal);
    const EchoLabel label(hit.target, path);
    pieces(cell, range, v, up_v, hit.normal,
           [&](const ViewCell& piece, double r, const Vector3d& w, const Vector3d& up) {
             const Span there = span_of(piece, r, w, across_v, up, hit.normal);
             const Span read{k * there.near, k * there.far};
             if (!too_far(read)) put(read, kept * kept * echo(piece, r, hit, w), label);
           });
    const Vector3d back = at - p;
    const double d = back.norm();
    const double cosine = std::max(-hit.normal.dot(v), kLeastCosine), cosine_back = -hit.normal.dot(back) / d;
    if (cosine_back <= 0 || path == EchoPath::kBodyBounce || 0.5 * (range + d) > config.range_m) return;
    const Vector3d w_S = R_WS.transpose() * back / d;
    const double gain = std::sqrt(cell.gain * view.height.gain(std::asin(std::clamp(-w_S.z(), -1.0, 1.0))));
    const double sigma = std::sqrt(sigma_of(cell, range, hit, v) * sigma_of(cell, range, hit, back / d));
    const double power = 2 * gain * kept * sigma * cell.solid_angle / (cosine * d * d) * attenuation(range + d);
    if (power < 0.01 * floor || world.blocked(p, back / d, d * (1 - 1e-4) - 1e-3)) return;
    const double shift = 0.5 * (range + d) - range;
    put(Span{k * (span.near + shift), k * (span.far + shift)}, power, label);
  }

  // Columns of cells -------------------------------------------------------------------------------------------------

  void deposit(float* power, float* strongest, EchoLabel* labels, Span span, double energy, EchoLabel label) const {
    const double bin = bin_m();
    const double pulse = config.resolution_m > bin ? config.resolution_m : 0;
    double near = span.near, far = span.far, height_of = energy;
    if (pulse > 0) {
      const double length = std::max(far - near, pulse), middle = 0.5 * (near + far);
      near = middle - length / 2;
      far = middle + length / 2;
      height_of = energy * pulse / length;
    } else if (far - near > 1e-6) {
      height_of = energy * bin / (far - near);
    }
    const double a = near / bin, b = far / bin;
    if (!(b > 0) || !(a < config.bins)) return;
    const double middle_bin = 0.5 * (a + b);
    const double slope = b - a > 2 ? std::min(3 / middle_bin, 1.8 / (b - a)) : 0;
    const int first = std::max(0, static_cast<int>(a)), last = std::min(config.bins - 1, static_cast<int>(b));
    // Within a span the echo falls with about the third power of range, as that of a plane at grazing incidence.
    // Many rays meet the same target: their powers add up.
    if (pulse > 0 || far - near > 1e-6) {
      return add_echo({a, b, middle_bin, slope, height_of, label}, first, last, power, strongest, labels);
    }
    // A point target lies in one bin.
    add_echo({double(first), first + 1.0, middle_bin, 0, height_of, label}, first, first, power, strongest, labels);
  }

  void look(int direction) {
    Row& row = rows[static_cast<std::size_t>(direction)];
    std::fill(row.power.begin(), row.power.end(), 0.f);
    std::fill(row.strongest.begin(), row.strongest.end(), 0.f);
    std::fill(row.labels.begin(), row.labels.end(), EchoLabel());
    std::fill(row.volume.begin(), row.volume.end(), 0.0);
    const ViewCell* column = view.column(direction);
    for (int i = 0; i < view.cells_a_column(); ++i) {
      const ViewCell& cell = column[i];
      double open = 0;
      trace(cell, kNothing, open, [&](Span span, double power, EchoLabel label) {
        deposit(row.power.data(), row.strongest.data(), row.labels.data(), span, power, label);
      });
      row.volume[0] += cell.gain * cell.solid_angle;
      const int end = static_cast<int>(std::min<double>(open / bin_m(), config.bins));
      row.volume[static_cast<std::size_t>(end)] -= cell.gain * cell.solid_angle;
    }
    if (config.volume_reverberation) fill_volume(row);
    row.loudest = largest_product(row.strongest.data(), by_bin.data(), config.bins);
  }

  void fill_volume(Row& row) const {
    const double strength = from_db(water.config().volume_scattering_db), bin = bin_m();
    const double pulse = std::max(bin, config.resolution_m);
    double open = 0;
    for (int k = 0; k < config.bins; ++k) {
      open += row.volume[static_cast<std::size_t>(k)];
      const double r = (k + 0.5) * bin;
      const auto value = static_cast<float>(strength * open * pulse / (r * r) * back_from[static_cast<std::size_t>(k)]);
      row.power[static_cast<std::size_t>(k)] += value;
      if (value > row.strongest[static_cast<std::size_t>(k)]) {
        row.strongest[static_cast<std::size_t>(k)] = value;
        row.labels[static_cast<std::size_t>(k)] = EchoLabel(kNothing, EchoPath::kVolume);
      }
    }
  }

  // Small bodies -----------------------------------------------------------------------------------------------------

  struct Window {
    double left, right, low, high, nearest;
  };

  /// The angles that a box spans as seen from the sonar; empty within 5 cm of it, or if it spans more than 90 degrees
  /// of azimuth.
  [[nodiscard]] std::optional<Window> window_of(const Eigen::AlignedBox3d& box) const {
    if (box.exteriorDistance(X_WS.translation) < 0.05) return std::nullopt;
    const Vector3d middle = R_WS.transpose() * (box.center() - X_WS.translation);
    const double centre = std::atan2(middle.y(), middle.x());
    Window w{1e9, -1e9, 1e9, -1e9, box.exteriorDistance(X_WS.translation)};
    const auto include = [&](const Vector3d& p_W) {
      const Vector3d c = R_WS.transpose() * (p_W - X_WS.translation);
      const double azimuth = centre + std::remainder(std::atan2(c.y(), c.x()) - centre, 2 * kPi);
      const double elevation = std::atan2(-c.z(), std::hypot(c.x(), c.y()));
      w.left = std::min(w.left, azimuth);
      w.right = std::max(w.right, azimuth);
      w.low = std::min(w.low, elevation);
      w.high = std::max(w.high, elevation);
    };
    for (int i = 0; i < 8; ++i) include(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
    // The elevation of a broad box is extreme at its nearest point, between its corners.
    Vector3d nearest = X_WS.translation.cwiseMax(box.min()).cwiseMin(box.max());
    for (const double z : {box.min().z(), box.max().z()}) {
      nearest.z() = z;
      include(nearest);
    }
    if (w.right - w.left > kPi / 2) return std::nullopt;
    return w;
  }

  /// Whether it could give an echo: it is within range and elevation, and near enough to the beams for its size.
  [[nodiscard]] bool seen(const Window& w) const {
    if (w.nearest > config.range_m || w.low > view.edges.back() || w.high < view.edges.front()) return false;
    const double aside = std::max({0.0, w.left - view.beams.back(), view.beams.front() - w.right});
    if (aside > view.hearing) return false;
    const double size = (w.right - w.left) * (w.high - w.low);
    return kLoudestSurface * size / (w.nearest * w.nearest) * view.across.envelope(aside) > 0.1 * floor;
  }

  /// Traces cells around one body. `mirror_z`: over the horizontal mirror at that depth, or NaN for the direct path.
  void look_at(int target, Window w, double mirror_z, int mirror_target) {
    const double pad_across = 0.02 * (w.right - w.left) + 1e-6, pad_up = 0.02 * (w.high - w.low) + 1e-6;
    w.left -= pad_across;
    w.right += pad_across;
    w.low = std::max(w.low - pad_up, view.edges.front());
    w.high = std::min(w.high + pad_up, view.edges.back());
    if (w.high <= w.low) return;
    const auto count = [mirror_z](double extent, double cell) {
      const int least = std::isnan(mirror_z) ? 16 : 8;  // mirror images need not be exact
      return std::clamp(static_cast<int>(std::ceil(8 * extent / cell)), least, 24);
    };
    const int columns = count(w.right - w.left, view.cell_across), lines = count(w.high - w.low, view.cell_up);
    for (int c = 0; c < columns; ++c) {
      const double width = (w.right - w.left) / columns, azimuth = w.left + (c + 0.5) * width;
      const auto put = [&](Span span, double power, EchoLabel label) {
        points.push_back({azimuth, span, power, label});
      };
      for (int l = 0; l < lines; ++l) {
        const double step = (w.high - w.low) / lines;
        const ViewCell cell = cell_of(azimuth, width, w.low + l * step, w.low + (l + 1) * step, view.height);
        double open = 0;
        if (std::isnan(mirror_z)) {
          trace(cell, target, open, put);
        } else {
          over_mirror(cell, target, mirror_z, mirror_target, put);
        }
      }
    }
  }

  template <class Put>
  void over_mirror(const ViewCell& cell, int target, double mirror_z, int mirror_target, const Put& put) const {
    const Vector3d p = X_WS.translation, u = R_WS * cell.u;
    const double first = (mirror_z - p.z()) / u.z();
    if (!(first > 0) || first > config.range_m || world.blocked(p, u, first * (1 - 1e-4) - 1e-3)) return;
    const Vector3d q = p + first * u;
    const auto reflect = [](const Vector3d& v) { return Vector3d(v.x(), v.y(), -v.z()); };
    const Vector3d v = reflect(u), off = 1e-3 * Vector3d(0, 0, mirror_target == kSurface ? 1 : -1);
    const auto hit = world.cast(q + off, v, 2 * config.range_m - first);
    if (!hit || hit->target != target) return;
    follow(cell, p, q, v, first, *hit, reflect(R_WS * cell.across), reflect(R_WS * cell.up), reflection(mirror_target),
           bounce(mirror_target), put);
  }

  void look_at_small_bodies() {
    points.clear();
    const auto bodies = world.bodies();
    small.assign(bodies.size(), false);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Eigen::AlignedBox3d box = bodies[i].box;
      box.translate(bodies[i].moved);
      const auto w = window_of(box);
      small[i] = w && (w->right - w->left < kSmall * view.cell_across || w->high - w->low < kSmall * view.cell_up);
    }
    const double floor_z = world.bottom_depth(X_WS.translation.x(), X_WS.translation.y()).value_or(-1);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (!small[i]) continue;
      const int target = kFirstBody + static_cast<int>(i);
      Eigen::AlignedBox3d box = bodies[i].box;
      box.translate(bodies[i].moved);
      if (const auto w = window_of(box); w && seen(*w)) look_at(target, *w, std::nan(""), kNothing);
      if (config.surface_bounce && X_WS.translation.z() > 0) look_over(target, box, 0, kSurface);
      if (config.bottom_bounce && floor_z > X_WS.translation.z()) look_over(target, box, floor_z, kBottom);
    }
  }

  /// Traces a body over a horizontal mirror: the surface, or the bottom, taken as level at its depth below the sonar.
  void look_over(int target, const Eigen::AlignedBox3d& box, double mirror_z, int mirror_target) {
    Eigen::AlignedBox3d image = box;
    image.min().z() = 2 * mirror_z - box.max().z();
    image.max().z() = 2 * mirror_z - box.min().z();
    if (const auto w = window_of(image); w && seen(*w)) look_at(target, *w, mirror_z, mirror_target);
  }

  // Beams ------------------------------------------------------------------------------------------------------------

  struct Scratch {
    explicit Scratch(int bins)
        : from(static_cast<std::size_t>(bins)),
          power(from.size() + kLoopPad),
          strongest(power.size()),
          labels(power.size()) {}
    std::vector<const float*> rows;
    std::vector<float> gains;
    std::vector<FieldOfView::Weight> loud;
    std::vector<std::int32_t> from;
    std::vector<float> power, strongest;
    std::vector<EchoLabel> labels;
  };

  void gather(int beam, EchoImage& image, Scratch& scratch) const {
    const std::size_t start = static_cast<std::size_t>(beam) * static_cast<std::size_t>(image.bins);
    const auto& heard = view.weights[static_cast<std::size_t>(beam)];
    const auto row_of = [this](const FieldOfView::Weight& w) -> const Row& {
      return rows[static_cast<std::size_t>(w.direction)];
    };
    // A beam of a fan receives the weighted sum over the directions; a cell's power already includes its solid angle.
    scratch.rows.clear();
    scratch.gains.clear();
    for (const FieldOfView::Weight& w : heard) {
      scratch.rows.push_back(row_of(w).power.data());
      scratch.gains.push_back(w.gain);
    }
    sum_rows(scratch.rows.data(), scratch.gains.data(), static_cast<int>(heard.size()), image.bins,
             image.rough.data() + start);
    // Only echoes above the background get a label.
    scratch.rows.clear();
    scratch.gains.clear();
    scratch.loud.clear();
    for (const FieldOfView::Weight& w : heard) {
      if (w.gain * row_of(w).loudest < 5 * static_cast<float>(floor)) continue;
      scratch.rows.push_back(row_of(w).strongest.data());
      scratch.gains.push_back(w.gain);
      scratch.loud.push_back(w);
    }
    find_loudest(scratch.rows.data(), scratch.gains.data(), static_cast<int>(scratch.loud.size()), image.bins,
                 image.strongest.data() + start, scratch.from.data());
    for (int k = 0; k < image.bins; ++k) {
      const std::int32_t i = scratch.from[static_cast<std::size_t>(k)];
      EchoLabel& label = image.labels[start + static_cast<std::size_t>(k)];
      label = {};
      if (i < 0) continue;
      const FieldOfView::Weight& w = scratch.loud[static_cast<std::size_t>(i)];
      label = heard_as(row_of(w).labels[static_cast<std::size_t>(k)], w.gain);
    }
    std::fill_n(image.steady.begin() + static_cast<std::ptrdiff_t>(start), image.bins, 0.f);
    for (std::size_t i = 0; i < points.size();) i = hear_body(i, beam, image, scratch);
  }

  /// Adds the points of one body by one path, from index `first`; returns the index where the next body begins.
  std::size_t hear_body(std::size_t first, int beam, EchoImage& image, Scratch& scratch) const {
    const EchoLabel label = points[first].label;
    std::size_t end = first;
    double loudest = 0, near = 1e30, far = 0;
    for (; end < points.size() && points[end].label == label; ++end) {
      const double gain =
          view.across.gain(std::remainder(points[end].azimuth - view.beams[static_cast<std::size_t>(beam)], 2 * kPi));
      loudest = std::max(loudest, gain);
      near = std::min(near, points[end].span.near);
      far = std::max(far, points[end].span.far);
    }
    const double margin = std::max(config.resolution_m, 2 * bin_m());
    const int low = std::max(0, static_cast<int>((near - margin) / bin_m()));
    const int high = std::min(config.bins - 1, static_cast<int>((far + margin) / bin_m()));
    if (loudest < kLeastGain || low > high) return end;
    std::fill(scratch.power.begin() + low, scratch.power.begin() + high + 1, 0.f);
    std::fill(scratch.strongest.begin() + low, scratch.strongest.begin() + high + 1, 0.f);
    for (std::size_t i = first; i < end; ++i) {
      const double gain =
          view.across.gain(std::remainder(points[i].azimuth - view.beams[static_cast<std::size_t>(beam)], 2 * kPi));
      if (gain * points[i].power < 1e-4 * floor) continue;
      deposit(scratch.power.data(), scratch.strongest.data(), scratch.labels.data(), points[i].span,
              gain * points[i].power, label);
    }
    const std::size_t start = static_cast<std::size_t>(beam) * static_cast<std::size_t>(image.bins);
    for (int k = low; k <= high; ++k) {
      const std::size_t at = start + static_cast<std::size_t>(k);
      const float power = scratch.power[static_cast<std::size_t>(k)];
      image.steady[at] += power;
      if (power <= image.strongest[at]) continue;
      image.strongest[at] = power;
      image.labels[at] = heard_as(label, static_cast<float>(loudest));
    }
    return end;
  }

  static EchoLabel heard_as(EchoLabel label, float gain) {
    return gain < 0.1f && label.path() == EchoPath::kDirect ? EchoLabel(label.target(), EchoPath::kSideLobe) : label;
  }
};

EchoSynthesizer::EchoSynthesizer(const SonarConfig& config, const World& world, const Water& water, int threads)
    : state_(std::make_unique<State>(config, world, water, threads)) {}
EchoSynthesizer::~EchoSynthesizer() = default;
EchoSynthesizer::EchoSynthesizer(EchoSynthesizer&&) noexcept = default;
EchoSynthesizer& EchoSynthesizer::operator=(EchoSynthesizer&&) noexcept = default;

const std::vector<double>& EchoSynthesizer::beam_azimuths() const { return state_->view.beams; }
void EchoSynthesizer::set_floor(double power, std::vector<float> by_bin) {
  state_->floor = power;
  if (!by_bin.empty()) state_->by_bin = std::move(by_bin);
}

void EchoSynthesizer::form(const Pose& X_WS, EchoImage& image) {
  State& s = *state_;
  s.X_WS = X_WS;
  s.R_WS = X_WS.rotation.matrix();
  s.absorb = s.water.absorption_db(s.config.frequency, std::max(0.0, X_WS.translation.z())) * std::log(10.0) / 10;
  image.resize(static_cast<int>(s.view.beams.size()), s.config.bins);
  for (int k = 0; k < s.config.bins; ++k) {
    s.back_from[static_cast<std::size_t>(k)] = s.attenuation(2 * ((k + 0.5) * s.bin_m()));
  }
  s.look_at_small_bodies();
  split_work(static_cast<int>(s.view.directions.size()), s.threads, [&s](int first, int last) {
    for (int d = first; d < last; ++d) s.look(d);
  });
  split_work(image.beams, s.threads, [&s, &image](int first, int last) {
    State::Scratch scratch(image.bins);
    for (int b = first; b < last; ++b) s.gather(b, image, scratch);
  });
}

}  // namespace isobath

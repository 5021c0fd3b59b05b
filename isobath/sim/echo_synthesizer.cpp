#include <algorithm>
#include <cmath>
#include <isobath/base/split_work.hpp>
#include <isobath/sim/echo_columns.hpp>
#include <isobath/sim/echo_paths.hpp>
#include <isobath/sim/echo_synthesizer.hpp>
#include <isobath/sim/fan_loops.hpp>
#include <isobath/sim/small_bodies.hpp>
#include <numbers>

namespace isobath {
namespace {

constexpr double kMinGain = 3e-5;  ///< gain of a receive beam below which an echo is ignored

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
  EchoPaths paths;
  int threads;
  std::vector<float> by_bin;          ///< gain of the receiver, 1 at its largest
  std::vector<double> back_from;      ///< two-way attenuation of each bin
  std::vector<EchoColumn> columns;    ///< by direction
  std::vector<BodyEcho> body_echoes;  ///< of small bodies

  State(const SonarConfig& c, const World& w, const Water& wa, int t)
      : paths(c, w, wa),
        threads(t),
        by_bin(static_cast<std::size_t>(c.bins), 1.f),
        back_from(by_bin.size()),
        columns(paths.view.directions.size(), EchoColumn(c.bins)) {}

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
    const auto& heard = paths.view.weights[static_cast<std::size_t>(beam)];
    const auto row_of = [this](const FieldOfView::Weight& w) -> const EchoColumn& {
      return columns[static_cast<std::size_t>(w.direction)];
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
      if (w.gain * row_of(w).loudest < 5 * static_cast<float>(paths.floor)) continue;
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
    for (std::size_t i = 0; i < body_echoes.size();) i = hear_body(i, beam, image, scratch);
  }

  /// Adds the body_echoes of one body by one path, from index `first`; returns the index where the next body begins.
  std::size_t hear_body(std::size_t first, int beam, EchoImage& image, Scratch& scratch) const {
    const EchoLabel label = body_echoes[first].echo.label;
    std::size_t end = first;
    double loudest = 0, near = 1e30, far = 0;
    for (; end < body_echoes.size() && body_echoes[end].echo.label == label; ++end) {
      const double gain = paths.view.across.gain(std::remainder(
          body_echoes[end].azimuth - paths.view.beams[static_cast<std::size_t>(beam)], 2 * std::numbers::pi));
      loudest = std::max(loudest, gain);
      near = std::min(near, body_echoes[end].echo.span.near);
      far = std::max(far, body_echoes[end].echo.span.far);
    }
    const double margin = std::max(paths.config.resolution_m, 2 * paths.bin_m());
    const int low = std::max(0, static_cast<int>((near - margin) / paths.bin_m()));
    const int high = std::min(paths.config.bins - 1, static_cast<int>((far + margin) / paths.bin_m()));
    if (loudest < kMinGain || low > high) return end;
    std::fill(scratch.power.begin() + low, scratch.power.begin() + high + 1, 0.f);
    std::fill(scratch.strongest.begin() + low, scratch.strongest.begin() + high + 1, 0.f);
    for (std::size_t i = first; i < end; ++i) {
      const double gain = paths.view.across.gain(std::remainder(
          body_echoes[i].azimuth - paths.view.beams[static_cast<std::size_t>(beam)], 2 * std::numbers::pi));
      if (gain * body_echoes[i].echo.power < 1e-4 * paths.floor) continue;
      PathEcho heard = body_echoes[i].echo;
      heard.power = gain * heard.power;
      deposit_echo(paths, heard, scratch.power.data(), scratch.strongest.data(), scratch.labels.data());
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

const std::vector<double>& EchoSynthesizer::beam_azimuths() const { return state_->paths.view.beams; }
void EchoSynthesizer::set_floor(double power, std::vector<float> by_bin) {
  state_->paths.floor = power;
  if (!by_bin.empty()) state_->by_bin = std::move(by_bin);
}

void EchoSynthesizer::form(const Pose& X_WS, EchoImage& image) {
  State& s = *state_;
  s.paths.begin_ping(X_WS);
  const int bins = s.paths.config.bins;
  image.resize(static_cast<int>(s.paths.view.beams.size()), bins);
  for (int k = 0; k < bins; ++k) {
    s.back_from[static_cast<std::size_t>(k)] = s.paths.attenuation(2 * ((k + 0.5) * s.paths.bin_m()));
  }
  trace_small_bodies(s.paths, s.body_echoes);
  split_work(static_cast<int>(s.columns.size()), s.threads, [&s](int first, int last) {
    for (int d = first; d < last; ++d) {
      fill_column(s.paths, d, s.back_from, s.by_bin, s.columns[static_cast<std::size_t>(d)]);
    }
  });
  split_work(image.beams, s.threads, [&s, &image](int first, int last) {
    State::Scratch scratch(image.bins);
    for (int b = first; b < last; ++b) s.gather(b, image, scratch);
  });
}

}  // namespace isobath

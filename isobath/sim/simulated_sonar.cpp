#include <algorithm>
#include <cmath>
#include <isobath/base/log_gamma.hpp>
#include <isobath/base/split_work.hpp>
#include <isobath/sim/fan_loops.hpp>
#include <isobath/sim/simulated_sonar.hpp>
#include <limits>
#include <numbers>

namespace isobath {
namespace {

constexpr double kRayleighSpread = 0.5227;  // standard deviation over mean
constexpr double kRayleighMean = 1.2533;    // mean over scale, sqrt(pi / 2)

constexpr double kFullScale = 255;  // counts: the scale of all computations before the samples are packed
double full_scale_of(SampleType type) { return type == SampleType::kU16 ? 65535 : kFullScale; }

/// y at x from rows {x, y}, linear between rows; 1 without rows.
double factor_at(const std::vector<double>& rows, double x) {
  if (rows.size() < 4) return 1;
  if (x <= rows[0]) return rows[1];
  for (std::size_t i = 2; i + 1 < rows.size(); i += 2) {
    if (x <= rows[i]) return rows[i - 1] + (rows[i + 1] - rows[i - 1]) * (x - rows[i - 2]) / (rows[i] - rows[i - 2]);
  }
  return rows.back();
}

/// (0, 1]
double positive_uniform(Random& random) { return 1 - random.uniform(); }

template <class Sample>
std::shared_ptr<const void> packed(const std::vector<float>& values, double full, const void** data) {
  auto out = std::make_shared<std::vector<Sample>>(values.size());
  std::transform(values.begin(), values.end(), out->begin(), [full](float v) {
    if constexpr (std::is_floating_point_v<Sample>) return v;
    return static_cast<Sample>(std::clamp(static_cast<double>(v) * (full / kFullScale) + 0.5, 0.0, full));
  });
  *data = out->data();
  return out;
}

}  // namespace

double unit_mean_gamma(Random& random, double shape) {
  if (shape < 1) {
    const double u = positive_uniform(random);
    return unit_mean_gamma(random, shape + 1) * (shape + 1) / shape * std::pow(u, 1 / shape);
  }
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double x = random.normal(), v = std::pow(1 + c * x, 3);
    if (v > 0 && std::log(positive_uniform(random)) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v / shape;
  }
}

SimulatedSonar::SimulatedSonar(const SonarConfig& config, const World& world, const Water& water, std::uint64_t seed,
                               int threads)
    : config_(config),
      world_(&world),
      water_(&water),
      former_(config, world, water, threads),
      seed_(seed),
      threads_(threads),
      full_scale_(full_scale_of(config.samples)),
      audible_(
          std::max(config.black_level, config.span_db > 0 ? kFullScale * std::pow(10, -config.span_db / 20) : 0.5)) {
  const double bin = config.range_m / config.bins;
  const double absorption = water.absorption_db(config.frequency, 0);
  for (int k = 0; k < config.bins; ++k) {
    const double r = (k + 0.5) * bin;
    const double tvg =
        config.tvg_spreading * std::log10(std::max(r, 1e-3)) + (config.tvg_absorption ? 2 * absorption * r : 0);
    gain_.push_back(kFullScale * std::pow(10, (config.source_level_db + tvg - config.saturation_db) / 20));
    power_gain_.push_back(gain_.back() * gain_.back());
    noise_by_bin_.push_back(factor_at(config.noise_by_range, r));
    const double mean = config.reverberation.empty() ? 0 : factor_at(config.reverberation, r);
    reverberation_.push_back(4 / std::numbers::pi * mean * mean);  // power of a Rayleigh amplitude, counts^2
  }
  const double most = *std::max_element(gain_.begin(), gain_.end());
  std::vector<float> by_bin;
  for (const double gain : gain_) by_bin.push_back(static_cast<float>((gain / most) * (gain / most)));
  former_.set_floor(std::pow(0.1 * std::max(config.noise_level, 1.0) / most, 2), std::move(by_bin));
  const double v = config.noise_shape;  // the mean of the square root of the texture is not one
  k_root_ = std::exp(log_gamma(v + 0.5) - log_gamma(v)) / std::sqrt(v);
  BeamFan fan;
  fan.height = config.height;
  for (const double azimuth : former_.beam_azimuths()) {
    fan.azimuth.push_back(Angle::radians(azimuth));
    fan.width.push_back(config.width);
    noise_by_beam_.push_back(factor_at(config.noise_by_bearing, azimuth * 180 / std::numbers::pi));
  }
  if (config.kind == SonarKind::kFan && config.correlated) {
    fluctuations_.emplace(config, water.config().wind, random_at(seed, ~0ull, 0).bits());
  }
  if (config.kind != SonarKind::kScanning) {
    fans_.push_back(std::make_shared<const BeamFan>(std::move(fan)));
    return;
  }
  const double sector = config.sector.degrees(), step = config.step.degrees();
  const bool whole = sector > 360 - 0.5 * step;
  const int steps = whole ? static_cast<int>(std::lround(sector / step))
                          : static_cast<int>(std::floor(sector / step + 1e-6)) + 1;  // no step outside the sector
  for (int i = 0; i < steps; ++i) {
    fan.azimuth[0] = config.middle + Angle::degrees(whole ? i * step : (i - 0.5 * (steps - 1)) * step);
    fans_.push_back(std::make_shared<const BeamFan>(fan));
  }
}

Duration SimulatedSonar::interval() const { return seconds(ping_interval_s(config_)); }

Angle SimulatedSonar::head_azimuth(std::uint64_t number) const {
  const std::uint64_t steps = fans_.size();
  if (steps == 1) return fans_[0]->azimuth[0];
  const bool whole = config_.sector.degrees() > 360 - 0.5 * config_.step.degrees();
  if (whole) return fans_[number % steps]->azimuth[0];
  const std::uint64_t cycle = number % (2 * steps - 2);  // forth and back, each end once
  return fans_[cycle < steps ? cycle : 2 * steps - 2 - cycle]->azimuth[0];
}

SimulatedSonar::Disturbances SimulatedSonar::draw(Random random) const {
  Disturbances now;
  const int beams = static_cast<int>(former_.beam_azimuths().size());
  const auto any = [&random](int count) { return static_cast<int>(random.index(static_cast<std::uint64_t>(count))); };
  const int blind =
      std::min(config_.bins - 1, static_cast<int>(std::ceil(config_.blanking_m / config_.range_m * config_.bins)));
  if (random.uniform() < config_.spurious_share) {
    now.spurious_beam = any(beams);
    now.spurious_bin = blind + any(config_.bins - blind);
  }
  if (random.uniform() < config_.streak_share) now.streak = any(beams);
  if (random.uniform() < config_.ring_share) now.ring = any(config_.bins);
  now.burst = random.uniform() < config_.burst_share;
  return now;
}

/// One sample: the background plus a fluctuating echo (mean power, counts^2) and a steady echo (amplitude). Speckle and
/// a Rayleigh or K background are sums of many small waves, and so is their sum (Goodman 1975).
double SimulatedSonar::sample(Random& random, double mean, double fluctuating, double steady) const {
  const bool envelope = config_.noise == BackgroundLaw::kRayleigh || config_.noise == BackgroundLaw::kK;
  if (!envelope) {
    const double power = fluctuating > 0 ? -fluctuating * std::log(positive_uniform(random)) : 0;
    const double amplitude = power > 0 ? std::sqrt(steady * steady + power) : steady;
    if (config_.noise == BackgroundLaw::kNone) return amplitude;
    const double share = config_.noise_level > 0 ? mean / config_.noise_level : 1;
    return mean + config_.noise_sigma * share * random.normal() + amplitude;
  }
  double noise = 2 * mean * mean / (kRayleighMean * kRayleighMean);
  if (config_.noise == BackgroundLaw::kK) noise *= unit_mean_gamma(random, config_.noise_shape) / (k_root_ * k_root_);
  const double power = noise + fluctuating;
  if (steady <= 0) return std::sqrt(-power * std::log(positive_uniform(random)));
  // A circular Gaussian number by Marsaglia's polar method, with the steady echo along its real axis.
  double x = 0, y = 0, q = 2;
  while (q >= 1 || q == 0) {
    x = 2 * random.uniform() - 1;
    y = 2 * random.uniform() - 1;
    q = x * x + y * y;
  }
  const double scale = std::sqrt(-power * std::log(q) / q);
  return std::hypot(steady + scale * x, scale * y);
}

/// The same with the random fields of `shared`: background and speckle are separate waves, which add up.
double SimulatedSonar::sample(const FanFluctuations::Row& shared, std::size_t bin, double mean, double fluctuating,
                              double steady) const {
  const double noise_re = static_cast<double>(shared.noise_re[bin]);
  const double speckle_re = static_cast<double>(shared.speckle_re[bin]);
  const double speckle_im = static_cast<double>(shared.speckle_im[bin]);
  if (config_.noise == BackgroundLaw::kNone || config_.noise == BackgroundLaw::kGaussian) {
    const double power = fluctuating * (speckle_re * speckle_re + speckle_im * speckle_im);
    const double amplitude = std::sqrt(steady * steady + power);
    if (config_.noise == BackgroundLaw::kNone) return amplitude;
    const double share = config_.noise_level > 0 ? mean / config_.noise_level : 1;
    return mean + config_.noise_sigma * share * std::numbers::sqrt2 * noise_re + amplitude;
  }
  double noise = 2 * mean * mean / (kRayleighMean * kRayleighMean);
  if (config_.noise == BackgroundLaw::kK) noise *= static_cast<double>(shared.texture[bin]) / (k_root_ * k_root_);
  const double of_noise = std::sqrt(noise), of_speckle = std::sqrt(fluctuating);
  const double x = steady + of_noise * noise_re + of_speckle * speckle_re;
  const double y = of_noise * static_cast<double>(shared.noise_im[bin]) + of_speckle * speckle_im;
  return std::sqrt(x * x + y * y);
}

double SimulatedSonar::received(double amplitude) const {
  double sample = std::max(amplitude - config_.black_level, 0.0);
  if (config_.span_db > 0) {
    sample = sample > 0 ? kFullScale * (1 + 20 * std::log10(sample / kFullScale) / config_.span_db) : 0;
  }
  return std::clamp(sample, 0.0, config_.ceiling > 0 ? config_.ceiling : std::numeric_limits<double>::infinity());
}

void SimulatedSonar::fill(int beam, Random random, Random speckle, const FanFluctuations::Row* shared,
                          const Disturbances& now, std::vector<double>& amplitudes, float* samples,
                          EchoLabel* labels) const {
  const bool envelope = config_.noise == BackgroundLaw::kRayleigh || config_.noise == BackgroundLaw::kK;
  const bool quiet = !now.burst && beam != now.streak && now.ring < 0 && beam != now.spurious_beam;
  int done = 0;
  if (shared && envelope && quiet && !(config_.still && config_.speckle)) {
    done = fill_fast(beam, *shared, amplitudes, samples, labels);
  }
  const auto fill_one = [&](int k) { fill_bin(beam, k, random, speckle, shared, now, samples[k], labels[k]); };
  int k = 0;  // the transmit pulse rings in the first bins
  for (; k < config_.bins && (k + 0.5) * (config_.range_m / config_.bins) < config_.blanking_m; ++k) fill_one(k);
  for (k = std::max(k, done); k < config_.bins; ++k) fill_one(k);
}

/// Fills most bins of a fan's beam that has no disturbances, with the result of fill_bin but vectorised. Returns how
/// many bins it has filled, from the first.
int SimulatedSonar::fill_fast(int beam, const FanFluctuations::Row& shared, std::vector<double>& amplitudes,
                              float* samples, EchoLabel* labels) const {
  const std::size_t start = static_cast<std::size_t>(beam) * static_cast<std::size_t>(config_.bins);
  FanWaves waves;
  waves.noise_re = shared.noise_re.data();
  waves.noise_im = shared.noise_im.data();
  waves.speckle_re = shared.speckle_re.data();
  waves.speckle_im = shared.speckle_im.data();
  waves.texture = config_.noise == BackgroundLaw::kK ? shared.texture.data() : nullptr;
  waves.rough = image_.rough.data() + start;
  waves.steady = image_.steady.data() + start;
  waves.gain = power_gain_.data();
  waves.diffuse = reverberation_.data();
  waves.noise = noise_by_bin_.data();
  waves.level = config_.noise_level * noise_by_beam_[static_cast<std::size_t>(beam)];
  waves.texture_share = k_root_ * k_root_;
  waves.mean_square = kRayleighMean * kRayleighMean;
  waves.speckle = config_.speckle;
  waves.strongest = image_.strongest.data() + start;
  waves.labels = image_.labels.data() + start;
  waves.spread = kRayleighSpread;
  waves.audible = audible_;
  amplitudes.resize(static_cast<std::size_t>(config_.bins));
  const int done = add_waves(waves, config_.bins, amplitudes.data(), labels);
  const double* amplitude = amplitudes.data();
  if (config_.span_db > 0 || config_.ceiling > 0) {
    for (int k = 0; k < done; ++k) samples[k] = static_cast<float>(received(amplitude[k]));
  } else {
    const double black = config_.black_level;
    for (int k = 0; k < done; ++k) samples[k] = static_cast<float>(std::max(amplitude[k] - black, 0.0));
  }
  return done;
}

void SimulatedSonar::fill_bin(int beam, int k, Random& random, Random& speckle, const FanFluctuations::Row* shared,
                              const Disturbances& now, float& sample_out, EchoLabel& label) const {
  const std::size_t at =
      static_cast<std::size_t>(beam) * static_cast<std::size_t>(config_.bins) + static_cast<std::size_t>(k);
  const double level = config_.noise_level * noise_by_beam_[static_cast<std::size_t>(beam)];
  const double mean = level * noise_by_bin_[static_cast<std::size_t>(k)];
  const double gain2 = power_gain_[static_cast<std::size_t>(k)];
  const double negligible = 1e-4 * mean * mean;  // power, counts^2
  const double diffuse = reverberation_[static_cast<std::size_t>(k)];
  double rough = gain2 * static_cast<double>(image_.rough[at]) + diffuse;
  double steady2 = gain2 * static_cast<double>(image_.steady[at]);
  double fluctuating = 0;
  // Still speckle: one number per bin, used or not, so that the same bin has the same number in the next turn.
  if (config_.still && config_.speckle) {
    const auto i = static_cast<std::size_t>(k);
    rough *= shared ? static_cast<double>(shared->speckle_re[i] * shared->speckle_re[i] +
                                          shared->speckle_im[i] * shared->speckle_im[i])
                    : -std::log(positive_uniform(speckle));
  }
  (config_.speckle && !config_.still ? fluctuating : steady2) += rough;
  double steady = steady2 > negligible ? std::sqrt(steady2) : 0;
  const double spread = config_.noise == BackgroundLaw::kGaussian ? config_.noise_sigma
                        : config_.noise == BackgroundLaw::kNone   ? 0
                                                                  : kRayleighSpread * mean;
  double strongest2 = gain2 * static_cast<double>(image_.strongest[at]);
  const double least = std::max(spread, audible_);
  label = strongest2 > std::max(least * least, diffuse) ? image_.labels[at] : EchoLabel();
  const auto disturb = [&](double amplitude, EchoPath path) {
    steady += amplitude;
    if (amplitude * amplitude <= std::max(strongest2, spread * spread)) return;
    label = EchoLabel(kNothing, path);
    strongest2 = amplitude * amplitude;
  };
  if (beam == now.spurious_beam && k == now.spurious_bin) disturb(config_.spurious_level, EchoPath::kSpurious);
  if (beam == now.streak || k == now.ring || now.burst) {
    disturb(config_.disturbance_level * (0.5 + random.uniform()), EchoPath::kDisturbance);
  }
  const double r = (k + 0.5) * (config_.range_m / config_.bins);
  if (r < config_.blanking_m)
    disturb(config_.ringing_level * std::exp(-3 * r / config_.blanking_m), EchoPath::kRinging);
  if (fluctuating <= negligible) fluctuating = 0;
  const double amplitude = shared ? sample(*shared, static_cast<std::size_t>(k), mean, fluctuating, steady)
                                  : sample(random, mean, fluctuating, steady);
  sample_out = static_cast<float>(received(amplitude));
}

void SimulatedSonar::command(const ScanCommand& command) {
  *this = SimulatedSonar(commanded(config_, command), *world_, *water_, seed_, threads_);
  restarts_ = true;
}

SimulatedSonar::Output SimulatedSonar::ping(Time time, const Pose& X_WB, std::uint64_t number) {
  if (restarts_) first_number_ = number;
  restarts_ = false;
  Output out;
  Random chance = random_at(seed_, number, 0);
  if (chance.uniform() < config_.dropout_share) return out;
  const Pose X_BS = sensor_pose(config_);
  const bool scanning = config_.kind == SonarKind::kScanning;
  const Angle head = scanning ? head_azimuth(number - first_number_) : Angle{};
  if (scanning) noise_by_beam_[0] = factor_at(config_.noise_by_bearing, head.degrees());
  former_.form(X_WB * X_BS * Pose{Rotation::from_heading(head), {0, 0, 0}}, image_);

  out.truth = {time, config_.name, image_.beams, image_.bins, {}};
  out.truth.labels.resize(image_.labels.size());
  samples_.resize(image_.labels.size());
  const Disturbances now = draw(chance);
  const auto direction = static_cast<std::uint64_t>(std::llround(head.wrapped_positive().radians() * 1e6));
  if (fluctuations_) fluctuations_->advance(number, time, X_WB * X_BS, image_, threads_);
  split_work(image_.beams, threads_, [&](int first, int last) {
    FanFluctuations::Row shared;
    std::vector<double> amplitudes;
    for (int b = first; b < last; ++b) {
      if (fluctuations_) fluctuations_->read(b, shared);
      const std::size_t start = static_cast<std::size_t>(b) * static_cast<std::size_t>(image_.bins);
      const auto stream = static_cast<std::uint64_t>(b) + 1;
      fill(b, random_at(seed_, number, stream), random_at(~seed_, direction, stream), fluctuations_ ? &shared : nullptr,
           now, amplitudes, samples_.data() + start, out.truth.labels.data() + start);
    }
  });

  Ping ping;
  ping.time = time;
  ping.fan = fans_[0];
  for (const auto& fan : fans_) {
    if (scanning && fan->azimuth[0].radians() == head.radians()) ping.fan = fan;
  }
  ping.window = {0, config_.range_m / config_.bins, config_.bins};
  const void* data = nullptr;
  switch (config_.samples) {
    case SampleType::kU8: ping.storage = packed<std::uint8_t>(samples_, full_scale_, &data); break;
    case SampleType::kU16: ping.storage = packed<std::uint16_t>(samples_, full_scale_, &data); break;
    case SampleType::kF32: ping.storage = packed<float>(samples_, full_scale_, &data); break;
  }
  const std::ptrdiff_t size = config_.samples == SampleType::kU8 ? 1 : config_.samples == SampleType::kU16 ? 2 : 4;
  ping.intensity = {data, config_.samples, image_.beams, image_.bins, size * image_.bins, size};
  ping.X_BS = X_BS;
  ping.sound_speed = config_.sound_speed;
  ping.full_scale = static_cast<float>(full_scale_);
  ping.blanking_m = config_.blanking_m;
  if (config_.kind == SonarKind::kRanges) {
    pick_ranges(ping, out);
  } else {
    out.ping = std::move(ping);
  }
  return out;
}

void SimulatedSonar::pick_ranges(const Ping& ping, Output& out) const {
  const int blind = static_cast<int>(std::ceil(config_.blanking_m / ping.window.bin_m));
  for (int b = 0; b < ping.fan->beams(); ++b) {
    // Uses samples before clipping: the strongest of many saturated samples would be the nearest of them.
    const float* level = samples_.data() + static_cast<std::size_t>(b) * static_cast<std::size_t>(ping.window.bins);
    int best = -1;
    for (int k = blind; k < ping.window.bins; ++k) {
      if (static_cast<double>(level[k]) < config_.pick_level) continue;
      if (best < 0 || (config_.pick == RangePick::kStrongest && level[k] > level[best])) best = k;
      if (config_.pick == RangePick::kNearest) break;
    }
    RangeReading reading;
    reading.time = ping.time;
    reading.max_range_m = config_.range_m;
    reading.width = Angle::radians(std::max(config_.width.radians(), config_.height.radians()));
    reading.X_BS = ping.X_BS * Pose{Rotation::from_heading(ping.fan->azimuth[static_cast<std::size_t>(b)]), {0, 0, 0}};
    if (best >= 0) {
      reading.range_m = ping.window.centre(best);
      reading.confidence = std::min(1.f, level[best] / static_cast<float>(kFullScale));
    }
    out.ranges.push_back(reading);
  }
}

}  // namespace isobath

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "isobath/sim/fan_loops.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which includes this file once per instruction set.
#include <hwy/highway.h>
#include <isobath/sim/fan_loops.hpp>

HWY_BEFORE_NAMESPACE();
namespace isobath::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

static_assert(sizeof(EchoLabel) == sizeof(std::uint16_t), "labels are read and written as their codes");

using Floats = hn::ScalableTag<float>;
using Doubles = hn::CappedTag<double, kLoopPad>;
using HalfFloats = hn::Rebind<float, Doubles>;

HWY_ATTR void sum_rows(const float* const* rows, const float* weights, int count, int size, float* out) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d)), four = 4 * lanes;
  int done = 0;
  if (size >= four) {
    while (done < size) {
      const int k = std::min(done, size - four);  // the last block overlaps the one before
      auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
      for (int i = 0; i < count; ++i) {
        const float* row = rows[i] + k;
        const auto w = hn::Set(d, weights[i]);
        s0 = hn::Add(s0, hn::Mul(w, hn::LoadU(d, row)));
        s1 = hn::Add(s1, hn::Mul(w, hn::LoadU(d, row + lanes)));
        s2 = hn::Add(s2, hn::Mul(w, hn::LoadU(d, row + 2 * lanes)));
        s3 = hn::Add(s3, hn::Mul(w, hn::LoadU(d, row + 3 * lanes)));
      }
      hn::StoreU(s0, d, out + k);
      hn::StoreU(s1, d, out + k + lanes);
      hn::StoreU(s2, d, out + k + 2 * lanes);
      hn::StoreU(s3, d, out + k + 3 * lanes);
      done = k + four;
    }
  }
  for (int k = done; k < size; ++k) {
    float sum = 0;
    for (int i = 0; i < count; ++i) sum += weights[i] * rows[i][k];
    out[k] = sum;
  }
}

HWY_ATTR void find_loudest(const float* const* rows, const float* weights, int count, int size, float* loudest,
                           std::int32_t* which) {
  const Floats d;
  const hn::RebindToSigned<Floats> di;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int k = 0;
  for (; k + lanes <= size; k += lanes) {
    auto most = hn::Zero(d);
    auto from = hn::Set(di, -1);
    for (int i = 0; i < count; ++i) {
      const auto value = hn::Mul(hn::Set(d, weights[i]), hn::LoadU(d, rows[i] + k));
      from = hn::IfThenElse(hn::RebindMask(di, hn::Gt(value, most)), hn::Set(di, i), from);
      most = hn::Max(most, value);
    }
    hn::StoreU(most, d, loudest + k);
    hn::StoreU(from, di, which + k);
  }
  for (; k < size; ++k) {
    loudest[k] = 0;
    which[k] = -1;
    for (int i = 0; i < count; ++i) {
      const float value = weights[i] * rows[i][k];
      if (value <= loudest[k]) continue;
      loudest[k] = value;
      which[k] = i;
    }
  }
}

HWY_ATTR float largest_product(const float* a, const float* b, int size) {
  const Floats d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  auto most = hn::Zero(d);
  int k = 0;
  for (; k + lanes <= size; k += lanes) most = hn::Max(most, hn::Mul(hn::LoadU(d, a + k), hn::LoadU(d, b + k)));
  float largest = hn::GetLane(hn::MaxOfLanes(d, most));
  for (; k < size; ++k) largest = std::max(largest, a[k] * b[k]);
  return largest;
}

/// Several loops, so that compilers vectorise them.
HWY_ATTR void draw_normals(std::uint64_t seed, float* re, float* im, int count) {
  constexpr int kBlock = 256;
  constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;  // splitmix64, as in Random
  alignas(64) std::int32_t power_bits[kBlock], phase_bits[kBlock];
  alignas(64) float r[kBlock];
  const Floats d;
  for (int first = 0; first < count; first += kBlock) {
    const int n = std::min(kBlock, count - first);
    for (int i = 0; i < kBlock; ++i) {
      std::uint64_t z = seed + static_cast<std::uint64_t>(first + i + 1) * kStep;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      z ^= z >> 31;
      power_bits[i] = static_cast<std::int32_t>(z >> 33);
      phase_bits[i] = static_cast<std::int32_t>(z & 0x7fffffff);
    }
    // -ln u, u = m 2^e in (0, 1], m in [1/sqrt 2, sqrt 2]: the series of the area tangent.
    for (int i = 0; i < kBlock; ++i) {
      const float u = (static_cast<float>(power_bits[i]) + 0.5f) * 0x1.0p-31f;
      const std::int32_t word = std::bit_cast<std::int32_t>(u) - 0x3f3504f3;
      const auto exponent = static_cast<float>(word >> 23);
      const float m = std::bit_cast<float>((word & 0x7fffff) + 0x3f3504f3);
      const float s = (m - 1) / (m + 1), s2 = s * s;
      const float log_m = 2 * s * (1 + s2 * (1.f / 3 + s2 * (1.f / 5 + s2 * (1.f / 7 + s2 * (1.f / 9)))));
      const float power = -(exponent * std::numbers::ln2_v<float> + log_m);
      r[i] = power > 0 ? power : 0;
    }
    for (int i = 0; i < kBlock; i += static_cast<int>(hn::Lanes(d))) {
      hn::StoreU(hn::Sqrt(hn::LoadU(d, r + i)), d, r + i);
    }
    // Phase: quarters of a turn of 2^31, and t in [-pi/4, pi/4) beyond them.
    for (int i = 0; i < n; ++i) {
      const std::int32_t quarter = ((phase_bits[i] >> 28) + 1) >> 1;
      const std::uint32_t rest =
          static_cast<std::uint32_t>(phase_bits[i]) - (static_cast<std::uint32_t>(quarter) << 29);
      const float t = static_cast<float>(static_cast<std::int32_t>(rest)) * (std::numbers::pi_v<float> * 0x1.0p-30f);
      const float t2 = t * t;
      const float sine = t * (1 + t2 * (-1.f / 6 + t2 * (1.f / 120 + t2 * (-1.f / 5040))));
      const float cosine = 1 + t2 * (-0.5f + t2 * (1.f / 24 + t2 * (-1.f / 720 + t2 * (1.f / 40320))));
      const auto odd = static_cast<float>(quarter & 1), even = 1 - odd;
      const float signed_r = r[i] * static_cast<float>(1 - (quarter & 2));
      re[first + i] = signed_r * (even * cosine - odd * sine);
      im[first + i] = signed_r * (even * sine + odd * cosine);
    }
  }
}

HWY_ATTR void add_echo(const SpreadEcho& e, int first, int last, float* power, float* strongest,
                       EchoLabel* echo_labels) {
  auto* labels = reinterpret_cast<std::uint16_t*>(echo_labels);
  const Doubles d;
  const HalfFloats df;
  const hn::Rebind<std::int32_t, Doubles> di;
  const hn::Rebind<std::uint16_t, Doubles> du;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0), half = hn::Set(d, 0.5);
  const auto near = hn::Set(d, e.near), far = hn::Set(d, e.far), middle = hn::Set(d, e.middle);
  const auto slope = hn::Set(d, e.slope), height = hn::Set(d, e.power);
  const auto label = hn::Set(di, e.label.code());
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int k = first; k <= last; k += lanes) {  // lanes beyond the last bin have no share
    const auto at = hn::Iota(d, static_cast<double>(k));
    const auto share = hn::Max(hn::Sub(hn::Min(far, hn::Add(at, one)), hn::Max(near, at)), zero);
    // Not below 0: processors differ in which zero is the larger one, and no echo has a negative power.
    const auto lean = hn::Max(hn::Sub(one, hn::Mul(slope, hn::Sub(hn::Add(at, half), middle))), zero);
    const auto value = hn::DemoteTo(df, hn::Mul(hn::Mul(height, share), lean));
    const auto before = hn::LoadU(df, strongest + k);
    const auto old = hn::PromoteTo(di, hn::LoadU(du, labels + k));
    const auto same = hn::RebindMask(df, hn::Eq(old, label)), louder = hn::Gt(value, before);
    hn::StoreU(hn::Add(hn::LoadU(df, power + k), value), df, power + k);
    hn::StoreU(hn::IfThenElse(same, hn::Add(before, value), hn::Max(before, value)), df, strongest + k);
    hn::StoreU(hn::DemoteTo(du, hn::IfThenElse(hn::RebindMask(di, louder), label, old)), du, labels + k);
  }
}

/// As doubles.
HWY_INLINE HWY_ATTR hn::Vec<Doubles> load(const float* at) {
  const Doubles d;
  const HalfFloats df;
  return hn::PromoteTo(d, hn::LoadU(df, at));
}

HWY_ATTR int add_waves(const FanWaves& w, int size, double* amplitude, EchoLabel* heard_labels) {
  const auto* echo_labels = reinterpret_cast<const std::uint16_t*>(w.labels);
  auto* heard = reinterpret_cast<std::uint16_t*>(heard_labels);
  const Doubles d;
  const hn::Rebind<std::int32_t, Doubles> di;
  const hn::Rebind<std::uint16_t, Doubles> du;
  const auto spread = hn::Set(d, w.spread), audible = hn::Set(d, w.audible);
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d), level = hn::Set(d, w.level), negligible_share = hn::Set(d, 1e-4);
  const auto two = hn::Set(d, 2.0), mean_square = hn::Set(d, w.mean_square), share = hn::Set(d, w.texture_share);
  int k = 0;
  for (; k + lanes <= size; k += lanes) {
    const auto mean = hn::Mul(level, hn::LoadU(d, w.noise + k)), gain = hn::LoadU(d, w.gain + k);
    const auto negligible = hn::Mul(hn::Mul(negligible_share, mean), mean);
    const auto diffuse = hn::LoadU(d, w.diffuse + k);
    const auto rough = hn::Add(hn::Mul(gain, load(w.rough + k)), diffuse);
    auto steady2 = hn::Mul(gain, load(w.steady + k));
    if (!w.speckle) steady2 = hn::Add(steady2, rough);
    const auto fluctuating = w.speckle ? hn::IfThenElseZero(hn::Gt(rough, negligible), rough) : zero;
    const auto steady = hn::Sqrt(hn::IfThenElseZero(hn::Gt(steady2, negligible), steady2));
    auto noise = hn::Div(hn::Mul(hn::Mul(two, mean), mean), mean_square);
    if (w.texture) noise = hn::Mul(noise, hn::Div(load(w.texture + k), share));
    const auto of_noise = hn::Sqrt(noise), of_speckle = hn::Sqrt(fluctuating);
    const auto x =
        hn::Add(hn::Add(steady, hn::Mul(of_noise, load(w.noise_re + k))), hn::Mul(of_speckle, load(w.speckle_re + k)));
    const auto y = hn::Add(hn::Mul(of_noise, load(w.noise_im + k)), hn::Mul(of_speckle, load(w.speckle_im + k)));
    hn::StoreU(hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y))), d, amplitude + k);
    const auto least = hn::Max(hn::Mul(spread, mean), audible);
    const auto out = hn::Gt(hn::Mul(gain, load(w.strongest + k)), hn::Max(hn::Mul(least, least), diffuse));
    const auto labels = hn::PromoteTo(d, hn::PromoteTo(di, hn::LoadU(du, echo_labels + k)));
    hn::StoreU(hn::DemoteTo(du, hn::DemoteTo(di, hn::IfThenElseZero(out, labels))), du, heard + k);
  }
  return k;
}

}  // namespace isobath::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace isobath {

HWY_EXPORT(sum_rows);
HWY_EXPORT(find_loudest);
HWY_EXPORT(largest_product);
HWY_EXPORT(draw_normals);
HWY_EXPORT(add_echo);
HWY_EXPORT(add_waves);

void sum_rows(const float* const* rows, const float* weights, int count, int size, float* out) {
  HWY_DYNAMIC_DISPATCH(sum_rows)(rows, weights, count, size, out);
}
void find_loudest(const float* const* rows, const float* weights, int count, int size, float* loudest,
                  std::int32_t* which) {
  HWY_DYNAMIC_DISPATCH(find_loudest)(rows, weights, count, size, loudest, which);
}
float largest_product(const float* a, const float* b, int size) {
  return HWY_DYNAMIC_DISPATCH(largest_product)(a, b, size);
}
void draw_normals(std::uint64_t seed, float* re, float* im, int count) {
  HWY_DYNAMIC_DISPATCH(draw_normals)(seed, re, im, count);
}
void add_echo(const SpreadEcho& echo, int first, int last, float* power, float* strongest, EchoLabel* labels) {
  HWY_DYNAMIC_DISPATCH(add_echo)(echo, first, last, power, strongest, labels);
}
int add_waves(const FanWaves& waves, int size, double* amplitude, EchoLabel* heard) {
  return HWY_DYNAMIC_DISPATCH(add_waves)(waves, size, amplitude, heard);
}

}  // namespace isobath
#endif

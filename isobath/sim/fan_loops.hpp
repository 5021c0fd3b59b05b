// Fan loops: what the simulator does to every sample of a fan, for the instruction set that the processor has.
//
// Only operations that IEEE 754 rounds exactly, in one order, and no fused ones: every instruction set gives the same.
#pragma once

#include <cstdint>
#include <isobath/sonar/echo_truth.hpp>

namespace isobath {

/// out[k] = the sum over i of weights[i] * rows[i][k], from the first row on.
void sum_rows(const float* const* rows, const float* weights, int count, int size, float* out);

/// loudest[k] = the largest weights[i] * rows[i][k], and which i that is, the first of several; 0 and -1 where none is
/// above 0.
void find_loudest(const float* const* rows, const float* weights, int count, int size, float* loudest,
                  std::int32_t* which);

float largest_product(const float* a, const float* b, int size);

/// Circular complex Gaussians of unit mean power, by Box and Muller: 31 bits each for power and phase, from the stream
/// of Random(seed). The polynomials are good to single precision.
void draw_normals(std::uint64_t seed, float* re, float* im, int count);

constexpr int kLoopPad = 16;  ///< bins behind the last that add_echo may touch

/// An echo between two places, in bins. Its power in a bin falls with `slope` a bin from `middle` on.
struct SpreadEcho {
  double near, far, middle, slope;
  double power;  ///< of a bin that it fills
  EchoLabel label;
};
/// Adds it to bins [first, last] of the power, and to what is strongest: the same label adds up, another gives way to
/// what is stronger.
void add_echo(const SpreadEcho& echo, int first, int last, float* power, float* strongest, EchoLabel* labels);

/// A beam as many small waves make it: each array has a value a bin.
struct FanWaves {
  const float *noise_re, *noise_im, *speckle_re, *speckle_im;
  const float* texture;          ///< power of the noise; null: 1
  const float *rough, *steady;   ///< mean power of what fluctuates and of what does not, before the receiver
  const double *gain, *diffuse;  ///< of the receiver, in power; power from everywhere
  const double* noise;           ///< mean amplitude of the background, before `level`
  double level, texture_share, mean_square;  ///< factors of that: of the beam, of the texture; power over mean squared
  const float* strongest;                    ///< power before the receiver
  const EchoLabel* labels;                   ///< of that
  double spread, audible;                    ///< what is heard above the noise: share of its mean; amplitude
  bool speckle;                              ///< whether what is rough fluctuates
};
/// `heard`: labels of what stands out of noise and of what comes from everywhere, else none. How many bins it did: from
/// the first on, all but the last few.
int add_waves(const FanWaves& waves, int size, double* amplitude, EchoLabel* heard);

}  // namespace isobath

// Fan loops: the inner loops of the simulator over all samples of a fan, for the instruction set of the processor.
//
// The loops use only operations that IEEE 754 rounds exactly, in one order, and no fused multiply-add. All instruction
// sets therefore give the same result.
#pragma once

#include <cstdint>
#include <isobath/sonar/echo_truth.hpp>

namespace isobath {

/// out[k] = the sum over i of weights[i] * rows[i][k], added in the order of the rows.
void sum_rows(const float* const* rows, const float* weights, int count, int size, float* out);

/// loudest[k] = the largest weights[i] * rows[i][k], which[k] = its index i (the first of equal ones); 0 and -1 if none
/// is above 0.
void find_loudest(const float* const* rows, const float* weights, int count, int size, float* loudest,
                  std::int32_t* which);

float largest_product(const float* a, const float* b, int size);

/// Circular complex Gaussians of unit mean power, by Box and Muller: 31 bits each for power and phase, taken from the
/// stream of Random(seed). The polynomials are accurate to single precision.
void draw_normals(std::uint64_t seed, float* re, float* im, int count);

constexpr int kLoopPad = 16;  ///< bins beyond the last that add_echo may write

/// An echo that is spread between two positions, in bins. Its power falls by `slope` per bin and has `power` at
/// `middle`.
struct SpreadEcho {
  double near, far, middle, slope;
  double power;  ///< power in a bin that the echo fills
  EchoLabel label;
};
/// Adds the echo to bins [first, last] of `power`. In `strongest`, an echo of the same label adds up; of two labels the
/// stronger one stays.
void add_echo(const SpreadEcho& echo, int first, int last, float* power, float* strongest, EchoLabel* labels);

/// A beam as a sum of many small waves: each array has one value per bin.
struct FanWaves {
  const float *noise_re, *noise_im, *speckle_re, *speckle_im;
  const float* texture;                      ///< power of the noise; null: 1
  const float *rough, *steady;               ///< mean power of fluctuating and of steady echoes, before the receiver
  const double *gain, *diffuse;              ///< power gain of the receiver; power of diffuse reverberation
  const double* noise;                       ///< mean amplitude of the background, before `level`
  double level, texture_share, mean_square;  ///< factor of the beam; of the texture; mean power over squared mean
  const float* strongest;                    ///< power before the receiver
  const EchoLabel* labels;                   ///< labels of `strongest`
  double spread, audible;                    ///< thresholds of a label: share of the mean noise; amplitude
  bool speckle;                              ///< whether `rough` fluctuates
};
/// `heard`: labels of echoes above noise and diffuse reverberation, else no label. Returns the number of bins that are
/// done: from the first, all but the last few.
int add_waves(const FanWaves& waves, int size, double* amplitude, EchoLabel* heard);

}  // namespace isobath

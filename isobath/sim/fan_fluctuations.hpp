// FanFluctuations: the chance in the samples of a fan, as an aperture makes it: speckle and receiver noise as complex
// Gaussian fields of unit mean power over (beam, bin), and the texture of a K background.
//
// Across beams: beams that are nearer to each other than their width hear the same scatterers, and are formed from the
// same elements. White noise over the beams goes through the amplitude pattern a of a beam, so that two beams at an
// angle d correlate as their patterns overlap, R(d) = int a(t) a(t + d) dt / int a(t)^2 dt (van Cittert and Zernike;
// Goodman 1985, 5.6). In range: through a pulse of `resolution_m` where that is longer than a bin. What does not
// overlap stays independent.
//
// From ping to ping: noise is new each time. Speckle belongs to scatterers in the water, not to samples: as the sonar
// turns by a beam or comes nearer by a bin, the field moves on by that. Besides, it is forgotten by exp(-x / (D / 2))
// as the sonar moves by x across the line of sight, D = wavelength / beam width being the length of the aperture: the
// scatterers of a cell are then in other phases. Where the strongest echo is the sea surface's, also by exp(-t / tau),
// tau = wavelength / (4 pi v), v = 0.046 wind the rms speed of its vertical motion (Pierson and Moskowitz 1964: a
// significant height of 0.21 W^2 / g, a peak at 0.88 g / W). At these wavelengths that is a few milliseconds: the sea's
// speckle is new each ping, its texture is not.
//
// Texture: Gamma of mean 1 in water that carries it, smooth over kTexture_m and kTexture_s.
//
// The field of each ping follows from the seed, the pings so far and where they were sent, on any number of threads.
// Every sample by itself has the law that independent samples would have. Not modelled: heave, which decorrelates
// scatterers at one range and several heights; motion of the surface's waves through the field.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/sim/echo_former.hpp>
#include <isobath/sim/sonar_config.hpp>
#include <vector>

namespace isobath {

inline constexpr double kTexture_m = 3, kTexture_s = 3;

class FanFluctuations {
 public:
  /// `wind` in m/s.
  FanFluctuations(const SonarConfig& config, double wind, std::uint64_t seed);

  /// Goes on to the ping of this number, sent at X_WS; `image` says which samples are the surface's.
  void advance(std::uint64_t number, Time time, const Pose& X_WS, const EchoImage& image, int threads);

  /// One beam of the ping: real and imaginary parts of both fields by bin, and the texture (empty but for a K law).
  struct Row {
    std::vector<float> noise_re, noise_im, speckle_re, speckle_im, texture;
  };
  void read(int beam, Row& row) const;

 private:
  /// White noise, rows of beams by bins, both with a margin for the filters.
  struct White {
    std::vector<float> re, im;
  };
  /// How the sonar has moved since the ping before, for one row.
  struct Passage {
    int row = -1;  ///< that the scatterers were in; outside: not heard before
    int bins = 0;  ///< that they were further away
    double keep = 0;
  };
  void follow(const Pose& X_WS);
  [[nodiscard]] Passage passage(int row) const;
  void draw_row(int row, std::uint64_t number, double surface_keep, const EchoImage& image);
  void carry_on(int row, const Passage& from, double surface_keep, const EchoImage& image);
  void filter(const std::vector<float>& white, int beam, std::vector<float>& out) const;
  void draw_texture(Time time, const Pose& X_WS);
  void read_texture(int beam, std::vector<float>& out) const;

  struct Texture {
    std::vector<float> quantiles;              ///< of the Gamma law, by normal deviate
    std::array<std::vector<double>, 2> nodes;  ///< of the time steps before and after, north by east
    double cell_m = kTexture_m, share = 0;
    int north = 0, east = 0, size = 0;  ///< first node and nodes a side
  };

  int beams_, bins_, rows_, columns_;
  double bin_m_, spacing_, first_azimuth_;
  bool still_;
  double forgets_m_, surface_forgets_s_;
  std::uint64_t noise_seed_, speckle_seed_, texture_seed_;
  std::vector<float> beam_taps_, range_taps_;
  White noise_, speckle_, speckle_before_;
  Texture texture_;

  bool begun_ = false;
  Time time_;
  Pose X_WS_;
  // In the plane of the fan, in axes that do not turn with it: so far, and the ping before.
  double turned_ = 0, turned_before_ = 0;
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero(), place_before_ = Eigen::Vector2d::Zero();
};

}  // namespace isobath

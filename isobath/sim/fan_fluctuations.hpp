// FanFluctuations: the random fields of a fan sonar's samples. Speckle and receiver noise are complex Gaussian fields
// of unit mean power over (beam, bin), with the correlation that an aperture gives them; a K background has a texture
// too.
//
// Across beams: beams closer than their width receive from the same scatterers, and are formed from the same elements.
// White noise over the beams is filtered by the amplitude pattern a of a beam, so two beams at an angle d correlate as
// their patterns overlap, R(d) = int a(t) a(t + d) dt / int a(t)^2 dt (van Cittert and Zernike; Goodman 1985, 5.6). In
// range: the field is filtered by a pulse of `resolution_m` if that is longer than a bin. Samples without overlap are
// independent.
//
// From ping to ping: noise is new in each ping. Speckle belongs to scatterers in the water, so the field moves with the
// sonar: a turn by one beam, or an approach by one bin, shifts it by one row or one bin. It decorrelates by
// exp(-x / (D / 2)) when the sonar moves by x across the line of sight, since the phases of the scatterers in a cell
// change; D = wavelength / beam width is the length of the aperture. Where the strongest echo is that of the sea
// surface, it also decorrelates by exp(-t / tau), tau = wavelength / (4 pi v), with the rms vertical speed
// v = 0.046 wind of the surface (Pierson and Moskowitz 1964: a significant height of 0.21 W^2 / g, a peak at
// 0.88 g / W). At sonar wavelengths tau is a few milliseconds: the speckle of the surface is new in each ping, its
// texture is not.
//
// Texture: Gamma of mean 1, fixed in the water and smooth over kTexture_m and kTexture_s.
//
// The field of each ping follows from the seed, the number of pings so far and their poses. It does not depend on the
// number of threads. Each sample by itself has the same distribution as an independent sample. Not modelled: heave,
// which decorrelates scatterers at one range and several heights; motion of the surface's waves through the field.
#pragma once

#include <array>
#include <cstdint>
#include <Eigen/Core>
#include <isobath/base/time.hpp>
#include <isobath/geometry/pose.hpp>
#include <isobath/sim/echo_synthesizer.hpp>
#include <isobath/sim/sonar_config.hpp>
#include <vector>

namespace isobath {

inline constexpr double kTexture_m = 3, kTexture_s = 3;

class FanFluctuations {
 public:
  /// `wind` in m/s.
  FanFluctuations(const SonarConfig& config, double wind, std::uint64_t seed);

  /// Advances to the ping of this number, sent at X_WS; `image` labels the samples of the surface.
  void advance(std::uint64_t number, Time time, const Pose& X_WS, const EchoImage& image, int threads);

  /// One beam of the ping: real and imaginary parts of both fields by bin, and the texture (empty unless K law).
  struct Row {
    std::vector<float> noise_re, noise_im, speckle_re, speckle_im, texture;
  };
  void read(int beam, Row& row) const;

 private:
  /// White noise, rows of beams by bins, both with a margin for the filters.
  struct White {
    std::vector<float> re, im;
  };
  /// The motion of the scatterers of one row since the previous ping.
  struct Passage {
    int row = -1;  ///< their row in the previous ping; -1: outside the field
    int bins = 0;  ///< how many bins farther away they were then
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
    std::vector<float> quantiles;              ///< quantiles of the Gamma law, by normal deviate
    std::array<std::vector<double>, 2> nodes;  ///< values at the time steps before and after, north by east
    double cell_m = kTexture_m, share = 0;
    int north = 0, east = 0, size = 0;  ///< first node and nodes per side
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
  // Motion in the plane of the fan, in axes that do not turn with it: at the present and at the previous ping.
  double turned_ = 0, turned_before_ = 0;
  Eigen::Vector2d place_ = Eigen::Vector2d::Zero(), place_before_ = Eigen::Vector2d::Zero();
};

}  // namespace isobath

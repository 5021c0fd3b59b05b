// Canvas: what all pictures are drawn on. Lines, areas and text in pixels, and the colours of the project, as PNG.
// Drawn by Cairo; the same input gives the same bytes. Colour-blind readers can tell the colours apart.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

using cairo_t = struct _cairo;  // NOLINT(bugprone-reserved-identifier): Cairo calls it so

namespace isobath {

struct Colour {
  double red = 0, green = 0, blue = 0, alpha = 1;
};

/// From dark blue through grey to yellow, with even steps of lightness; share in 0..1.
Colour intensity_colour(double share);
/// Unknown is grey, free blue-white, occupied dark orange. Probability in 0..1.
Colour occupancy_colour(double probability, double prior);

namespace palette {
inline constexpr Colour kPaper{1, 1, 1, 1};
inline constexpr Colour kInk{0.13, 0.14, 0.16, 1};
inline constexpr Colour kFaint{0.45, 0.47, 0.5, 0.6};
inline constexpr Colour kObstacle{0.84, 0.37, 0.0, 1};
inline constexpr Colour kHidden{0.34, 0.34, 0.6, 1};
inline constexpr Colour kTrack{0.0, 0.45, 0.7, 1};
inline constexpr Colour kTruth{0.0, 0.62, 0.45, 1};
inline constexpr Colour kVehicle{0.0, 0.62, 0.45, 1};
}  // namespace palette

struct Stroke {
  Colour colour = palette::kInk;
  double width_px = 1.5;
  bool dashed = false;
};

class Canvas {
 public:
  Canvas(int width_px, int height_px);
  /// Throws Error if the file cannot be written.
  void save(const std::filesystem::path& file) const;
  /// The bytes of the PNG file.
  [[nodiscard]] std::string png() const;

 protected:
  struct Closer {
    void operator()(cairo_t* context) const;
  };
  void text(double x_px, double y_px, const std::string& text, double size, Colour colour, double align = 0,
            bool halo = false) const;
  void line(double x0, double y0, double x1, double y1, const Stroke& stroke) const;
  void set(const Stroke& stroke) const;
  void fill(Colour colour) const;

  int width_;
  int height_;
  std::unique_ptr<cairo_t, Closer> cairo_;
};

/// Round values that divide [low, high] into about `wanted` parts.
std::vector<double> ticks(double low, double high, int wanted);

}  // namespace isobath

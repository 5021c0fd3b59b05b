#include <fmt/format.h>
#include <isobath/base/error.hpp>
#include <isobath/stereo/stereo_config.hpp>

namespace isobath {

std::vector<Field> fields(StereoConfig& c) {
  return {
      Field::integer("disparities", &c.disparities, {64, StereoConfig::kMaxDisparities}, "pixels",
                     "Number of disparities that are tried; a multiple of 64. More reach nearer, and take longer."),
      Field::integer("min_disparity", &c.min_disparity, {-256, 256}, "pixels", "Least disparity that is tried."),
      Field::integer("window", &c.window, {1, StereoConfig::kMaxWindow}, "pixels",
                     "Side of the window over which costs are averaged; odd. A larger one is smoother, and no slower."),
      Field::real("bit", &c.bit, {0, 8}, "1", "Cost of a bit of the census that differs."),
      Field::real("difference_cap", &c.difference_cap, {0, 64}, "grey levels",
                  "Largest cost of a difference of brightness; 0: brightness does not count."),
      Field::real("step_penalty", &c.step_penalty, {0, 100}, "1",
                  "Cost of a change of disparity by one from pixel to pixel; more flattens slopes."),
      Field::real("jump_penalty", &c.jump_penalty, {0, 120}, "1",
                  "Cost of a larger change of disparity; more smooths over small bodies."),
      Field::real("jump_at_edge", &c.jump_at_edge, {0, 120}, "1",
                  "Least cost of such a change where the brightness changes as well."),
      Field::real("red", &c.red, {0, 1}, "1", "Weight of red in colour pairs; water swallows red first."),
      Field::real("green", &c.green, {0, 1}, "1", "Weight of green in colour pairs."),
      Field::real("blue", &c.blue, {0, 1}, "1", "Weight of blue in colour pairs."),
      Field::real(
          "min_contrast", &c.min_contrast, {0, 50}, "grey levels",
          "Mean slope of brightness over three columns, in 9 x 9 pixels, below which a pixel is not valid; half "
          "the standard deviation of the noise comes from the noise alone."),
      Field::real("uniqueness", &c.uniqueness, {0, 1}, "1",
                  "Share by which the second-best disparity must cost more than the best."),
      Field::real("left_right", &c.left_right, {0, 256}, "pixels",
                  "Largest difference of the disparities that the left and the right picture find."),
      Field::integer("occlusion_margin", &c.occlusion_margin, {0, 16}, "pixels",
                     "Pixels to the right of an occlusion that are marked with it, because windows blur its edge."),
      Field::integer("speckle_pixels", &c.speckle_pixels, {0, 100'000}, "pixels",
                     "Smaller islands of one disparity are removed."),
      Field::real("sigma_disparity", &c.sigma_disparity, {0.01, 10}, "pixels",
                  "Standard deviation of a disparity, from which that of the range follows."),
      Field::integer("threads", &c.threads, {1, 64}, "1", "Threads that match; the result does not depend on it."),
  };
}

void check(const StereoConfig& c, const std::string& section) {
  const auto at = [&](const char* key) { return Place{{}, {}, {}, {}, section + "." + key}; };
  if (c.disparities % 64 != 0)
    throw Error(fmt::format("{} is not a multiple of 64", c.disparities), at("disparities"), "64, 128, 192, 256");
  if (c.window % 2 == 0) throw Error(fmt::format("{} is even", c.window), at("window"), "1, 3 .. 15");
  if (c.red + c.green + c.blue <= 0) throw Error("the weights of red, green and blue are all 0", at("red"));
}

}  // namespace isobath

// The objects of charts and outlines, as OGR reads them: shapes in the plane of W, and attributes by name. Internal to
// the readers of priors.
#pragma once

#include <cstddef>
#include <isobath/geometry/polygon.hpp>
#include <isobath/io/charts/prior_data.hpp>
#include <isobath/io/charts/prior_reader.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

class OGRFeature;
class OGRGeometry;
class OGRPolygon;
class OGRSimpleCurve;

namespace isobath {

/// Converts shapes, and keeps the corners of all that were converted. What has no shape or is too far from the map is
/// counted in `prior.left_out`.
class ChartShapes {
 public:
  ChartShapes(PlaneMapping mapping, Prior& prior);
  struct Found {
    std::vector<std::vector<Eigen::Vector2d>> lines;
    std::vector<std::vector<Polygon>> areas;
    std::vector<Eigen::Vector2d> points;
    std::vector<double> heights;  ///< third coordinates of the points
  };
  /// The shapes of an object; empty, and counted, if it has none or a vertex is too far away.
  Found of(OGRGeometry* geometry, const std::string& name);
  [[nodiscard]] const Eigen::Vector2d& low() const { return low_; }
  [[nodiscard]] const Eigen::Vector2d& high() const { return high_; }
  [[nodiscard]] bool any() const { return low_.x() <= high_.x(); }

 private:
  bool place(double x, double y, Eigen::Vector2d& p);
  bool line(const OGRSimpleCurve& curve, std::vector<Eigen::Vector2d>& out);
  void note(const std::vector<Eigen::Vector2d>& points);
  bool polygon(const OGRPolygon& from, Found& found);
  bool collect(const OGRGeometry& geometry, Found& found, int depth);

  PlaneMapping mapping_;
  Prior& prior_;
  std::size_t points_ = 0;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(1e300), high_ = Eigen::Vector2d::Constant(-1e300);
};

/// Empty if the attribute is absent or not finite.
std::optional<double> number_attribute(const OGRFeature& feature, const char* name);
/// Empty if the attribute is absent.
std::string text_attribute(const OGRFeature& feature, const char* name);
/// Whether a list attribute such as QUASOU holds the value.
bool attribute_lists(const OGRFeature& feature, const char* name, int value);
/// All attributes but those that number the record.
std::map<std::string, std::string> chart_attributes(const OGRFeature& feature);

}  // namespace isobath

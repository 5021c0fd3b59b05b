// Reader of charts: objects with shapes.
//
// Attributes of S-57 (IHO, edition 3.1, object catalogue): VALSOU depth of the top, WATLEV height relative to the
// water, QUASOU quality of the depth, DRVAL1 and DRVAL2 limits of a depth area, VALDCO depth of a contour.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <isobath/io/charts/chart_objects.hpp>
#include <isobath/io/charts/chart_quality.hpp>
#include <isobath/io/charts/prior_reader.hpp>
#include <iterator>
#include <ogrsf_frmts.h>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr double kSoundingSpacingOnPaper = 0.025;  // m: maximum spacing of printed soundings where it matters
constexpr double kLineSpacingOnPaper = 0.002;      // m: maximum spacing of the points of drawn contours

/// Appends the points of a line, at most `spacing` apart.
void densify(const std::vector<Vector2d>& line, double spacing, double depth, std::vector<SurveyPoint>& out) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    out.push_back({line[i], depth, 0});
    if (i + 1 == line.size()) break;
    const Vector2d step = line[i + 1] - line[i];
    const double pieces = std::ceil(step.norm() / spacing);
    if (pieces > 1e5) continue;
    for (double k = 1; k < pieces; ++k) out.push_back({line[i] + k / pieces * step, depth, 0});
  }
}

class ChartReading {
 public:
  ChartReading(const PriorJob& job, GDALDataset& data) : job_(job), data_(data), shapes_(mapping(job, data), prior_) {}
  PriorOfFile read();

 private:
  static PlaneMapping mapping(const PriorJob& job, GDALDataset& data) {
    for (OGRLayer* layer : data.GetLayers()) {
      if (layer->GetSpatialRef()) return {job, layer->GetSpatialRef()};
    }
    return {job, nullptr};
  }
  void read_header();
  void read_layer(OGRLayer& layer);
  void read_object(const std::string& type, OGRFeature& feature);
  void read_danger(const std::string& type, const OGRFeature& feature, const ChartShapes::Found& found);
  void read_depth_area(const std::string& type, const OGRFeature& feature, ChartShapes::Found& found);
  void add_lines(PriorLineKind kind, const OGRFeature& feature, const ChartShapes::Found& found,
                 std::optional<double> depth = {});
  void add_areas(PriorAreaKind kind, const OGRFeature& feature, ChartShapes::Found& found,
                 std::optional<double> least = {}, std::optional<double> greatest = {});
  [[nodiscard]] std::optional<double> depth(const OGRFeature& feature, const char* name);
  void paint();

  const PriorJob& job_;
  GDALDataset& data_;
  Prior prior_;
  ChartShapes shapes_;
  double scale_ = 50000;
  std::int64_t promised_ = -1;
  std::int64_t found_ = 0;
  std::vector<SurveyPoint> lines_;                                   ///< contours and coast, as points
  std::vector<std::pair<std::vector<Polygon>, std::size_t>> zones_;  ///< areas and their index in kConfidenceZones
};

void ChartReading::read_header() {
  OGRLayer* layer = data_.GetLayerByName("DSID");
  const OGRFeatureUniquePtr feature(layer ? layer->GetNextFeature() : nullptr);
  if (!feature) job_.refuse("the chart has no readable header: " + job_.gdal.complaint(), "fetch the cell again");
  prior_.datum = datum_of_code(static_cast<int>(number_attribute(*feature, "DSPM_SDAT").value_or(0)));
  scale_ = std::clamp(number_attribute(*feature, "DSPM_CSCL").value_or(50000), 100.0, 1e8);
  prior_.details["scale"] = fmt::format("1:{:.0f}", scale_);
  prior_.details["edition"] = text_attribute(*feature, "DSID_EDTN") + " of " + text_attribute(*feature, "DSID_ISDT");
  prior_.details["name"] = text_attribute(*feature, "DSID_DSNM");
  double sum = 0;
  for (const char* name : {"DSSI_NOMR", "DSSI_NOCR", "DSSI_NOGR", "DSSI_NOLR"}) {
    sum += std::clamp(number_attribute(*feature, name).value_or(0), 0.0, 1e9);
  }
  promised_ = static_cast<std::int64_t>(sum);
}

/// A depth attribute, if it is plausible.
std::optional<double> ChartReading::depth(const OGRFeature& feature, const char* name) {
  const auto value = number_attribute(feature, name);
  if (!value) return {};
  const double metres = *value * job_.unit(0);
  if (job_.plausible(metres)) return metres;
  ++prior_.left_out[std::string(name) + " of no plausible depth"];
  return {};
}

void ChartReading::add_lines(PriorLineKind kind, const OGRFeature& feature, const ChartShapes::Found& found,
                             std::optional<double> depth) {
  for (const auto& line : found.lines) prior_.lines.push_back({kind, line, depth, text_attribute(feature, "OBJNAM")});
}

void ChartReading::add_areas(PriorAreaKind kind, const OGRFeature& feature, ChartShapes::Found& found,
                             std::optional<double> least, std::optional<double> greatest) {
  for (auto& rings : found.areas) {
    prior_.areas.push_back({kind, std::move(rings), least, greatest, text_attribute(feature, "OBJNAM")});
  }
}

/// Reads OBSTRN, WRECKS, UWTROC and PILPNT.
void ChartReading::read_danger(const std::string& type, const OGRFeature& feature, const ChartShapes::Found& found) {
  PriorPoint point;
  point.kind = type == "WRECKS"   ? PriorPointKind::kWreck
               : type == "UWTROC" ? PriorPointKind::kRock
               : type == "PILPNT" ? PriorPointKind::kPile
                                  : PriorPointKind::kObstruction;
  point.name = text_attribute(feature, "OBJNAM");
  point.attributes = chart_attributes(feature);
  const auto top = depth(feature, "VALSOU");
  const int water = static_cast<int>(number_attribute(feature, "WATLEV").value_or(0));
  if (attribute_lists(feature, "QUASOU", 7)) {
    point.clear_to_m = top;  // QUASOU 7: least depth unknown, safe clearance at the depth shown
  } else if (top) {
    point.depth_m = top;
  } else if (water == 1 || water == 2 || water == 4 || water == 5 || water == 6 || type == "PILPNT") {
    point.depth_m = 0;  // the object reaches the surface at times, or always
  }
  const double at = top.value_or(0);
  const auto stated = number_attribute(feature, "SOUACC");
  point.sigma_m = stated && *stated > 0 ? *stated / 2 : zone_of_scale(scale_).sigma(at);
  const bool doubtful = attribute_lists(feature, "QUASOU", 3) || attribute_lists(feature, "QUASOU", 4) ||
                        attribute_lists(feature, "QUASOU", 8) || attribute_lists(feature, "QUASOU", 9);
  if (doubtful) point.sigma_m *= 2;
  for (const Vector2d& p : found.points) {
    point.north_east = p;
    prior_.points.push_back(point);
  }
  const auto limit = point.depth_m ? point.depth_m : point.clear_to_m;
  for (const auto& line : found.lines) prior_.lines.push_back({PriorLineKind::kObstruction, line, limit, point.name});
  for (const auto& rings : found.areas) {
    prior_.areas.push_back({PriorAreaKind::kObstruction, rings, limit, {}, point.name});
  }
}

void ChartReading::read_depth_area(const std::string& type, const OGRFeature& feature, ChartShapes::Found& found) {
  auto least = depth(feature, "DRVAL1"), greatest = depth(feature, "DRVAL2");
  if (least && greatest && *greatest < *least) {
    ++prior_.left_out[type + " with swapped limits"];
    return;
  }
  add_areas(type == "DRGARE" ? PriorAreaKind::kDredged : PriorAreaKind::kDepth, feature, found, least, greatest);
}

void ChartReading::read_object(const std::string& type, OGRFeature& feature) {
  ChartShapes::Found found = shapes_.of(feature.GetGeometryRef(), type);
  if (found.points.empty() && found.lines.empty() && found.areas.empty()) return;
  const double spacing = std::max(job_.wanted.grid.pixel_m, kLineSpacingOnPaper * scale_);
  if (type == "SOUNDG") {
    for (std::size_t i = 0; i < found.points.size(); ++i) {
      const double z = found.heights[i] * job_.unit(0);
      if (job_.plausible(z)) {
        prior_.soundings.push_back({found.points[i], z, 0});
      } else {
        ++prior_.left_out["soundings of no plausible depth"];
      }
    }
  } else if (type == "OBSTRN" || type == "WRECKS" || type == "UWTROC" || type == "PILPNT") {
    read_danger(type, feature, found);
  } else if (type == "DEPARE" || type == "DRGARE") {
    read_depth_area(type, feature, found);
  } else if (type == "DEPCNT") {
    const auto value = depth(feature, "VALDCO");
    if (value) {
      for (const auto& line : found.lines) densify(line, spacing, *value, lines_);
    }
    add_lines(PriorLineKind::kContour, feature, found, value);
  } else if (type == "COALNE") {
    for (const auto& line : found.lines) densify(line, spacing, 0, lines_);
    add_lines(PriorLineKind::kCoast, feature, found);
  } else if (type == "SLCONS") {
    add_lines(PriorLineKind::kStructure, feature, found);
    add_areas(PriorAreaKind::kStructure, feature, found);
  } else if (type == "PIPSOL") {
    add_lines(PriorLineKind::kPipeline, feature, found);
  } else if (type == "LNDARE") {
    for (const auto& rings : found.areas) {
      for (const Polygon& ring : rings) densify(ring, spacing, 0, lines_);
    }
    for (const Vector2d& p : found.points) {
      prior_.points.push_back(
          {PriorPointKind::kLand, p, 0.0, {}, 0, text_attribute(feature, "OBJNAM"), chart_attributes(feature)});
    }
    add_lines(PriorLineKind::kCoast, feature, found);
    add_areas(PriorAreaKind::kLand, feature, found);
  } else if (type == "M_QUAL") {
    const auto zone = static_cast<int>(number_attribute(feature, "CATZOC").value_or(6));
    for (auto& rings : found.areas) {
      zones_.emplace_back(std::move(rings), static_cast<std::size_t>(std::clamp(zone, 1, 6) - 1));
    }
  }
}

void ChartReading::read_layer(OGRLayer& layer) {
  static const char* const kWanted[] = {"SOUNDG", "OBSTRN", "WRECKS", "UWTROC", "PILPNT", "DEPARE", "DRGARE",
                                        "DEPCNT", "COALNE", "SLCONS", "PIPSOL", "LNDARE", "M_QUAL"};
  const std::string type = layer.GetName();
  if (type == "DSID") return;
  const bool wanted = std::any_of(std::begin(kWanted), std::end(kWanted), [&](const char* w) { return type == w; });
  for (const OGRFeatureUniquePtr& feature : layer) {
    ++found_;
    if (!wanted) continue;
    ++prior_.read[type];
    read_object(type, *feature);
  }
}

/// Writes the surface of soundings, contours and coast, within the limits of the areas.
void ChartReading::paint() {
  PriorRaster& raster = prior_.raster;
  std::vector<std::size_t> zone(raster.depth_m.size(), kConfidenceZones.size());
  for (const auto& [rings, grade] : zones_) {
    fill(rings, raster.window, [&, &g = grade](std::size_t i) { zone[i] = g; });
  }
  const auto sigma_of = [&](std::size_t i, double depth) {
    return (zone[i] < kConfidenceZones.size() ? kConfidenceZones[zone[i]] : zone_of_scale(scale_)).sigma(depth);
  };
  std::vector<SurveyPoint> all = prior_.soundings;
  all.insert(all.end(), lines_.begin(), lines_.end());
  PriorRaster surface = empty_raster(raster.window);
  if (!paint_surface(job_, all, std::max(job_.config.max_distance_m, kSoundingSpacingOnPaper * scale_), sigma_of,
                     surface))
    prior_.details["surface"] = "none: too few soundings near the window";
  const auto area = [&](const PriorArea& a) {
    if (!a.min_depth_m) return;
    const double least = *a.min_depth_m, greatest = a.max_depth_m.value_or(job_.config.max_depth_m);
    fill(a.rings, raster.window, [&](std::size_t i) {
      const auto d = static_cast<double>(surface.depth_m[i]);
      if (std::isfinite(d)) {
        raster.depth_m[i] = static_cast<float>(std::clamp(d, least, greatest));
        raster.sigma_m[i] = surface.sigma_m[i];
      } else {
        const double width = a.max_depth_m ? greatest - least : std::abs(least);
        raster.depth_m[i] = static_cast<float>(least);
        raster.sigma_m[i] = static_cast<float>(std::hypot(width / std::sqrt(3.0), sigma_of(i, least)));
      }
    });
  };
  for (const PriorAreaKind kind : {PriorAreaKind::kDepth, PriorAreaKind::kDredged}) {
    for (const PriorArea& a : prior_.areas) {
      if (a.kind == kind) area(a);
    }
  }
}

PriorOfFile ChartReading::read() {
  prior_.format = "S-57 chart";
  read_header();
  for (int i = 0; i < data_.GetLayerCount(); ++i) {
    if (OGRLayer* layer = data_.GetLayer(i)) read_layer(*layer);
  }
  if (found_ < promised_) {
    prior_.left_out["objects that the chart header counts but that could not be read"] =
        static_cast<std::uint64_t>(promised_ - found_);
  }
  if (!shapes_.any() && !prior_.read.empty()) {
    job_.refuse("it does not reach the window of the map", "check the origin of the map");
  }
  if (!shapes_.any()) job_.refuse("the chart holds nothing that could be read: " + job_.gdal.complaint());
  prior_.read["soundings"] = prior_.soundings.size();
  prior_.raster = empty_raster(window_over(job_, shapes_.low(), shapes_.high()));
  std::uint64_t positive = 0, negative = 0;
  for (const SurveyPoint& s : prior_.soundings) {
    positive += s.depth_m > 0;
    negative += s.depth_m < 0;
  }
  if (depth_sign(job_, PriorSign::kDown, positive, negative) < 0)
    job_.refuse("chart depths are positive down", "set prior.sign = \"automatic\"");
  paint();
  return {std::move(prior_), true};
}

}  // namespace

PriorOfFile read_chart_prior(const PriorJob& job, GDALDataset& data) { return ChartReading(job, data).read(); }

}  // namespace isobath

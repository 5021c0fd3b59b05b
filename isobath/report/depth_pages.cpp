#include <cmath>
#include <fmt/format.h>
#include <isobath/base/pending_file.hpp>
#include <isobath/geometry/smooth_surface.hpp>
#include <isobath/io/exports/geojson.hpp>
#include <isobath/report/depth_pages.hpp>
#include <isobath/report/map_chart.hpp>
#include <isobath/report/plot/depth_chart.hpp>
#include <isobath/world/map_raster.hpp>

namespace isobath {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kMaxNodes = 40000;  // of the surface between soundings
constexpr double kShoreStep = 5;          // m
constexpr double kChartMargin = 0.03;     // around the known pixels, share of the longer side
constexpr int kMinChartMargin = 1;        // pixels

/// Measured depths, thinned so that a surface through them is quick to make, and the shore at depth 0.
std::vector<SurveyPoint> nodes_of(const MapRaster& raster, const DepthChart& chart) {
  std::vector<SurveyPoint> measured;
  for (int row = 0; row < raster.window.height; ++row) {
    for (int column = 0; column < raster.window.width; ++column) {
      const std::size_t cell = static_cast<std::size_t>(row) * raster.window.width + column;
      if ((raster.flags[cell] & kSeenByDepth) == 0 || !measured_at(chart, cell)) continue;
      measured.push_back({raster.grid.centre({raster.window.column + column, raster.window.row + row}),
                          static_cast<double>(raster.depth_m[cell])});
    }
  }
  double cell_m = 2 * raster.grid.pixel_m;
  std::vector<SurveyPoint> nodes = merged(measured, cell_m, Merge::kMean);
  while (nodes.size() > kMaxNodes) {
    cell_m *= 1.4;
    nodes = merged(measured, cell_m, Merge::kMean);
  }
  for (const auto& ring : chart.shore) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d leg = ring[(i + 1) % ring.size()] - ring[i];
      const int steps = std::max(1, static_cast<int>(std::ceil(leg.norm() / kShoreStep)));
      for (int k = 0; k < steps; ++k) nodes.push_back({ring[i] + leg * k / steps, 0});
    }
  }
  return merged(nodes, 0, Merge::kMean);
}

std::string contours_text(const DepthChart& chart, double node_m) {
  std::vector<GeoFeature> features;
  for (const ContourLine& line : depth_contours(chart, node_m)) {
    GeoFeature feature;
    feature.shape = GeoShape::kLine;
    feature.outline = line.points;
    if (line.closed) feature.outline.push_back(line.points.front());
    feature.properties = {{"depth_m", line.level}};
    features.push_back(std::move(feature));
  }
  return geojson_text(features, *chart.origin);
}

}  // namespace

DepthPictures write_depth_files(const DepthModel& model, const ChartSource& source, const std::filesystem::path& folder,
                                std::vector<std::filesystem::path>& files) {
  const auto snapshot = model.snapshot();
  const PixelWindow known = known_extent(snapshot->trees());
  if (known.width == 0) return {};
  const MapRaster raster = read_raster(*snapshot, known);
  DepthChart chart = chart_of(raster, model.facts());
  chart.survey = source.survey;
  chart.date = source.date;
  chart.charted_confidence = model.charted_confidence();
  chart.tracks = model.tracks();
  for (const Prior& prior : model.prior().files) {
    for (const PriorArea& area : prior.areas) {
      if (area.kind != PriorAreaKind::kWater) continue;
      for (const Polygon& ring : area.rings) chart.shore.push_back(ring);
    }
    for (const PriorPoint& point : prior.points) {
      chart.obstructions.push_back({point.north_east, point.name.empty() ? to_text(point.kind) : point.name});
    }
  }
  const std::vector<SurveyPoint> nodes = nodes_of(raster, chart);
  std::shared_ptr<const SmoothSurface> surface;
  if (nodes.size() >= 3) {
    try {
      surface = std::make_shared<const SmoothSurface>(nodes);
    } catch (const Error&) {
      surface = nullptr;  // soundings on one line span no surface: the chart shows only them
    }
  }
  if (surface) {
    chart.surface = [surface](double north, double east) -> std::optional<double> {
      const auto sample = surface->at({north, east});
      if (!sample) return std::nullopt;
      // A smooth surface may overshoot between the shore and the nearest soundings: it must not make land.
      return std::max(0.0, sample->depth_m);
    };
  }
  write_map_geotiff(raster, model.facts(), model.evidence(), folder / "depth.tif");
  const int longer_px = std::max(raster.window.width, raster.window.height);
  std::string contours;
  if (chart.origin) {
    const double pixel_m = raster.grid.pixel_m;
    contours = contours_text(chart, std::max(pixel_m, pixel_m * longer_px / 500));
  }
  add_margin(chart, std::max(kMinChartMargin, static_cast<int>(kChartMargin * longer_px)));
  DepthPictures pictures;
  chart.title = "Depths";
  pictures.depth = depth_chart_png(chart);
  chart.title = "Confidence of the depths";
  pictures.confidence = confidence_chart_png(chart);
  write_whole_file(folder / "chart.png", pictures.depth);
  write_whole_file(folder / "confidence.png", pictures.confidence);
  files.insert(files.end(), {"depth.tif", "chart.png", "confidence.png"});
  if (chart.origin) {
    write_whole_file(folder / "contours.geojson", contours);
    files.emplace_back("contours.geojson");
  }
  return pictures;
}

namespace {

/// The first sentences of the section.
std::string summary(const DepthOutcome& depth) {
  std::string text =
      fmt::format("{:.2f} ha measured", static_cast<double>(depth.sensed_pixels) * depth.pixel_m * depth.pixel_m / 1e4);
  if (depth.deepest_m) text += fmt::format(", {:.1f} to {:.1f} m deep", *depth.shoalest_m, *depth.deepest_m);
  text += ", below " + depth.datum + ".";
  if (depth.continued) text += " This run continues a stored map.";
  std::uint64_t refused = 0;
  for (const auto& [reason, count] : depth.refused) refused += count;
  if (refused > 0) text += fmt::format(" {} readings were rejected or held back; the reasons follow.", refused);
  return text;
}

}  // namespace

void add_changes(HtmlReport& page, const MapChanges& changes, const std::optional<GeoOrigin>& origin,
                 std::size_t most) {
  page.heading("Changes against the chart");
  const std::size_t all = changes.regions.size();
  page.paragraph(
      fmt::format("{} obstacles where the chart has water, and {} other regions shoaler or deeper than charted; {} "
                  "of {} measured pixels are uncharted.{}",
                  changes.obstacles(), all - changes.obstacles(), changes.uncharted_pixels, changes.sensed_pixels,
                  all > most ? fmt::format(" The first {} follow.", most) : ""));
  std::optional<LocalPlane> plane;
  if (origin) plane.emplace(*origin);
  std::vector<HtmlReport::Row> rows;
  for (std::size_t i = 0; i < std::min(all, most); ++i) {
    const ChangedRegion& r = changes.regions[i];
    std::string place = fmt::format("{:.1f} N, {:.1f} E", r.shoalest_at.x(), r.shoalest_at.y());
    if (plane) {
      const GeoPoint at = plane->to_geo(r.shoalest_at);
      place += fmt::format(" ({:.6f}, {:.6f})", at.latitude_deg, at.longitude_deg);
    }
    const Vector2d size = r.north_east - r.south_west;
    rows.push_back({kind_of(r), to_text(r.source()), std::move(place), fmt::format("{:.2f}", r.shoalest_m),
                    fmt::format("{:.2f}", r.charted_m), fmt::format("{} of 20", r.confidence),
                    fmt::format("{:.1f} x {:.1f}", size.x(), size.y()), fmt::format("{:.1f}", r.area_m2)});
  }
  if (rows.empty()) return;
  page.table({"what", "changed by", "shoalest at (m)", "depth there (m)", "charted there (m)", "confidence",
              "extent north x east (m)", "area (m2)"},
             rows);
}

void add_depth(HtmlReport& page, const DepthOutcome& depth, const DepthPictures& pictures) {
  page.heading("Depth map");
  page.paragraph(summary(depth));
  for (const std::string& damage : depth.damages) page.warning("The stored map is damaged: " + damage);
  if (!pictures.depth.empty()) {
    page.figure(pictures.depth,
                "Depths in metres. Full colour is measured; paler is interpolated between soundings, or charted. The "
                "figures are the shoalest soundings of their surroundings.");
    page.figure(
        pictures.confidence,
        "Confidence of each measured pixel. It starts low, rises with every reading that agrees and falls with every "
        "one that does not; 20 is full confidence.");
  }
  const DepthCounts& n = depth.counts;
  const auto number = [](std::uint64_t value) { return fmt::format("{}", value); };
  std::vector<HtmlReport::Row> rows{
      {"ranges of single-beam sonars", number(n.readings)},
      {"soundings of swath sonars", number(n.soundings)},
      {"ranges merged with similar ones", number(n.merged)},
      {"readings used for the map", number(n.applied)},
      {"agreements of a reading with a pixel", number(n.affirmed)},
      {"contradictions of a reading and a pixel", number(n.conflicted)},
      {"new depths of a pixel", number(n.replaced)},
      {"echoes of forward sonars that the map predicted", number(n.explained)},
      {"pixels with a depth, charted land included", number(depth.known_pixels)},
      {"of which measured", number(depth.sensed_pixels)},
      {"of which charted and confirmed by a sounding", number(depth.confirmed_pixels)},
      {"shifts of the working window", number(n.shifts)},
      {"memory of the trees",
       fmt::format("{:.1f} MB in {} leaves", static_cast<double>(depth.bytes) / 1e6, depth.leaves)}};
  if (depth.generation > 0) rows.push_back({"committed as generation", number(depth.generation)});
  if (depth.pixels_lost > 0) rows.push_back({"pixels outside the operational area", number(depth.pixels_lost)});
  page.table({"quantity", "count"}, rows);
  rows.clear();
  const char* classes[] = {"0-4", "5-9", "10-14", "15-19", "20"};
  for (std::size_t i = 0; i < depth.sensed_by_confidence.size(); ++i) {
    const auto all = static_cast<double>(std::max<std::uint64_t>(1, depth.sensed_pixels));
    rows.push_back({classes[i], number(depth.sensed_by_confidence[i]),
                    fmt::format("{:.1f} %", 100 * static_cast<double>(depth.sensed_by_confidence[i]) / all)});
  }
  page.table({"confidence of 20", "measured pixels", "share"}, rows);
  rows.clear();
  for (const auto& [reason, count] : depth.refused) rows.push_back({reason, number(count)});
  for (const auto& [reason, count] : depth.prior_left_out) rows.push_back({"prior: " + reason, number(count)});
  if (!rows.empty()) page.table({"rejected or held back", "count"}, rows);
  rows.clear();
  for (const std::string& prior : depth.priors) rows.push_back({"file", prior});
  for (const auto& [what, count] : depth.prior_read) rows.push_back({what, number(count)});
  if (!rows.empty()) page.table({"prior", ""}, rows);
  rows.clear();
  for (const SensorLearning::Sensor& s : depth.sensors) {
    if (s.counts.confirming + s.counts.conflicting == 0) continue;
    rows.push_back({aim_of(s.X_BS), number(s.counts.confirming), number(s.counts.conflicting),
                    number(s.counts.irrelevant), fmt::format("{:.3f}", s.counts.reliability())});
  }
  if (!rows.empty()) {
    page.table({"sensor points", "as the map predicts", "not as predicted", "no prediction", "reliability"}, rows);
  }
  if (depth.changes.sensed_pixels > 0) add_changes(page, depth.changes, depth.origin);
}

}  // namespace isobath

#include <isobath/io/prior_data.hpp>

namespace isobath {

std::vector<Field> fields(PriorConfig& c) {
  const Range depth{-12000, 12000};
  return {
      Field::choice<PriorSign>(
          "sign", &c.sign, {{"automatic", PriorSign::kAutomatic}, {"up", PriorSign::kUp}, {"down", PriorSign::kDown}},
          "Whether numbers in the file grow up (heights) or down (depths)."),
      Field::real("unit_m", &c.unit_m, {0, 10}, "m", "Length of the file's unit of depth; 0: as it says, else metres."),
      Field::text("datum", &c.datum, "Vertical datum of the file's depths, where it does not say so."),
      Field::text("map_datum", &c.map_datum, "Vertical datum of the map; empty: the water surface of the day."),
      Field::rows("datum_offset_m", &c.datum_offset_m, 1, {-1000, 1000}, "m",
                  "One number: depth in the map less depth in the file; empty: not known."),
      Field::real("datum_offset_sigma_m", &c.datum_offset_sigma_m, {0, 1000}, "m", "Standard deviation of it."),
      Field::integer("epsg", &c.epsg, {0, 999999}, "1", "Horizontal system of the file; 0: as it says."),
      Field::rows("no_data", &c.no_data, 1, {}, "1", "Values that mean nothing, beside the customary ones."),
      Field::real("least_depth_m", &c.least_depth_m, depth, "m", "Less is not plausible."),
      Field::real("greatest_depth_m", &c.greatest_depth_m, depth, "m", "More is not plausible."),
      Field::choice<Merge>("pixels", &c.pixels, {{"mean", Merge::kMean}, {"shoalest", Merge::kShoalest}},
                           "What stands for several cells or soundings of one pixel."),
      Field::real("sigma_m", &c.sigma_m, {0, 1000}, "m", "Standard deviation of depths that come without."),
      Field::real("sigma_share", &c.sigma_share, {0, 1}, "1", "What is added to it, in shares of the depth."),
      Field::real("farthest_m", &c.farthest_m, {0, 1e6}, "m", "Farther from any sounding nothing is known."),
      Field::text("x_column", &c.x_column, "Column of text with east or longitude: a name, or a number from 1."),
      Field::text("y_column", &c.y_column, "Column with north or latitude."),
      Field::text("z_column", &c.z_column, "Column with depth or height."),
      Field::text("run_column", &c.run_column, "Column with the run of the survey; empty: one run."),
      Field::real("most_cells", &c.most_cells, {1, 1e12}, "1", "Cells of a raster that are read at most."),
  };
}

const char* to_text(PriorPointKind kind) {
  switch (kind) {
    case PriorPointKind::kObstruction: return "obstruction";
    case PriorPointKind::kWreck: return "wreck";
    case PriorPointKind::kRock: return "rock";
    case PriorPointKind::kPile: return "pile";
    case PriorPointKind::kLand: return "land";
  }
  return "";
}

const char* to_text(PriorLineKind kind) {
  switch (kind) {
    case PriorLineKind::kCoast: return "coast";
    case PriorLineKind::kContour: return "contour";
    case PriorLineKind::kPipeline: return "pipeline";
    case PriorLineKind::kStructure: return "structure";
    case PriorLineKind::kObstruction: return "obstruction";
  }
  return "";
}

const char* to_text(PriorAreaKind kind) {
  switch (kind) {
    case PriorAreaKind::kDepth: return "depth";
    case PriorAreaKind::kDredged: return "dredged";
    case PriorAreaKind::kLand: return "land";
    case PriorAreaKind::kWater: return "water";
    case PriorAreaKind::kStructure: return "structure";
    case PriorAreaKind::kObstruction: return "obstruction";
  }
  return "";
}

}  // namespace isobath

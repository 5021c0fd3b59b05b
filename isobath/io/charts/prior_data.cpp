#include <isobath/io/charts/prior_data.hpp>

namespace isobath {

std::vector<Field> fields(PriorConfig& c) {
  const Range depth{-12000, 12000};
  return {
      Field::choice<PriorSign>(
          "sign", &c.sign, {{"automatic", PriorSign::kAutomatic}, {"up", PriorSign::kUp}, {"down", PriorSign::kDown}},
          "Whether the numbers in the file are heights (up) or depths (down)."),
      Field::real("unit_m", &c.unit_m, {0, 10}, "m",
                  "Length of the file's unit of depth; 0: as it states, else metres."),
      Field::text("datum", &c.datum, "Vertical datum of the file's depths, if the file does not state it."),
      Field::text("map_datum", &c.map_datum, "Vertical datum of the map; empty: the water surface of the day."),
      Field::rows("datum_offset_m", &c.datum_offset_m, 1, {-1000, 1000}, "m",
                  "One number: depth in the map less depth in the file; empty: unknown."),
      Field::real("datum_offset_sigma_m", &c.datum_offset_sigma_m, {0, 1000}, "m",
                  "Standard deviation of datum_offset_m."),
      Field::integer("epsg", &c.epsg, {0, 999999}, "1",
                     "EPSG code of the file's horizontal coordinate system; 0: as it states."),
      Field::rows("no_data", &c.no_data, 1, {}, "1", "No-data values, in addition to the usual ones."),
      Field::real("min_depth_m", &c.min_depth_m, depth, "m", "Minimum plausible depth; shallower ones are left out.")
          .was("least_depth_m"),
      Field::real("max_depth_m", &c.max_depth_m, depth, "m", "Maximum plausible depth; deeper ones are left out.")
          .was("greatest_depth_m"),
      Field::choice<Merge>("pixels", &c.pixels, {{"mean", Merge::kMean}, {"shoalest", Merge::kShoalest}},
                           "How several cells or soundings of one pixel are combined."),
      Field::real("sigma_m", &c.sigma_m, {0, 1000}, "m", "Standard deviation of depths that state none."),
      Field::real("sigma_share", &c.sigma_share, {0, 1}, "1", "Added to sigma_m, as a share of the depth."),
      Field::real("max_distance_m", &c.max_distance_m, {0, 1e6}, "m",
                  "Maximum distance from a sounding; beyond it the depth is unknown.")
          .was("farthest_m"),
      Field::text("x_column", &c.x_column, "Text column with east or longitude: a name, or a number from 1."),
      Field::text("y_column", &c.y_column, "Text column with north or latitude."),
      Field::text("z_column", &c.z_column, "Text column with depth or height."),
      Field::text("run_column", &c.run_column, "Text column with the run of the survey; empty: one run."),
      Field::real("max_cells", &c.max_cells, {1, 1e12}, "1", "Maximum number of raster cells that are read.")
          .was("most_cells"),
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

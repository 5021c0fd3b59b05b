#include <isobath/runtime/recorder_config.hpp>
#include <iterator>

namespace isobath {

std::vector<Field> fields(RecorderConfig& c) {
  std::vector<Field> all{
      Field::real("display_s", &c.display_s, {0.01, 60}, "s", "Between two samples of what the live page shows."),
      Field::real("whole_s", &c.whole_s, {1, 3600}, "s",
                  "Between two samples of all that the page shows, at least: what a seek begins with."),
      Field::flag("foxglove", &c.foxglove.on, "Channels that Foxglove and other viewers show without a plug-in."),
      Field::real("foxglove_pose_s", &c.foxglove.pose_s, {0, 3600}, "s", "Between two poses in these channels."),
      Field::real("foxglove_points_s", &c.foxglove.points_s, {0, 3600}, "s", "Between two clouds of echoes."),
      Field::real("foxglove_grid_s", &c.foxglove.grid_s, {0, 3600}, "s",
                  "Between two grids of occupancy, and obstacles: scans in between are left out."),
      Field::real("foxglove_image_s", &c.foxglove.image_s, {0, 3600}, "s", "Between two images of a sonar."),
      Field::real("foxglove_voxels_s", &c.foxglove.voxels_s, {0.1, 3600}, "s",
                  "Between two clouds of voxels, and two tracks, at least.")};
  std::vector<Field> log = fields(c.log);
  all.insert(all.end(), std::make_move_iterator(log.begin()), std::make_move_iterator(log.end()));
  return all;
}

}  // namespace isobath

#include <isobath/configuration/recorder_config.hpp>
#include <iterator>

namespace isobath {

std::vector<Field> fields(RecorderConfig& c) {
  std::vector<Field> all{
      Field::real("display_s", &c.display_s, {0.01, 60}, "s", "Time between two samples of the live page."),
      Field::real("keyframe_s", &c.keyframe_s, {1, 3600}, "s",
                  "Minimum time between two complete samples of the page. A seek starts at one of them.")
          .was("whole_s"),
      Field::flag("foxglove", &c.foxglove.on,
                  "Writes channels that Foxglove and other viewers show without a plug-in."),
      Field::real("foxglove_pose_s", &c.foxglove.pose_s, {0, 3600}, "s",
                  "Minimum time between two poses in these channels."),
      Field::real("foxglove_points_s", &c.foxglove.points_s, {0, 3600}, "s",
                  "Minimum time between two point clouds of echoes."),
      Field::real("foxglove_grid_s", &c.foxglove.grid_s, {0, 3600}, "s",
                  "Minimum time between two occupancy grids with their obstacles. Scans in between are left out."),
      Field::real("foxglove_image_s", &c.foxglove.image_s, {0, 3600}, "s",
                  "Minimum time between two images of a sonar."),
      Field::real("foxglove_voxels_s", &c.foxglove.voxels_s, {0.1, 3600}, "s",
                  "Minimum time between two point clouds of voxels, and between two tracks.")};
  std::vector<Field> log = fields(c.log);
  all.insert(all.end(), std::make_move_iterator(log.begin()), std::make_move_iterator(log.end()));
  return all;
}

}  // namespace isobath

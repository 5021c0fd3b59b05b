#include <array>
#include <isobath/io/ros/ros_definition.hpp>
#include <utility>

namespace isobath {
namespace {

#define ISOBATH_ROS_MSG(name) "================\nMSG: " name "\n"
#define ISOBATH_ROS_HEADER ISOBATH_ROS_MSG("std_msgs/Header") "builtin_interfaces/Time stamp\nstring frame_id\n"
#define ISOBATH_ROS_VECTOR ISOBATH_ROS_MSG("geometry_msgs/Vector3") "float64 x\nfloat64 y\nfloat64 z\n"
#define ISOBATH_ROS_QUATERNION \
  ISOBATH_ROS_MSG("geometry_msgs/Quaternion") "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
#define ISOBATH_ROS_POSE                                      \
  ISOBATH_ROS_MSG("geometry_msgs/Pose")                       \
  "Point position\nQuaternion orientation\n" ISOBATH_ROS_MSG( \
      "geometry_msgs/Point") "float64 x\nfloat64 y\nfloat64 z\n" ISOBATH_ROS_QUATERNION
#define ISOBATH_ROS_PING_INFO                      \
  ISOBATH_ROS_MSG("marine_acoustic_msgs/PingInfo") \
  "float32 frequency\nfloat32 sound_speed\nfloat32[] tx_beamwidths\nfloat32[] rx_beamwidths\n" \
  ISOBATH_ROS_MSG("marine_acoustic_msgs/SonarImageData")                                       \
  "bool is_bigendian\nuint32 dtype\nuint32 beam_count\nuint8[] data\n"                         \
  ISOBATH_ROS_MSG("marine_acoustic_msgs/DetectionFlag") "uint8 flag\n"

using NamedDefinition = std::pair<std::string_view, std::string_view>;
constexpr std::array kKnown{
    NamedDefinition{"sensor_msgs/LaserScan",
                    "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\nfloat32 "
                    "time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] "
                    "ranges\nfloat32[] intensities\n" ISOBATH_ROS_HEADER},
    NamedDefinition{"sensor_msgs/PointCloud2",
                    "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool "
                    "is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool "
                    "is_dense\n" ISOBATH_ROS_HEADER ISOBATH_ROS_MSG(
                        "sensor_msgs/PointField") "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    NamedDefinition{"sensor_msgs/Range",
                    "std_msgs/Header header\nuint8 radiation_type\nfloat32 field_of_view\nfloat32 min_range\nfloat32 "
                    "max_range\nfloat32 range\n" ISOBATH_ROS_HEADER},
    NamedDefinition{"sensor_msgs/Image",
                    "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 "
                    "step\nuint8[] data\n" ISOBATH_ROS_HEADER},
    NamedDefinition{"sensor_msgs/CompressedImage",
                    "std_msgs/Header header\nstring format\nuint8[] data\n" ISOBATH_ROS_HEADER},
    NamedDefinition{"sensor_msgs/Imu",
                    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] "
                    "orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\nfloat64[9] "
                    "angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\nfloat64[9] "
                    "linear_acceleration_covariance\n" ISOBATH_ROS_HEADER ISOBATH_ROS_QUATERNION ISOBATH_ROS_VECTOR},
    NamedDefinition{"sensor_msgs/NavSatFix",
                    "std_msgs/Header header\nNavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 "
                    "altitude\nfloat64[9] position_covariance\nuint8 "
                    "position_covariance_type\n" ISOBATH_ROS_HEADER ISOBATH_ROS_MSG(
                        "sensor_msgs/NavSatStatus") "int8 status\nuint16 service\n"},
    NamedDefinition{"sensor_msgs/FluidPressure",
                    "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n" ISOBATH_ROS_HEADER},
    NamedDefinition{
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance "
        "pose\ngeometry_msgs/TwistWithCovariance twist\n" ISOBATH_ROS_HEADER ISOBATH_ROS_POSE ISOBATH_ROS_VECTOR
            ISOBATH_ROS_MSG("geometry_msgs/PoseWithCovariance") "Pose pose\nfloat64[36] "
                                                                "covariance\n" ISOBATH_ROS_MSG(
                                                                    "geometry_msgs/"
                                                                    "TwistWithCovarianc"
                                                                    "e") "Twist "
                                                                         "twist\nfloat64"
                                                                         "[36] "
                                                                         "covariance"
                                                                         "\n" ISOBATH_ROS_MSG("geometry_"
                                                                                              "msgs/"
                                                                                              "Twist") "V"
                                                                                                       "e"
                                                                                                       "c"
                                                                                                       "t"
                                                                                                       "o"
                                                                                                       "r"
                                                                                                       "3"
                                                                                                       " "
                                                                                                       "l"
                                                                                                       "i"
                                                                                                       "n"
                                                                                                       "e"
                                                                                                       "a"
                                                                                                       "r"
                                                                                                       "\nVector3 "
                                                                                                       "a"
                                                                                                       "n"
                                                                                                       "g"
                                                                                                       "u"
                                                                                                       "l"
                                                                                                       "a"
                                                                                                       "r"
                                                                                                       "\n"},
    NamedDefinition{"geometry_msgs/PoseStamped",
                    "std_msgs/Header header\nPose pose\n" ISOBATH_ROS_HEADER ISOBATH_ROS_POSE},
    NamedDefinition{"geometry_msgs/PoseWithCovarianceStamped",
                    "std_msgs/Header header\nPoseWithCovariance pose\n" ISOBATH_ROS_HEADER ISOBATH_ROS_POSE
                        ISOBATH_ROS_MSG("geometry_msgs/PoseWithCovariance") "Pose pose\nfloat64[36] covariance\n"},
    NamedDefinition{
        "tf2_msgs/TFMessage",
        "geometry_msgs/TransformStamped[] transforms\n" ISOBATH_ROS_HEADER ISOBATH_ROS_VECTOR ISOBATH_ROS_QUATERNION
            ISOBATH_ROS_MSG(
                "geometry_msgs/TransformStamped") "std_msgs/Header "
                                                  "header\nstring "
                                                  "child_frame_id\nTrans"
                                                  "form transform\n" ISOBATH_ROS_MSG(
                                                      "geometry_msgs/Transform") "Vector3 translation\nQuaternion "
                                                                                 "rotation\n"},
    NamedDefinition{"marine_acoustic_msgs/ProjectedSonarImage",
                    "std_msgs/Header header\nPingInfo ping_info\ngeometry_msgs/Vector3[] beam_directions\nfloat32[] "
                    "ranges\nSonarImageData image\n" ISOBATH_ROS_HEADER ISOBATH_ROS_VECTOR ISOBATH_ROS_PING_INFO},
    NamedDefinition{"marine_acoustic_msgs/RawSonarImage",
                    "std_msgs/Header header\nPingInfo ping_info\nfloat32 sample_rate\nuint32 samples_per_beam\nuint32 "
                    "sample0\nfloat32[] tx_delays\nfloat32[] tx_angles\nfloat32[] rx_angles\nSonarImageData "
                    "image\n" ISOBATH_ROS_HEADER ISOBATH_ROS_PING_INFO},
    NamedDefinition{"marine_acoustic_msgs/SonarRanges",
                    "std_msgs/Header header\nPingInfo ping_info\nDetectionFlag[] flags\nfloat32[] "
                    "transmit_delays\nfloat32[] intensities\ngeometry_msgs/Vector3[] beam_unit_vec\nfloat32[] "
                    "ranges\n" ISOBATH_ROS_HEADER ISOBATH_ROS_VECTOR ISOBATH_ROS_PING_INFO},
    NamedDefinition{"marine_acoustic_msgs/SonarDetections",
                    "std_msgs/Header header\nPingInfo ping_info\nDetectionFlag[] flags\nfloat32[] "
                    "two_way_travel_times\nfloat32[] tx_delays\nfloat32[] intensities\nfloat32[] tx_angles\nfloat32[] "
                    "rx_angles\n" ISOBATH_ROS_HEADER ISOBATH_ROS_PING_INFO},
};

}  // namespace

std::string_view known_ros_definition(std::string_view type) {
  for (const auto& [name, text] : kKnown) {
    if (name == type) return text;
  }
  return {};
}

}  // namespace isobath

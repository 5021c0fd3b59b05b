// Message types of ROS by the texts of their packages (common_interfaces, marine_acoustic_msgs, geographic_msgs), one a
// type, without comments. Constants stay: the checksums of ROS 1 count them.
#include <algorithm>
#include <array>
#include <isobath/io/mcap/native_log_kinds.hpp>
#include <isobath/io/ros/ros_definition.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace isobath {
namespace {

struct MessageText {
  std::string_view type, text;
};
constexpr std::array kMessageTexts{
    MessageText{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    MessageText{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    MessageText{"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    MessageText{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    MessageText{"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    MessageText{"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
    MessageText{"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
    MessageText{"geometry_msgs/PoseWithCovarianceStamped",
                "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n"},
    MessageText{"geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    MessageText{"geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
    MessageText{"geometry_msgs/TwistWithCovarianceStamped",
                "std_msgs/Header header\ngeometry_msgs/TwistWithCovariance twist\n"},
    MessageText{"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    MessageText{"geometry_msgs/TransformStamped",
                "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    MessageText{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    MessageText{"nav_msgs/Odometry",
                "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n"
                "geometry_msgs/TwistWithCovariance twist\n"},
    MessageText{"sensor_msgs/LaserScan",
                "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
                "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
                "float32[] intensities\n"},
    MessageText{"sensor_msgs/PointField",
                "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
                "uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    MessageText{"sensor_msgs/PointCloud2",
                "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
                "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
    MessageText{"sensor_msgs/Range",
                "std_msgs/Header header\nuint8 ULTRASOUND=0\nuint8 INFRARED=1\nuint8 radiation_type\n"
                "float32 field_of_view\nfloat32 min_range\nfloat32 max_range\nfloat32 range\n"},
    MessageText{"sensor_msgs/Image",
                "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
                "uint32 step\nuint8[] data\n"},
    MessageText{"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    MessageText{"sensor_msgs/Imu",
                "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
                "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
                "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"},
    MessageText{"sensor_msgs/NavSatStatus",
                "int8 STATUS_NO_FIX=-1\nint8 STATUS_FIX=0\nint8 STATUS_SBAS_FIX=1\nint8 STATUS_GBAS_FIX=2\n"
                "int8 status\nuint16 SERVICE_GPS=1\nuint16 SERVICE_GLONASS=2\nuint16 SERVICE_COMPASS=4\n"
                "uint16 SERVICE_GALILEO=8\nuint16 service\n"},
    MessageText{"sensor_msgs/NavSatFix",
                "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\n"
                "float64 altitude\nfloat64[9] position_covariance\nuint8 COVARIANCE_TYPE_UNKNOWN=0\n"
                "uint8 COVARIANCE_TYPE_APPROXIMATED=1\nuint8 COVARIANCE_TYPE_DIAGONAL_KNOWN=2\n"
                "uint8 COVARIANCE_TYPE_KNOWN=3\nuint8 position_covariance_type\n"},
    MessageText{"sensor_msgs/FluidPressure", "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n"},
    MessageText{"geographic_msgs/GeoPoint", "float64 latitude\nfloat64 longitude\nfloat64 altitude\n"},
    MessageText{"geographic_msgs/GeoPointStamped", "std_msgs/Header header\ngeographic_msgs/GeoPoint position\n"},
    MessageText{"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
    MessageText{"diagnostic_msgs/DiagnosticStatus",
                "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n"
                "string hardware_id\ndiagnostic_msgs/KeyValue[] values\n"},
    MessageText{"diagnostic_msgs/DiagnosticArray",
                "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n"},
    MessageText{"marine_acoustic_msgs/PingInfo",
                "float32 frequency\nfloat32 sound_speed\nfloat32[] tx_beamwidths\nfloat32[] rx_beamwidths\n"},
    MessageText{"marine_acoustic_msgs/SonarImageData",
                "bool is_bigendian\nuint32 DTYPE_UINT8=0\nuint32 DTYPE_INT8=1\nuint32 DTYPE_UINT16=2\n"
                "uint32 DTYPE_INT16=3\nuint32 DTYPE_UINT32=4\nuint32 DTYPE_INT32=5\nuint32 DTYPE_UINT64=6\n"
                "uint32 DTYPE_INT64=7\nuint32 DTYPE_FLOAT32=8\nuint32 DTYPE_FLOAT64=9\nuint32 dtype\n"
                "uint32 beam_count\nuint8[] data\n"},
    MessageText{"marine_acoustic_msgs/DetectionFlag", "uint8 flag\n"},
    MessageText{"marine_acoustic_msgs/ProjectedSonarImage",
                "std_msgs/Header header\nmarine_acoustic_msgs/PingInfo ping_info\n"
                "geometry_msgs/Vector3[] beam_directions\nfloat32[] ranges\n"
                "marine_acoustic_msgs/SonarImageData image\n"},
    MessageText{"marine_acoustic_msgs/RawSonarImage",
                "std_msgs/Header header\nmarine_acoustic_msgs/PingInfo ping_info\nfloat32 sample_rate\n"
                "uint32 samples_per_beam\nuint32 sample0\nfloat32[] tx_delays\nfloat32[] tx_angles\n"
                "float32[] rx_angles\nmarine_acoustic_msgs/SonarImageData image\n"},
    MessageText{"marine_acoustic_msgs/SonarRanges",
                "std_msgs/Header header\nmarine_acoustic_msgs/PingInfo ping_info\n"
                "marine_acoustic_msgs/DetectionFlag[] flags\nfloat32[] transmit_delays\nfloat32[] intensities\n"
                "geometry_msgs/Vector3[] beam_unit_vec\nfloat32[] ranges\n"},
    MessageText{"marine_acoustic_msgs/SonarDetections",
                "std_msgs/Header header\nmarine_acoustic_msgs/PingInfo ping_info\n"
                "marine_acoustic_msgs/DetectionFlag[] flags\nfloat32[] two_way_travel_times\nfloat32[] tx_delays\n"
                "float32[] intensities\nfloat32[] tx_angles\nfloat32[] rx_angles\n"},
};

std::string_view text_of_type(std::string_view type) {
  const auto* const found = std::ranges::find(kMessageTexts, type, &MessageText::type);
  return found == kMessageTexts.end() ? std::string_view() : found->text;
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// Lists a type and those that its fields name, each once, the type first.
void list_needed(std::string_view type, std::vector<std::string_view>& types) {
  const std::string_view text = text_of_type(type);
  if (text.empty() || std::ranges::find(types, type) != types.end()) return;
  types.push_back(type);
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1) {
    list_needed(text.substr(at, text.find_first_of(" [", at) - at), types);
  }
}

/// A record of the native log as a type of the package isobath_msgs.
std::string text_of_record(std::string_view type) {
  for (const native::RecordKind* kind : native::kEventKinds) {
    if (type.substr(type.find('/')) != std::string_view(kind->name).substr(std::string_view(kind->name).rfind('/')))
      continue;
    std::string text = native::definition_of(*kind);
    replace_all(text, "isobath/", "isobath_msgs/");
    return text;
  }
  return {};
}

}  // namespace

std::string known_ros_definition(std::string_view type, RosEncoding encoding) {
  if (type.starts_with(kRecordPackage)) return text_of_record(type);
  std::vector<std::string_view> types;
  list_needed(type, types);
  const std::string rule = std::string(80, '=') + "\nMSG: ";
  std::string all;
  bool has_time = false;
  for (const std::string_view needed : types) {
    if (!all.empty()) all.append(rule).append(needed).append("\n");
    if (needed == "std_msgs/Header" && encoding == RosEncoding::kRos1) all.append("uint32 seq\n");
    all.append(text_of_type(needed));
    has_time = has_time || needed == "std_msgs/Header";
  }
  if (encoding == RosEncoding::kRos1) {
    replace_all(all, "builtin_interfaces/Time ", "time ");
  } else if (has_time) {
    all.append(rule).append("builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
  }
  return all;
}

}  // namespace isobath

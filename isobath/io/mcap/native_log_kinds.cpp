#include <isobath/io/mcap/native_log_kinds.hpp>

namespace isobath::native {
namespace {

constexpr const char* kPoseDefinition =
    "\nMSG: isobath/Pose\n"
    "# North-east-down or forward-starboard-down axes; unit quaternion.\n"
    "float64 x\nfloat64 y\nfloat64 z\nfloat64 qx\nfloat64 qy\nfloat64 qz\nfloat64 qw\n";

}  // namespace

std::string definition_of(const RecordKind& kind) {
  if (!kind.has_poses) return kind.definition;
  return kind.definition + std::string(80, '=') + kPoseDefinition;
}

const RecordKind kPing = {
    .topic = "/ping",
    .name = "isobath/msg/Ping",
    .definition =
        "# One transmission of an imaging sonar: a fan of beams by range bins. SI units.\n"
        "int64 time_ns             # since 1970 (UTC), or since the start of a log without a date\n"
        "isobath/Pose sensor       # sensor in body\n"
        "float64 sound_speed       # that the ranges were computed with\n"
        "float64 range_start       # near edge of the first bin\n"
        "float64 bin_length\n"
        "uint32 bins\n"
        "float32 full_scale        # value of a saturated sample\n"
        "float64 blind_m           # nearer samples hold the sonar's own transmission; 0: not stated\n"
        "uint8 sweep               # of a scanning head: 0 unknown, 1 inside a sweep, 2 its end\n"
        "float64 beam_height       # full -3 dB width in elevation, rad\n"
        "float64[] azimuth         # of each beam, clockwise seen from above, rad\n"
        "float64[] beam_width      # full -3 dB width of each beam, rad\n"
        "uint8[] samples_u8        # beam by beam, nearest bin first; one of the three lists is filled\n"
        "uint16[] samples_u16\n"
        "float32[] samples_f32\n"
        "uint32[] sampled          # of each beam the first bin that was sampled and the one behind the last; empty: "
        "all\n",
    .has_poses = true};

const RecordKind kNavigation = {
    .topic = "/navigation",
    .name = "isobath/msg/Navigation",
    .definition =
        "# One fix of the vehicle's own estimate of where it is. SI units, world north-east-down.\n"
        "int64 time_ns\n"
        "isobath/Pose body         # body in world\n"
        "float64[] velocity        # of the body in the world: north, east, down; empty: unknown\n"
        "float64[] covariance      # 6 x 6 by rows, of position (world) and rotation vector (body); empty: unknown\n"
        "float64[] velocity_sigma  # standard deviation of the velocity in the plane; empty: not stated\n",
    .has_poses = true};

const RecordKind kRange = {.topic = "/range",
                           .name = "isobath/msg/RangeReading",
                           .definition =
                               "# A single range with the cone it was measured in. SI units.\n"
                               "int64 time_ns\n"
                               "isobath/Pose sensor       # sensor in body; x is the axis of the cone\n"
                               "float64 max_range\n"
                               "float64 width             # full width of the cone, rad\n"
                               "float32 confidence        # 0 to 1\n"
                               "float64[] range           # empty: no echo within max_range\n",
                           .has_poses = true};

const RecordKind kHealth = {.topic = "/health",
                            .name = "isobath/msg/Health",
                            .definition =
                                "# How the vehicle, or one of its sensors, is.\n"
                                "int64 time_ns\n"
                                "string source             # vehicle, or the name of a sensor\n"
                                "uint8 state               # 0 sound, 1 degraded, 2 lost\n"
                                "float32 battery           # share of a full charge\n"
                                "bool leak\n"
                                "string note\n"};

const RecordKind kSwath = {.topic = "/swath",
                           .name = "isobath/msg/Swath",
                           .definition =
                               "# The soundings of one transmission of a multibeam echo sounder. SI units.\n"
                               "int64 time_ns\n"
                               "uint8 frame               # of the points: 0 body, 1 level: x forward, y starboard, z "
                               "below the water surface\n"
                               "float64[] heading         # of the ping, rad; empty: that of the pose\n"
                               "float64 beam_width        # full, rad; 0: not known\n"
                               "float64 sound_speed       # at the transducer; 0: not stated\n"
                               "float32[] x               # one element a sounding in each of the lists: forward\n"
                               "float32[] y               # starboard\n"
                               "float32[] z               # down\n"
                               "float32[] range           # slant range from the transducer\n"
                               "float32[] sigma           # standard deviation of the depth; 0: not stated\n"
                               "uint16[] beam\n"
                               "uint8[] kind              # 0 bottom, 1 something in the water\n"
                               "float64 beam_height       # full, rad, where elevation is not resolved; 0: it is "
                               "known. Older logs lack it\n"
                               "float32[] sigma_range     # standard deviation of each range, along the ray; 0: not "
                               "stated. Older logs lack it\n"};

const RecordKind kOperatorFrame = {.topic = "/operator",
                                   .name = "isobath/msg/OperatorFrame",
                                   .definition =
                                       "# One frame of the operator's link, as it arrived at the vehicle.\n"
                                       "int64 time_ns\n"
                                       "uint8[] bytes\n"};

const RecordKind kBearing = {.topic = "/bearing",
                             .name = "isobath/msg/PassiveBearing",
                             .definition =
                                 "# The direction of one frequency line, by an array of hydrophones. SI units.\n"
                                 "int64 time_ns\n"
                                 "isobath/Pose sensor       # array in body\n"
                                 "float64 bearing           # about z of the array, clockwise from its x, rad\n"
                                 "float64 bearing_sigma     # standard deviation, rad\n"
                                 "float64 frequency         # Hz\n"
                                 "float64 resolution        # width of a frequency cell, Hz\n"
                                 "float64 snr               # signal to noise in that cell, dB\n"
                                 "float64[] elevation       # above the array's x-y plane, rad; empty: not resolved\n",
                             .has_poses = true};

const std::array<const RecordKind*, 7> kEventKinds = {&kPing,  &kRange,         &kNavigation, &kHealth,
                                                      &kSwath, &kOperatorFrame, &kBearing};

const RecordKind kTrueMotion = {.topic = "/truth/motion",
                                .name = "isobath/msg/TrueMotion",
                                .definition =
                                    "# Where a simulated vehicle really is. SI units, world north-east-down.\n"
                                    "int64 time_ns\n"
                                    "isobath/Pose body         # body in world\n"
                                    "float64[] velocity        # over ground, components in the body\n"
                                    "float64[] rates           # roll, pitch, yaw rate\n"
                                    "float64[] current         # of the water: north, east, down\n"
                                    "float64[] altitude        # above the bottom; empty: no bottom below\n",
                                .has_poses = true};

const RecordKind kEchoTruth = {
    .topic = "/truth/echoes",
    .name = "isobath/msg/EchoTruth",
    .definition =
        "# What each sample of a simulated ping really is.\n"
        "int64 time_ns             # of the ping\n"
        "string sonar\n"
        "uint32 beams\n"
        "uint32 bins\n"
        "uint16[] labels           # beam by beam. Upper 12 bits: 0 nothing, 1 surface, 2 bottom, 3.. bodies of the "
        "scene;\n"
        "                          # lower 4: 0 noise, 1 direct, 2 side lobe, 3 surface bounce, 4 bottom bounce,\n"
        "                          # 5 body bounce, 6 multiple, 7 volume, 8 ringing, 9 spurious, 10 disturbance\n"};

const RecordKind kSetpoint = {.topic = "/setpoint",
                              .name = "isobath/msg/Setpoint",
                              .definition =
                                  "# What the vehicle is told to do from this time on. SI units.\n"
                                  "int64 time_ns\n"
                                  "float64 heading           # clockwise from north, rad\n"
                                  "float64 depth\n"
                                  "float64 speed             # ahead\n"
                                  "float64 sway_speed        # to starboard\n"};

const RecordKind kDecision = {
    .topic = "/decisions",
    .name = "isobath/msg/Decision",
    .definition =
        R"({"type": "object", "properties": {"time_ns": {"type": "integer"}, "agent": {"type": "string"},
"what": {"type": "string"}, "reason": {"type": "string"}}, "required": ["time_ns", "agent", "what", "reason"]})",
    .schema_encoding = "jsonschema",
    .message_encoding = "json"};

}  // namespace isobath::native

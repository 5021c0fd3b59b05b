// The kinds of records in a native log: channel, name, encoding and definition. Foreign readers decode the records by
// these definitions, and recorded logs contain them: no kind changes, new fields are added at the end of a record.
// For the native log, and for the bags of ROS that carry the same records.
#pragma once

#include <array>
#include <string>

namespace isobath::native {

struct RecordKind {
  const char* topic;
  const char* name;
  const char* definition;  ///< fields with types, units and meaning; for the file see definition_of
  bool has_poses = false;  ///< the definition uses isobath/Pose
  const char* schema_encoding = "ros2msg";
  const char* message_encoding = "cdr";
};

// Inputs of a vehicle, one kind for each type of Event.
extern const RecordKind kPing;
extern const RecordKind kNavigation;
extern const RecordKind kRange;
extern const RecordKind kHealth;
extern const RecordKind kSwath;
extern const RecordKind kOperatorFrame;
extern const RecordKind kBearing;
/// All of them, in the order of the alternatives of Event.
extern const std::array<const RecordKind*, 7> kEventKinds;
// Ground truth of a simulator.
extern const RecordKind kTrueMotion;
extern const RecordKind kEchoTruth;
// What the vehicle decided.
extern const RecordKind kSetpoint;
extern const RecordKind kDecision;

/// The definition as the file contains it, with that of the poses.
std::string definition_of(const RecordKind& kind);

// Names of the metadata.
constexpr const char* kOrigin = "isobath/origin";
constexpr const char* kDetails = "isobath/source";
constexpr const char* kConfiguration = "isobath/configuration";

}  // namespace isobath::native

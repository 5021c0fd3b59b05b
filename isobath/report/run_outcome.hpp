// RunOutcome: the results of a run (run.hpp).
#pragma once

#include <filesystem>
#include <isobath/onboard/corner_navigation.hpp>
#include <isobath/onboard/passive_contacts.hpp>
#include <isobath/onboard/pipeline.hpp>
#include <isobath/onboard/stage_cpu_time.hpp>
#include <isobath/report/depth_outcome.hpp>
#include <isobath/report/mission_outcome.hpp>
#include <isobath/scenario/detection_scorer.hpp>
#include <isobath/world/placed_detections.hpp>
#include <isobath/world/spherical_model.hpp>
#include <isobath/world/track_drift.hpp>
#include <isobath/world/voxel_model.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

struct RunTimings {
  double wall_s = 0;          ///< reading and mapping
  double ping_median_ms = 0;  ///< mapping only, per ping
  double ping_p99_ms = 0;
  RunLoad load;  ///< processor time by stage
};

/// What a live run dropped because its threads could not keep up.
struct LiveOutcome {
  std::uint64_t lost_pings = 0;  ///< dropped from the mapping queue
  /// Dropped from the queue of the display thread: pings and scans; events, messages and all else.
  std::uint64_t unshown_pings = 0, unshown_notes = 0;
  std::string display_problem;  ///< why the display failed and nothing more was shown or recorded; empty: it did not
};

/// What a run on a vehicle sent, and how long that took.
struct AboardOutcome {
  std::uint64_t setpoints = 0;  ///< sent
  std::uint64_t withheld = 0;   ///< not sent, because the autopilot was not armed and in GUIDED
  std::uint64_t damaged = 0;    ///< stretches of bytes of the autopilot that were no frame
  StageTime ping_to_setpoint;   ///< from the last byte of a ping to the first set-point after it was mapped
  struct Device {
    std::string name;
    bool heard = false;
    std::uint64_t losses = 0;  ///< of its link
  };
  std::vector<Device> devices;
};

struct RunOutcome {
  std::vector<Alarm> alarms;  ///< raised during the run
  PipelineCounts counts;
  SourceReport source;
  std::map<std::string, std::uint64_t> rejected;  ///< by the source and by the pipeline
  Time started;                                   ///< time of the first event
  double log_s = 0;                               ///< from there to the last event
  RunTimings timings;
  std::vector<Obstacle> obstacles;             ///< at the end
  std::vector<std::filesystem::path> files;    ///< written, relative to the folder, in order
  std::optional<TruthScore> truth;             ///< simulated runs only, but not live ones
  std::optional<DepthOutcome> depth;           ///< if ranges or soundings had a position
  std::optional<VoxelOutcome> voxels;          ///< if there is a voxel map
  std::optional<SphericalOutcome> sphere;      ///< if there is a spherical grid
  std::optional<CornerFixOutcome> corner_fix;  ///< if the configuration asks for fixes by charted corners
  std::optional<ContactOutcome> contacts;      ///< if a passive array heard anything
  std::optional<Sharpness> sharpness;          ///< if a fan moved while it detected something; not in simulated runs
  std::optional<DriftOutcome> drift;           ///< if there is a reference track
  std::optional<MissionOutcome> mission;       ///< if there was a mission
  std::optional<FanDeparture> fan;             ///< if sensor.model names a fan model and pings were decided by it
  std::optional<LiveOutcome> live;             ///< live runs only
  std::optional<AboardOutcome> aboard;         ///< runs on a vehicle only
  std::string map_holds;                       ///< why the map stays as it is: it already holds this log; else empty
  std::string recording_problem;               ///< why the recording ends before the run does; empty: it does not
  std::uint64_t not_recorded = 0;              ///< what came after that
  std::string undecided;                       ///< why the last ping had no decisions; empty: it had
  /// One line if the input itself is wrong (cut in the middle of a record, poses that are not numbers, time that runs
  /// backwards); empty if it is not. The usable part of the input was used.
  std::string problem;
  bool cut = false;     ///< the problem is that the log ends in the middle of a record: all before it was used
  std::string warning;  ///< as `problem`, where less than one event of a hundred was rejected for it
};

}  // namespace isobath

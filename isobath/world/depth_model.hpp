// DepthModel: the depth map of a run, from its first positioned reading to its files.
//
// It starts from a stored map (--map), else from a prior (chart, grid, outline), else empty (ledger S1-26, S1-81). It
// takes ranges and soundings from the pipeline and gives them to the DepthMapper. At the end it commits the map to its
// folder, if it has one, together with the obstacles that were found, as objects (S1-26); depth_pages.hpp draws it.
//
// DepthModel is a level of the world model (S1-01): `level()` holds its six parts, any of which may be replaced before
// the first reading.
//
// The frame W of a run is that of its source. If a stored map is continued, the source is placed in the map's frame
// (`origin`) before its events get here. Errors: throws Error for a map or a prior that cannot be used.
#pragma once

#include <filesystem>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/map/depth/map_folder.hpp>
#include <isobath/perception/depth_mapper.hpp>
#include <isobath/world/depth_prior.hpp>
#include <isobath/world/found_objects.hpp>
#include <isobath/world/result_sinks.hpp>
#include <isobath/world/voxel_model.hpp>
#include <isobath/world/world_configuration.hpp>
#include <isobath/world/world_level.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

class DepthModel final : public SoundingSink {
 public:
  /// `folder`: of the stored map; empty: the map is not stored. `settings`: text of the configuration, which the stored
  /// map keeps.
  explicit DepthModel(const WorldConfiguration& configuration, const std::filesystem::path& folder = {},
                      std::string settings = {});
  ~DepthModel() override;

  /// Origin of the stored map, if there is one.
  [[nodiscard]] std::optional<GeoOrigin> stored_origin() const;
  /// Whether a stored map is continued.
  [[nodiscard]] bool continues() const { return stored_ || continued_; }
  /// Origin of W. Call it before the first reading, which throws Error if only one of input and stored map has an
  /// origin.
  void locate(const std::optional<GeoOrigin>& origin) { origin_ = origin; }
  /// Charts and other priors of the place; used if no stored map is continued.
  void set_prior_files(std::vector<std::string> files) { prior_files_ = std::move(files); }

  void on_range(const RangeReading& reading, const PoseEstimate& pose) override;
  void on_swath(const Swath& swath, const PoseEstimate& pose) override;
  void on_passage(Time time, const Pose& X_WB) override;
  /// Depth of a pixel in the window, if a chart or a depth sonar vouches for it.
  [[nodiscard]] std::optional<double> bottom_depth(const Eigen::Vector2d& north_east) const override;
  /// Call it after the last event. `tops`: what the voxels of the run found to stand; where it reaches higher than the
  /// depth of its pixel by more than the margin, the shallower of the two stands, as depth of a forward sonar.
  void finish(std::span<const ColumnTop> tops = {});
  /// Commits the map to its folder. Does nothing without a folder. `fingerprint`: of the input (fingerprint_of).
  void commit(const std::string& input, const std::string& fingerprint = {});

  [[nodiscard]] WorldLevel& level() { return level_; }
  /// Null before the first reading.
  [[nodiscard]] std::shared_ptr<const DepthSnapshot> snapshot() const {
    return level_.serve ? level_.serve() : nullptr;
  }
  /// Time of the newest reading of a range sonar that looks ahead; empty: none so far.
  [[nodiscard]] std::optional<Time> looked_ahead() const { return looked_ahead_; }
  /// Changes against the charts; known after finish().
  [[nodiscard]] const MapChanges& changes() const { return changes_; }
  [[nodiscard]] const FoundObjects& found() const { return found_; }
  [[nodiscard]] std::vector<SensorLearning::Sensor> sensors() const { return learning_.sensors(); }
  /// Emergency flags of the level's own parts.
  [[nodiscard]] const EmergencyFlags& emergencies() const { return flags_; }
  /// The operator has seen them. Any thread.
  void acknowledge_alarms() { flags_.acknowledge(~std::uint32_t{0}); }
  [[nodiscard]] const DepthCounts& counts() const;
  [[nodiscard]] const MapFacts& facts() const { return facts_; }
  [[nodiscard]] const ReadingEvidenceConfig& evidence() const { return configuration_.depth.evidence; }
  [[nodiscard]] const std::vector<MapDamage>& damages() const { return damages_; }
  [[nodiscard]] const DepthPrior& prior() const { return prior_; }
  /// Highest confidence of a charted depth that no sonar has confirmed.
  [[nodiscard]] int charted_confidence() const { return configuration_.depth.rules.base_prior; }
  [[nodiscard]] std::uint64_t pixels_lost() const { return map_ ? map_->pixels_lost() : 0; }
  /// Tracks of the vehicle in this run; a new one starts after a gap of time.
  [[nodiscard]] const std::vector<std::vector<Eigen::Vector2d>>& tracks() const { return tracks_; }

 private:
  void fill_level();
  void begin(Time time, const Pose& X_WB);
  void refuse_far(const Eigen::Vector2d& start) const;
  void write(const LevelInput& input);
  void keep(const MapVisit& visit);
  void raise(std::span<const ColumnTop> tops);
  std::span<const ModuleStatus> watch(Time now, unsigned worked);

  WorldConfiguration configuration_;
  std::string settings_;
  std::unique_ptr<MapFolder> folder_;
  std::optional<StoredMap> stored_;  ///< until the first reading
  bool continued_ = false;
  std::optional<GeoOrigin> origin_;
  std::vector<std::string> prior_files_;
  DepthPrior prior_;
  MapFacts facts_;
  std::vector<MapDamage> damages_;
  std::unique_ptr<DepthMap> map_;
  std::unique_ptr<DepthMapper> mapper_;
  WorldLevel level_;
  std::unique_ptr<MapPrediction> prediction_;
  SensorLearning learning_;
  std::unique_ptr<StateEvaluator> evaluator_;
  EmergencyFlags flags_;
  MapChanges changes_;
  FoundObjects found_;
  std::vector<std::vector<Eigen::Vector2d>> tracks_;
  std::optional<Time> last_passage_;
  std::optional<Time> first_, last_, looked_ahead_;
};

}  // namespace isobath

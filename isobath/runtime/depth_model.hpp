// DepthModel: the depth map of a run, from its first reading that has a place to its files.
//
// Begins with what there is: a stored map (--map), else a prior (chart, grid, outline), else nothing (ledger S1-26,
// S1-81). Takes ranges and soundings from the pipeline, and gives them to the DepthMapper. At the end the map is
// committed to its folder, if it has one, with the obstacles that were found as objects (S1-26), and drawn.
//
// It is a level of the world model (S1-01): its six parts are `level()`, and any of them may be replaced before the
// first reading.
//
// The frame W of a run is that of its source, unless a stored map is continued: then the source is placed in the map's
// frame (`origin`) before it gets here. Errors: throws Error for a map or a prior that cannot be used.
#pragma once

#include <filesystem>
#include <isobath/map/depth_map.hpp>
#include <isobath/map/map_folder.hpp>
#include <isobath/perception/depth_mapper.hpp>
#include <isobath/runtime/configuration.hpp>
#include <isobath/runtime/depth_prior.hpp>
#include <isobath/runtime/found_objects.hpp>
#include <isobath/runtime/pipeline.hpp>
#include <isobath/runtime/world_level.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace isobath {

class DepthModel final : public SoundingSink {
 public:
  /// `folder`: of the map; empty: it lives as long as the run does.
  DepthModel(const Configuration& configuration, const std::filesystem::path& folder);
  ~DepthModel() override;

  /// Of the stored map, if there is one.
  [[nodiscard]] std::optional<GeoOrigin> stored_origin() const;
  /// Whether a stored map goes on.
  [[nodiscard]] bool continues() const { return stored_ || continued_; }
  /// Where W lies: before the first reading. Throws Error where the stored map lies elsewhere.
  void locate(const std::optional<GeoOrigin>& origin) { origin_ = origin; }
  /// What is known of the place from charts; used when the map is begun anew.
  void set_prior_files(std::vector<std::string> files) { prior_files_ = std::move(files); }

  void on_range(const RangeReading& reading, const PoseEstimate& pose) override;
  void on_swath(const Swath& swath, const PoseEstimate& pose) override;
  void on_passage(Time time, const Pose& X_WB) override;
  /// Of a pixel in the window for which a chart or a depth sonar vouches.
  [[nodiscard]] std::optional<double> bottom_depth(const Eigen::Vector2d& north_east) const override;
  /// After the last event.
  void finish();
  /// Makes what is known the committed state of the folder. Does nothing without one.
  void commit(const std::string& input);

  [[nodiscard]] WorldLevel& level() { return level_; }
  /// Null before the first reading.
  [[nodiscard]] std::shared_ptr<const DepthSnapshot> snapshot() const {
    return level_.serve ? level_.serve() : nullptr;
  }
  /// Against the charts; known after finish().
  [[nodiscard]] const MapChanges& changes() const { return changes_; }
  [[nodiscard]] const FoundObjects& found() const { return found_; }
  [[nodiscard]] std::vector<SensorLearning::Sensor> sensors() const { return learning_.sensors(); }
  /// Of the level's own parts.
  [[nodiscard]] const EmergencyFlags& emergencies() const { return flags_; }
  [[nodiscard]] const DepthCounts& counts() const;
  [[nodiscard]] const MapFacts& facts() const { return facts_; }
  [[nodiscard]] const std::vector<MapDamage>& damages() const { return damages_; }
  [[nodiscard]] const DepthPrior& prior() const { return prior_; }
  /// Confidence of a charted depth at most, before any sonar has spoken.
  [[nodiscard]] int charted_confidence() const { return configuration_.depth.rules.base_prior; }
  [[nodiscard]] std::uint64_t pixels_lost() const { return map_ ? map_->pixels_lost() : 0; }
  /// Where the vehicle went in this run; a new one after a gap of time.
  [[nodiscard]] const std::vector<std::vector<Eigen::Vector2d>>& tracks() const { return tracks_; }

 private:
  void fill_level();
  void begin(Time time, const Pose& X_WB);
  void refuse_far(const Eigen::Vector2d& start) const;
  void write(const LevelInput& input);
  void keep(const std::string& input);
  std::span<const ModuleStatus> watch(Time now, unsigned worked);

  Configuration configuration_;
  std::unique_ptr<MapFolder> folder_;
  std::optional<StoredMap> stored_;  ///< until it is begun
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
  std::optional<Time> first_, last_;
};

}  // namespace isobath

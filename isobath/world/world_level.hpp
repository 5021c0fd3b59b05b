// WorldLevel: one level of the world model as its six parts, each with one function as its interface (Oskard 1990, I;
// ledger S1-01 to S1-06).
//
//   update      the only writer of the map                  serve     one version of the map for planners (data server)
//   predict     the range that a sonar should report        evaluate  whether all parts work (state evaluator)
//   learn       how reliable each sensor is                 store     makes the map persistent (database)
//
// Each part is a function that can be replaced without the others. Without a part (an empty function), its result is
// unknown, and the state evaluator misses its heartbeat. DepthModel sets all six from the configuration. Thread rules
// are those of the parts.
#pragma once

#include <functional>
#include <isobath/map/depth/depth_map.hpp>
#include <isobath/map/depth/map_record.hpp>
#include <isobath/perception/range_prediction.hpp>
#include <isobath/perception/reading_evidence.hpp>
#include <isobath/perception/sensor_reliability.hpp>
#include <isobath/sonar/sensor_table.hpp>
#include <isobath/vehicle/state_evaluator.hpp>
#include <isobath/world/result_sinks.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace isobath {

/// A range or a swath with the pose at its time; without either, only a pose that the vehicle has reached.
struct LevelInput {
  Time time;
  PoseEstimate pose;
  const RangeReading* range = nullptr;
  const Swath* swath = nullptr;
};

struct WorldLevel {
  /// The parts with a heartbeat, in the order of the state evaluator's table.
  enum Part : std::uint8_t { kUpdate, kPrediction, kLearning };
  static const std::vector<WatchedModule>& watched();

  std::function<void(const LevelInput&)> update;
  std::function<std::shared_ptr<const DepthSnapshot>()> serve;
  /// Empty if the map does not know the water in the beam well enough.
  std::function<std::optional<RangePrediction>(const RangeReading&, const Pose& X_WB)> predict;
  std::function<void(const RangeReading&, const std::optional<RangePrediction>&)> learn;
  /// `worked`: one bit for each part that worked at `now`.
  std::function<std::span<const ModuleStatus>(Time now, unsigned worked)> evaluate;
  std::function<void(const MapVisit& visit)> store;

  /// Handles a reading: predicts it from the map so far, compares it, and then updates the map with it.
  void on_input(const LevelInput& input) const;
};

/// Predicts ranges only from bottom that a chart or a depth sonar has confirmed. If any other pixel lies in the beam,
/// there is no prediction. Allocates nothing after the widest beam.
class MapPrediction {
 public:
  MapPrediction(const ReadingEvidenceConfig& config, const PixelGrid& grid)
      : evidence_(config, grid), predictor_(config.deviation, grid) {}
  std::optional<RangePrediction> operator()(const DepthWindow& window, const RangeReading& reading, const Pose& X_WB);

 private:
  ReadingEvidence evidence_;
  RangePredictor predictor_;
  std::vector<float> patch_;
};

/// Reliability counts per sensor. Sensors are identified by their mounting; those beyond the 64th are not counted.
class SensorLearning {
 public:
  explicit SensorLearning(const ReadingEvidenceConfig& config)
      : evidence_(config, {}), gate_(config.gate), deviation_(config.deviation), counts_(SensorTable::kMax) {}
  void operator()(const RangeReading& reading, const std::optional<RangePrediction>& expected);

  struct Sensor {
    Pose X_BS;
    ReliabilityCounts counts;
  };
  [[nodiscard]] std::vector<Sensor> sensors() const;

 private:
  ReadingEvidence evidence_;
  double gate_;
  RangeDeviation deviation_;
  SensorTable table_;
  SensorReliability counts_;
};

/// "ahead, 30 deg to starboard, 5 deg down".
std::string aim_of(const Pose& X_BS);

}  // namespace isobath

// TrueTrack: where a simulated vehicle really went, and how near its hull came to what stands there. For whoever judges
// a closed loop; the vehicle knows nothing of it.
//
// Looked at ten times a second, with every body where it is at that instant. The hull is a level disc of half the
// diagonal of its plan (Simulator::hull_radius) for bodies, and half its height for the bottom: both hold the hull, so
// that what is called clear is clear. A body is asked for its exact distance only where its box is near enough to
// matter; of a mesh that is every triangle.
#pragma once

#include <isobath/runtime/scenario.hpp>
#include <limits>
#include <string>
#include <vector>

namespace isobath {

struct TrackTruth {
  std::vector<TrueMotion> track;    ///< ten a second
  std::vector<double> clearance_m;  ///< from the hull to the nearest body, at each of them; infinite without bodies
  double contact_s = -1;            ///< when the hull first touched a body or the bottom; -1: never
  std::string contact_with;
  double least_clearance_m = std::numeric_limits<double>::infinity();  ///< from the hull to the nearest body, all along
  std::string nearest_body;
  double least_altitude_m = std::numeric_limits<double>::infinity();  ///< of the keel above the bottom
  double length_m = 0;                                                ///< of the track in plan
};

class TrueTrack : public SimulatedSource::TruthSink {
 public:
  explicit TrueTrack(const Simulator& simulator) : simulator_(simulator) {}

  void take(const EchoTruth&) override {}
  void take(const TrueMotion& motion) override;
  [[nodiscard]] const TrackTruth& truth() const { return truth_; }

 private:
  void touch(double t_s, const std::string& what);

  const Simulator& simulator_;
  TrackTruth truth_;
};

}  // namespace isobath

// A helm that always asks for the same, and keeps what it heard.
#pragma once

#include <isobath/onboard/helm.hpp>
#include <limits>
#include <utility>
#include <vector>

namespace isobath::test {

class StraightHelm : public Helm {
 public:
  /// `finish_s`: when it calls its mission finished.
  explicit StraightHelm(const Setpoint& setpoint, double finish_s = std::numeric_limits<double>::infinity())
      : setpoint_(setpoint), finish_s_(finish_s) {}

  void on_event(const Event& event) override {
    heard.emplace_back(event.index(), time_of(event));
    if (to_seconds(time_of(event)) >= finish_s_) report_.phase = MissionPhase::kFinished;
  }
  void on_ping(const PosedPing&) override {}
  void on_scan(const ScanResult&) override { ++scans; }
  [[nodiscard]] Setpoint steer() override { return setpoint_; }
  [[nodiscard]] MissionReport progress() const override { return report_; }
  [[nodiscard]] const std::vector<Decision>& decisions() const override { return decisions_; }

  std::vector<std::pair<std::size_t, Time>> heard;  ///< kind and time of every event
  int scans = 0;

 private:
  Setpoint setpoint_;
  double finish_s_;
  MissionReport report_;
  std::vector<Decision> decisions_;
};

}  // namespace isobath::test

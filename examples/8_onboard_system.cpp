// The whole onboard system with a source and a link of one's own: devices -> maps and agents -> autopilot.
//
// Replace MyDevices::next by what the drivers receive, and MyAutopilot::send by a message to the autopilot. Here the
// devices make up a vehicle that does what it was sent, and a fan of 64 beams that receives a pile in its way.
#include <cstdio>
#include <isobath/base/random.hpp>
#include <isobath/onboard/mission_setup.hpp>
#include <isobath/onboard/onboard.hpp>

using namespace isobath;
using Eigen::Vector3d;

const Vector3d kPile(40, 0.5, 5);  // north, east, depth

struct MyAutopilot {
  Setpoint sent;
  void send(const Setpoint& setpoint) { sent = setpoint; }
};

class MyDevices : public Source {
 public:
  explicit MyDevices(const MyAutopilot& autopilot) : autopilot_(autopilot) {}

  /// Five times a second a fix, a ping, and a report that the vehicle is well.
  std::optional<Event> next() override {
    const Time now(seconds(0.2 * (turn_ / 3)));
    const int turn = turn_++ % 3;
    if (turn == 1) return make_ping(now, fan_, window_, samples());
    if (turn == 2) return Health{now, "vehicle"};
    X_WB.rotation = Rotation::from_heading(autopilot_.sent.heading);
    const Vector3d v_WB = X_WB.rotation * Vector3d(autopilot_.sent.speed, 0, 0);
    X_WB.translation += 0.2 * v_WB;
    return Navigation{.time = now, .X_WB = X_WB, .v_WB = v_WB};
  }
  [[nodiscard]] const SourceReport& report() const override { return report_; }
  Pose X_WB{{}, {0, 0, 5}};

 private:
  /// Noise in every bin of every beam, and a loud echo where the pile is.
  std::vector<std::uint8_t> samples() {
    std::vector<std::uint8_t> all(64 * 120);
    for (auto& sample : all) sample = static_cast<std::uint8_t>(10 * std::hypot(random_.normal(), random_.normal()));
    const Vector3d p_B = X_WB.inverse() * kPile;
    const auto bin = static_cast<std::size_t>(p_B.norm() / window_.bin_m);
    for (std::size_t beam = 0; beam < 64 && bin < 120; ++beam)
      if (std::abs(std::atan2(p_B.y(), p_B.x()) - fan_->azimuth[beam].radians()) < 0.03) all[120 * beam + bin] = 150;
    return all;
  }

  const MyAutopilot& autopilot_;
  std::shared_ptr<const BeamFan> fan_ = even_fan(64, Angle::degrees(120), Angle::degrees(2), Angle::degrees(15));
  RangeWindow window_{.start_m = 0, .bin_m = 0.25, .bins = 120};
  Random random_{1};
  int turn_ = 0;
  SourceReport report_;
};

int main() {
  MyAutopilot autopilot;
  MyDevices devices(autopilot);
  MissionSetup mission;
  mission.plan.points = {{.name = "A", .north_east = {70, 0}, .depth_m = 5}};
  const OnboardConfiguration configuration;
  const auto helm = make_serial_helm(mission, configuration);  // the agents, with the Safety Officer
  DepthModel depths(configuration);
  Onboard onboard(configuration, depths, {.helm = helm.get()});

  double nearest = 1e9;
  while (helm->progress().phase < MissionPhase::kFinished) {
    onboard.on_event(*devices.next());
    autopilot.send(onboard.steer());
    nearest = std::min(nearest, (devices.X_WB.translation - kPile).norm());
  }
  for (const Decision& decision : helm->decisions()) std::printf("%s\n", to_text(decision).c_str());
  std::printf("%s; passed the pile at %.1f m\n", to_text(helm->progress().phase), nearest);
  return helm->progress().phase == MissionPhase::kFinished && nearest > 2 ? 0 : 1;
}

// Bodies that move past a vehicle, as a user meets them: `isobath run` of a scene with traffic.
#include <cmath>
#include <tests/app/program.hpp>
#include <tests/support/data.hpp>

namespace isobath {
namespace {
using testing::HasSubstr;

std::string crossing_traffic() { return (test::source_folder() / "scenarios/crossing_traffic.toml").string(); }
std::vector<std::string> run_into(const std::filesystem::path& out) {
  return {"run", crossing_traffic(), "--out", out.string(), "--set", "simulation.duration_s=36"};
}

// The container drifts west at 60 m in 45 s. Its speed is that of its visible side, which changes as the vehicle comes
// nearer. ledger: S3-04 S3-15
TEST(MovingBodies, CrossWithTheirVelocitiesAndLeaveNoTrail) {
  const auto folder = test::scratch_folder();
  const auto result = test::isobath(run_into(folder / "out"));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("found to move"));
  const auto scans = test::json_of(folder / "out/scans.json");
  int seen = 0, right = 0;
  double last_scan = 0;
  for (const auto& scan : scans["scans"]) {
    last_scan = scan["scan"].get<double>();
    const double t = (last_scan - 1) * 0.5;
    if (t < 8 || t > 25) continue;
    for (const auto& o : scan["obstacles"]) {
      if (!o.contains("motion")) continue;
      ++seen;
      const double speed = o["motion"]["speed"], course = o["motion"]["course_deg"];
      right += std::abs(speed - 60.0 / 45) < 0.4 && std::abs(course - 270) < 15 ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 30);
  EXPECT_GT(right, 0.9 * seen);
  const auto truth = test::json_of(folder / "out/truth.json");
  EXPECT_LT(truth["obstacles"]["false_alarms"].get<double>(), last_scan) << "obstacles of nothing: below one a scan";

  auto without = run_into(folder / "without");
  without.insert(without.end(), {"--set", "bodies.on=false"});
  ASSERT_EQ(test::isobath(without).exit_code, 0);
  const auto trail = test::json_of(folder / "without/truth.json");
  EXPECT_GT(trail["obstacles"]["false_alarms"].get<double>(), 3 * last_scan) << "a map that takes the world for still";
}

}  // namespace
}  // namespace isobath

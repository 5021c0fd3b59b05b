// Vehicle files: what they give, and what they are refused for.
#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <isobath/vehicle/vehicle_model.hpp>
#include <tests/vehicle/models.hpp>

namespace isobath {
namespace {

using testing::HasSubstr;

const char* const kBall = R"([body]
mass = 10
inertia = [0.1, 0.1, 0.1]
volume = 0.01
[water]
added_mass = [[5, 5, 5, 0.01, 0.01, 0.01]]
linear_damping = [[1, 1, 1, 1, 1, 1]]
)";

std::string problem_of(const std::string& text) {
  try {
    parse_vehicle(text, "ball.toml");
  } catch (const Error& e) {
    return e.what();
  }
  return "none";
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

// ledger: S7-13
TEST(VehicleModel, ReadsATorpedoAndABox) {
  const VehicleModel torpedo = test::remus(), box = test::rov();
  EXPECT_EQ(torpedo.fins.size(), 4u);
  EXPECT_EQ(box.thrusters.size(), 8u);
  // Newtons and degrees of the publications, from kilograms, cubic metres and radians.
  EXPECT_NEAR(torpedo.mass * kGravity, 299, 0.01);
  EXPECT_NEAR(torpedo.volume * torpedo.reference_density * kGravity, 306, 0.01);
  EXPECT_NEAR(torpedo.fins[0].max_deflection.radians(), 0.349066, 1e-6);
  EXPECT_NEAR(box.thrusters[1].direction_B.norm(), 1, 1e-15);
  for (const VehicleModel& m : {torpedo, box}) {
    const Matrix6 M = mass_matrix(m, m.reference_density);
    EXPECT_EQ(M, M.transpose());
    EXPECT_GT(M.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), 0);
  }
}

// Prestero's sums of lift, Munk moment and added-mass cross terms come back. ledger: S7-13 S7-02
TEST(VehicleModel, GivesThePublishedSumsOfTheTorpedo) {
  const VehicleModel m = test::remus();
  const auto wrench = [&](const Vector6& v) {
    return Vector6(test::damping_wrench(m, v) - test::coriolis(m.added_mass, v) * v);
  };
  const auto bilinear = [&](int row, int a, int b) {  // coefficient of v_a v_b in `row`, both positive
    Vector6 both = Vector6::Zero(), first = both, second = both;
    both(a) = first(a) = both(b) = second(b) = 1;
    return (wrench(both) - wrench(first) - wrench(second))(row);
  };
  EXPECT_NEAR(bilinear(1, 0, 1), -28.6, 1e-9);  // Y_uv
  EXPECT_NEAR(bilinear(2, 0, 2), -28.6, 1e-9);  // Z_uw
  EXPECT_NEAR(bilinear(4, 0, 2), 24.0, 1e-9);   // M_uw
  EXPECT_NEAR(bilinear(5, 0, 1), -24.0, 1e-9);  // N_uv
  EXPECT_NEAR(bilinear(1, 0, 5), 5.22, 1e-9);   // Y_ur
  EXPECT_NEAR(bilinear(2, 0, 4), -5.22, 1e-9);  // Z_uq
  EXPECT_NEAR(bilinear(4, 0, 4), -2.00, 1e-9);  // M_uq
  EXPECT_NEAR(bilinear(5, 0, 5), -2.00, 1e-9);  // N_ur
  EXPECT_NEAR(bilinear(0, 2, 4), -35.5, 1e-9);  // X_wq
  EXPECT_NEAR(bilinear(0, 1, 5), 35.5, 1e-9);   // X_vr
  EXPECT_NEAR(bilinear(1, 2, 3), 35.5, 1e-9);   // Y_wp
  EXPECT_NEAR(bilinear(2, 1, 3), -35.5, 1e-9);  // Z_vp
  EXPECT_NEAR(bilinear(4, 3, 5), 4.86, 0.06);   // M_rp: printed 4.86; K_dp - N_dr is 4.81
  EXPECT_NEAR(bilinear(5, 3, 4), -4.86, 0.06);  // N_pq
}

// ledger: S7-13
TEST(VehicleModel, RefusesWhatIsNotPhysicalWithItsLine) {
  EXPECT_EQ(problem_of(kBall), "none");
  EXPECT_THAT(problem_of(changed(kBall, "[[5, 5, 5, 0.01", "[[-20, 5, 5, 0.01")),
              HasSubstr("ball.toml:5:1: water.added_mass: the mass matrix with added mass is not positive definite"));
  EXPECT_THAT(problem_of(changed(kBall, "inertia = [0.1", "gravity_centre = [0, 0, 0.2]\ninertia = [0.1")),
              HasSubstr("ball.toml:1:1: body.inertia: the rigid-body mass matrix is not positive definite"));
  EXPECT_THAT(problem_of(changed(kBall, "[[1, 1, 1, 1", "[[1, -1, 1, 1")),
              HasSubstr("linear damping is not dissipative"));
  EXPECT_THAT(problem_of(std::string(kBall) + "quadratic_damping = [[1, 1, 1, 1, 1, -1]]"),
              HasSubstr("quadratic damping is not dissipative"));
  EXPECT_THAT(problem_of(std::string(kBall) + "lift_damping = [[0,0,0,0,0,0], [0,1,0,0,0,5], [0,0,0,0,0,0], "
                                              "[0,0,0,0,0,0], [0,0,0,0,0,0], [0,0,0,0,0,1]]"),
              HasSubstr("lift damping is not dissipative"));
  EXPECT_THAT(problem_of(changed(kBall, "[[1, 1, 1, 1, 1, 1]]", "[[1, 1, 1, 1, 1, 1], [1, 1, 1, 1, 1, 1]]")),
              HasSubstr("water.linear_damping: 2 rows; allowed: 1 row (the diagonal) or 6 rows"));
  EXPECT_THAT(problem_of(""), HasSubstr("ball.toml: body: no mass"));
}

// ledger: S7-13
TEST(VehicleModel, SaysWhatIsWrongInTheFile) {
  EXPECT_THAT(problem_of(changed(kBall, "mass = 10", "mass = -10")), HasSubstr("ball.toml:2:8: body.mass"));
  EXPECT_THAT(problem_of(changed(kBall, "mass = 10", "mass = nan")), HasSubstr("ball.toml:2:8: body.mass"));
  EXPECT_THAT(problem_of(changed(kBall, "[[5, 5, 5", "[[5, nan, 5")), HasSubstr("ball.toml:6:14: water.added_mass"));
  EXPECT_THAT(problem_of(changed(kBall, "inertia = [0.1", "inertia = [inf")),
              HasSubstr("ball.toml:3:11: body.inertia"));
  EXPECT_THAT(problem_of(changed(kBall, "volume", "volumen")), HasSubstr("did you mean volume?"));
  EXPECT_THAT(problem_of(std::string(kBall) + "[[thruster]]\nname = \"dead\"\n"),
              HasSubstr("ball.toml:8:1: thruster: the thruster has no thrust"));
  EXPECT_THAT(problem_of(std::string(kBall) + "[[fin]]\nlift = 2\ndirection = [0, 0, 0]\nmax_deflection_deg = 9\n"),
              HasSubstr("ball.toml:8:1: fin: the fin has no lift, no deflection or no direction"));
  EXPECT_THROW(load_vehicle("/nowhere/vehicle.toml"), Error);
}

}  // namespace
}  // namespace isobath

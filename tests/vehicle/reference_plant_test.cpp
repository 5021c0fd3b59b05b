// VehicleDynamics against the published equations of the REMUS 100 in another form (Euler angles, scalar equations), by
// an integrator of its own: CVODE of SUNDIALS where it is installed, else Runge-Kutta at a fortieth of the step.
#include <gtest/gtest.h>
#include <isobath/vehicle/dynamics.hpp>
#include <tests/vehicle/fossen.hpp>
#ifdef ISOBATH_HAS_SUNDIALS
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#endif

namespace isobath::reference_plant_test {
namespace {

using test::PublishedRemus;

#ifdef ISOBATH_HAS_SUNDIALS
int published_rate(realtype, N_Vector x, N_Vector rate, void* plant) {
  PublishedRemus::State state;
  std::copy_n(N_VGetArrayPointer(x), state.size(), state.begin());
  const PublishedRemus::State derivative = static_cast<const PublishedRemus*>(plant)->rate(state);
  std::copy(derivative.begin(), derivative.end(), N_VGetArrayPointer(rate));
  return 0;
}

PublishedRemus::State integrated(PublishedRemus plant, PublishedRemus::State x, double seconds) {
  SUNContext context = nullptr;
  EXPECT_EQ(SUNContext_Create(nullptr, &context), 0);
  N_Vector state = N_VMake_Serial(static_cast<sunindextype>(x.size()), x.data(), context);
  void* solver = CVodeCreate(CV_ADAMS, context);
  SUNNonlinearSolver iteration = nullptr;
  EXPECT_EQ(CVodeInit(solver, published_rate, 0, state), 0);
  EXPECT_EQ(CVodeSStolerances(solver, 1e-11, 1e-12), 0);
  EXPECT_EQ(CVodeSetUserData(solver, &plant), 0);
  EXPECT_EQ(CVodeSetMaxNumSteps(solver, 1'000'000), 0);
  iteration = SUNNonlinSol_FixedPoint(state, 0, context);
  EXPECT_EQ(CVodeSetNonlinearSolver(solver, iteration), 0);
  realtype reached = 0;
  EXPECT_EQ(CVode(solver, seconds, state, &reached, CV_NORMAL), 0);
  SUNNonlinSolFree(iteration);
  CVodeFree(&solver);
  N_VDestroy(state);
  SUNContext_Free(&context);
  return x;
}
#else
PublishedRemus::State integrated(const PublishedRemus& plant, PublishedRemus::State x, double seconds) {
  constexpr double kDt = 5e-4;
  const auto moved = [](PublishedRemus::State at, const PublishedRemus::State& rate, double dt) {
    for (std::size_t i = 0; i < at.size(); ++i) at[i] += dt * rate[i];
    return at;
  };
  for (int k = 0; k < static_cast<int>(seconds / kDt + 0.5); ++k) {
    const auto k1 = plant.rate(x), k2 = plant.rate(moved(x, k1, kDt / 2)), k3 = plant.rate(moved(x, k2, kDt / 2));
    const auto k4 = plant.rate(moved(x, k3, kDt));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += kDt / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
  }
  return x;
}
#endif

/// The same run by VehicleDynamics, without actuator lags.
VehicleState simulated(const PublishedRemus& plant, double seconds) {
  VehicleModel model = test::remus();
  for (Thruster& t : model.thrusters) t.time_constant = 0;
  for (Fin& f : model.fins) f.time_constant = 0;
  VehicleDynamics dynamics(model, test::at_speed(1.5));
  ActuatorVector commands(5);
  commands << plant.thrust, plant.rudder, plant.rudder, plant.stern, plant.stern;
  constexpr double kDt = 0.02;
  for (int i = 0; i < static_cast<int>(seconds / kDt + 0.5); ++i) dynamics.step(commands, {1030, {0, 0, 0}}, kDt);
  return dynamics.state();
}

// Rudder, stern planes, propeller torque and trim together: all six axes move. The vehicle is unstable, so that an
// error grows by exp(1.1 t); its last digits in print (W, B and the torque to three) leave 1e-4. ledger: S7-01 S7-02
// S7-03
TEST(ReferencePlant, MovesAsThePublishedEquationsDo) {
  for (const auto& [rudder, stern] : {std::pair{0.0, 0.0}, std::pair{8.0, 0.0}, std::pair{-12.0, 4.0}}) {
    PublishedRemus plant;
    plant.rudder = Angle::degrees(rudder).radians();
    plant.stern = Angle::degrees(stern).radians();
    constexpr double kSeconds = 8;
    const PublishedRemus::State x = integrated(plant, {0, 0, 10, 0, 0, 0, 1.5, 0, 0, 0, 0, 0}, kSeconds);
    const VehicleState s = simulated(plant, kSeconds);
    EXPECT_LT((s.X_WB.translation - Eigen::Vector3d(x[0], x[1], x[2])).norm(), 0.02) << rudder << ' ' << stern;
    EXPECT_LT((s.v_B - Eigen::Vector3d(x[6], x[7], x[8])).norm(), 0.01) << rudder << ' ' << stern;
    EXPECT_LT((s.w_B - Eigen::Vector3d(x[9], x[10], x[11])).norm(), 0.01) << rudder << ' ' << stern;
    EXPECT_NEAR(s.X_WB.rotation.heading().wrapped().radians(), Angle::radians(x[5]).wrapped().radians(), 0.01);
  }
}

}  // namespace
}  // namespace isobath::reference_plant_test

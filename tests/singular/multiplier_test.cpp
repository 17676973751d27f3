// SPDX-License-Identifier: GPL-2.0-or-later
// Motions by generated code against the full equations with multipliers, differentiated until they give the
// accelerations:
//
//   | M  A^T | | v_dot  |   | f - M_a r_a_ddot    |
//   | A   0  | | -lambda| = | -bias - B r_a_ddot  |
//
// M, f and the rows from the numeric recursion, all velocities as the state, no kernel. Nothing keeps the
// rows but their second derivatives, so the comparison is over times in which that drift is small.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/specialise.hpp"
#include "simulate/columns.hpp"
#include "simulate/groups.hpp"
#include "simulate/integrators.hpp"
#include "simulate/scene_program.hpp"
#include "simulate/simulation.hpp"

namespace anholon::multiplier_test {
namespace {

using testing::column_index;

/// A scene's motion by the full equations; y = (r_p, r_d, eta, r_p_dot, r_d_dot).
class MultiplierMotion {
 public:
  explicit MultiplierMotion(const Scene& scene)
      : scene_(scene),
        model_(specialise(scene.model, scene)),
        partition_(partition_of(model_, {scene.torque_driven.begin(), scene.torque_driven.end()})),
        mechanism_(mechanise<double>(describe_mechanism(model_), parameters())),
        dynamics_(mechanism_) {}

  /// The state that a row of a trajectory shows, and the last pose and velocities of it by the full
  /// equations.
  template <class G>
  Eigen::VectorXd run(const SimulationResult& trajectory, double tolerance) {
    integrate::State<G> state;
    state.t = 0;
    state.g = pose<G>(trajectory, 0);
    state.y = velocities_and_shape(trajectory, 0);
    integrate::AdaptiveOptions<double> options;
    options.rtol = options.atol = tolerance;
    const Field<G> field{[this](double t, const G& g, const Eigen::VectorXd& y, typename G::Tangent& eta,
                                Eigen::VectorXd& y_dot) { rates<G>(t, g, y, eta, y_dot); },
                         {}};
    const auto outcome = integrate_adaptive<G>(field, state, scene_.duration, options, [](const auto&) {});
    EXPECT_TRUE(static_cast<bool>(outcome));
    Eigen::VectorXd end(12 + state.y.size());
    const auto R = state.g.R();
    const auto p = state.g.p();
    for (int i = 0; i < 9; ++i) end(i) = R(i / 3, i % 3);
    for (int i = 0; i < 3; ++i) end(9 + i) = p(i);
    end.tail(state.y.size()) = state.y;
    return end;
  }

  /// The same list at the last row of a trajectory.
  template <class G>
  Eigen::VectorXd end_of(const SimulationResult& trajectory) {
    const std::size_t last = trajectory.rows.size() - 1;
    const Eigen::VectorXd y = velocities_and_shape(trajectory, last);
    const G g = pose<G>(trajectory, last);
    Eigen::VectorXd end(12 + y.size());
    const auto R = g.R();
    const auto p = g.p();
    for (int i = 0; i < 9; ++i) end(i) = R(i / 3, i % 3);
    for (int i = 0; i < 3; ++i) end(9 + i) = p(i);
    end.tail(y.size()) = y;
    return end;
  }

  [[nodiscard]] const Model& model() const { return model_; }

 private:
  std::vector<double> parameters() const {
    std::vector<double> values;
    for (const Parameter& p : model_.parameters) values.push_back(p.value.to_double());
    return values;
  }

  template <class G>
  G pose(const SimulationResult& trajectory, std::size_t row) const {
    const auto value = [&](const std::string& name) {
      return trajectory.rows[row][column_index(trajectory, name)];
    };
    if constexpr (std::is_same_v<G, lie::SE2<double>>) {
      return G(value("x"), value("y"), value("theta"));
    } else {
      Eigen::Matrix3d R;
      for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = value(std::string("R_") + "XYZ"[i / 3] + "XYZ"[i % 3]);
      const Eigen::Quaterniond turn(R);
      const Eigen::Vector4d q(turn.w(), turn.x(), turn.y(), turn.z());
      if constexpr (std::is_same_v<G, lie::SO3<double>>) {
        return G(q);
      } else {
        return G(q, Eigen::Vector3d(value("p_X"), value("p_Y"), value("p_Z")));
      }
    }
  }

  Eigen::VectorXd velocities_and_shape(const SimulationResult& trajectory, std::size_t row) const {
    const auto value = [&](const std::string& name) {
      return trajectory.rows[row][column_index(trajectory, name)];
    };
    const auto names = velocity_names(model_);
    std::vector<double> y;
    for (const int i : partition_.passive) {
      if (i >= partition_.n) y.push_back(value(names[static_cast<std::size_t>(i)]));
    }
    for (const int i : partition_.passive) {
      const std::string& name = names[static_cast<std::size_t>(i)];
      y.push_back(value(i < partition_.n ? name : "dot(" + name + ")"));
    }
    return Eigen::Map<const Eigen::VectorXd>(y.data(), static_cast<Eigen::Index>(y.size()));
  }

  template <class G>
  void rates(double t, const G& g, const Eigen::VectorXd& y, typename G::Tangent& eta,
             Eigen::VectorXd& y_dot) {
    const auto n = static_cast<std::size_t>(partition_.n);
    const auto shape = static_cast<Eigen::Index>(partition_.passive.size() - n);
    State<double> s;
    s.t = t;
    const auto R = g.R();
    const auto p = g.p();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) s.R(i, j) = R(i, j);
      s.p[i] = p(i);
    }
    s.r.assign(model_.coordinates.size(), 0), s.r_dot = s.r;
    std::vector<double> r_ddot(model_.coordinates.size(), 0);
    std::vector<double> inputs(scene_.model.tape->inputs().size(), 0);
    inputs[scene_.model.tape->node(scene_.model.symbols.t).a] = t;
    for (std::size_t i = 0; i < scene_.model.parameters.size(); ++i)
      inputs[scene_.model.tape->node(scene_.model.symbols.parameters[i]).a] =
          scene_.model.parameters[i].value.to_double();
    for (const ImposedMotion& m : scene_.motion) {  // the scenes here lock nothing: the same coordinates
      const auto at = static_cast<std::size_t>(m.coordinate);
      const auto of = [&](const Expr& e) {
        return interpret<double>(*scene_.model.tape, {e.id(*scene_.model.tape)}, inputs).front();
      };
      s.r[at] = of(m.r), s.r_dot[at] = of(m.r_dot), r_ddot[at] = of(m.r_ddot);
    }
    const auto components = free_components(model_.group);
    for (std::size_t i = 0; i < partition_.passive.size(); ++i) {
      const int velocity = partition_.passive[i];
      const double rate = y(shape + static_cast<Eigen::Index>(i));
      if (velocity < partition_.n) {
        s.eta[components[static_cast<std::size_t>(velocity)]] = rate;
        eta(velocity) = rate;
      } else {
        const auto at = static_cast<std::size_t>(velocity - partition_.n);
        s.r[at] = y(static_cast<Eigen::Index>(i - n)), s.r_dot[at] = rate;
        y_dot(static_cast<Eigen::Index>(i - n)) = rate;
      }
    }
    const Matrix<double> M = dynamics_.mass_matrix(s);
    const std::vector<double> f = dynamics_.forces(s);
    const auto [G_rows, bias] = dynamics_.constraints(s);
    const auto size = static_cast<Eigen::Index>(partition_.passive.size());
    const Eigen::Index rows = G_rows.rows();
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size + rows, size + rows);
    Eigen::VectorXd b(size + rows);
    const auto velocity = [&](Eigen::Index i) { return partition_.passive[static_cast<std::size_t>(i)]; };
    for (Eigen::Index i = 0; i < size; ++i) {
      b(i) = f[static_cast<std::size_t>(velocity(i))];
      for (Eigen::Index j = 0; j < size; ++j) K(i, j) = M(velocity(i), velocity(j));
      for (const int a : partition_.active)
        b(i) -= M(velocity(i), a) * r_ddot[static_cast<std::size_t>(a) - n];
      for (Eigen::Index j = 0; j < rows; ++j)
        K(i, size + j) = K(size + j, i) = G_rows(static_cast<int>(j), velocity(i));
    }
    for (Eigen::Index j = 0; j < rows; ++j) {
      b(size + j) = -bias[static_cast<std::size_t>(j)];
      for (const int a : partition_.active)
        b(size + j) -= G_rows(static_cast<int>(j), a) * r_ddot[static_cast<std::size_t>(a) - n];
    }
    y_dot.tail(size) = K.fullPivLu().solve(b).head(size);
  }

  const Scene& scene_;
  Model model_;
  Partition partition_;
  Mechanism<double> mechanism_;
  FreeDynamics<double> dynamics_;
};

template <class G>
double difference(const Scene& scene, double tolerance) {
  const SimulationResult result = simulate_scene(scene);
  EXPECT_TRUE(result.finished) << result.status;
  MultiplierMotion full(scene);
  const Eigen::VectorXd a = full.run<G>(result, tolerance), b = full.end_of<G>(result);
  return (a - b).cwiseAbs().maxCoeff();
}

Scene changed(const std::string& model, const std::string& lines) {
  const std::string folder = std::string(ANHOLON_SOURCE_DIR) + "/models/" + model + "/";
  return read_scene_text("anholon = 1\nname = \"test\"\nmodel = \"" + model + ".toml\"\n" + lines,
                         folder + "test.scene.toml");
}

// Both integrated at 1e-12 a step; the bound is that of the issue, m, rad and their rates.
TEST(MultiplierEquations, GiveTheMotionOfTheRigidSnakeboard) {
  EXPECT_LT(difference<lie::SE2<double>>(testing::scene_of("rigid_snakeboard/gait"), 1e-12), 1e-9);
}

TEST(MultiplierEquations, GiveTheMotionOfTheSoftSnakeboard) {
  EXPECT_LT(difference<lie::SE2<double>>(testing::scene_of("soft_snakeboard/gait"), 1e-12), 1e-9);
}

// Torque-driven, through its straight shape.
TEST(MultiplierEquations, GiveTheMotionOfTheTorqueDrivenSnake) {
  const Scene scene = changed(
      "wheeled_snake3",
      "torque_driven = \"all\"\n"
      "initial = { coordinates = { r1 = 0.3, r2 = 0.3 }, velocities = { V_X = 0.8, Omega_Z = 0.5 } }\n"
      "duration = 1.5\nintegrator = { method = \"dopri5\", tolerance = 1e-12 }\n");
  EXPECT_LT(difference<lie::SE2<double>>(scene, 1e-12), 1e-9);
}

// The driven snake has no reduced velocities: the multipliers carry everything.
TEST(MultiplierEquations, GiveTheMotionOfTheDrivenSnake) {
  Scene scene = testing::scene_of("wheeled_snake3/serpent");
  scene.integrator.tolerance = 1e-12;
  EXPECT_LT(difference<lie::SE2<double>>(scene, 1e-12), 1e-9);
}

// A second of the rattleback: it pitches some twenty times.
TEST(MultiplierEquations, GiveTheMotionOfTheRattleback) {
  Scene scene = testing::scene_of("rattleback/reversal");
  scene.duration = 1;
  scene.output_times = {1.0};
  EXPECT_LT(difference<lie::SE3<double>>(scene, 1e-13), 1e-9);
}

// Through several charts of the kernel.
TEST(MultiplierEquations, GiveTheMotionOfTheBodyWithoutSpin) {
  Scene scene = read_scene(std::string(ANHOLON_SOURCE_DIR) + "/tests/singular/tumble.scene.toml");
  scene.integrator.tolerance = 1e-12;
  scene.duration = 3;
  scene.output_times = {3.0};
  EXPECT_LT(difference<lie::SO3<double>>(scene, 1e-12), 1e-9);
}

}  // namespace
}  // namespace anholon::multiplier_test

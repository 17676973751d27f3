// SPDX-License-Identifier: GPL-2.0-or-later
//
// The rows of declared contacts against geometry that knows nothing of them: the lowest point of the rolling
// surface is found by search, the material velocity there by difference, and the drift of rows by difference
// along a motion.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <functional>

#include "anholon/free_dynamics.hpp"
#include "anholon/lie/se3.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "reduce/decompositions.hpp"
#include "reduce/samples.hpp"

namespace anholon::test::geometry_test {
namespace {

using Values = std::vector<Exact>;

std::vector<Exact> parameters_of(const Model& model) {
  std::vector<Exact> values;
  for (const Parameter& p : model.parameters) values.push_back(p.value);
  return values;
}

/// exp of the rotation vector a, by the series: a is small.
Mat3<Exact> small_turn(const Vec3<Exact>& a) {
  Mat3<Exact> sum = Mat3<Exact>::identity(), term = sum;
  for (int k = 1; k < 12; ++k) {
    term = (Exact(1) / Exact(k)) * (term * skew(a));
    sum = sum + term;
  }
  return sum;
}

/// The configuration after a short time at a constant body twist and constant rates, to the second order of
/// h.
State<Exact> moved(const State<Exact>& state, const Exact& h) {
  State<Exact> next = state;
  const Vec3<Exact> turn = h * state.eta.angular;
  next.R = state.R * small_turn(turn);
  next.p += state.R * (h * state.eta.linear + (h / Exact(2)) * cross(turn, state.eta.linear));
  for (std::size_t i = 0; i < state.r.size(); ++i) next.r[i] = state.r[i] + h * state.r_dot[i];
  next.t = state.t + h;
  return next;
}

/// Rows at a state's velocity.
Values rows_at(FreeDynamics<Exact>& dynamics, const State<Exact>& at, const State<Exact>& velocity) {
  const auto [G, bias] = dynamics.constraints(at);
  Values result(bias.size(), Exact(0));
  int column = 0;
  for (int c = 0; c < 6; ++c, ++column) {
    for (int i = 0; i < G.rows(); ++i) result[static_cast<std::size_t>(i)] += G(i, column) * velocity.eta[c];
  }
  for (const Exact& rate : velocity.r_dot) {
    for (int i = 0; i < G.rows(); ++i) result[static_cast<std::size_t>(i)] += G(i, column) * rate;
    ++column;
  }
  return result;
}

/// Arms with a loop, a foot or a wheel of each kind; the contact is put in.
std::string described(const std::string& contact) {
  return R"(anholon = 1
name  = "arms"
group = "SE3"
[[body]]
name = "hull"
inertia = { mass = 2, about_com = { xx = 1, yy = 1.5, zz = 1.2 } }
[[body]]
name = "left"
parent = "hull"
pose = { translation = [0.3, 0.1, -0.2], rotation = { axis = "x", angle = 0.4 } }
joint = { kind = "revolute", axis = [0, 3, 4], coordinate = "a", drive = "active" }
inertia = { mass = 1, com = [0.1, 0, 0.2], about_com = { xx = 0.2, yy = 0.3, zz = 0.25 } }
[[body]]
name = "right"
parent = "hull"
pose = { translation = [-0.2, 0.1, 0.1] }
joint = { kind = "revolute", axis = [0, 1, 0], coordinate = "b" }
inertia = { mass = 1, com = [0, 0.1, 0.2], about_com = { xx = 0.2, yy = 0.3, zz = 0.25 } }
[[constraint]]
)" + contact;
}

struct Case {
  std::string name, text;  // of a model; empty: a shipped one
};

class ContactGeometryOf : public ::testing::TestWithParam<Case> {
 protected:
  static Model read(const Case& c) {
    if (!c.text.empty()) return read_model_text(described(c.text), c.name + ".toml");
    return read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + c.name + "/" + c.name + ".toml");
  }
  Model model = read(GetParam());
  Mechanism<Exact> mechanism = mechanise<Exact>(describe_mechanism(model), parameters_of(model));
  FreeDynamics<Exact> dynamics{mechanism};
  SampleSource source;
};

TEST_P(ContactGeometryOf, BiasIsTheRateOfTheRowsAtConstantVelocities) {
  const WorkingDigits digits(60);
  const Exact h = Exact::from_decimal("1e-18");
  for (int sample = 0; sample < 10; ++sample) {
    const State<Exact> state = random_state(model, source);
    const Values bias = dynamics.constraints(state).second;
    const Values later = rows_at(dynamics, moved(state, h), state);
    const Values earlier = rows_at(dynamics, moved(state, -h), state);
    for (std::size_t i = 0; i < bias.size(); ++i) {  // the quotient errs by h^2 and by 1e-60/h
      EXPECT_LT(abs((later[i] - earlier[i]) / (h + h) - bias[i]).to_double(), 1e-30);
    }
  }
}

TEST_P(ContactGeometryOf, ConditionsOnThePositionMoveWithTheRows) {
  const WorkingDigits digits(60);
  const Exact h = Exact::from_decimal("1e-18");
  ASSERT_FALSE(model.positions.empty());
  for (int sample = 0; sample < 10; ++sample) {
    const State<Exact> state = random_state(model, source);
    const auto [value, slopes] = dynamics.conditions(state);
    const Values later = dynamics.conditions(moved(state, h)).first;
    const Values earlier = dynamics.conditions(moved(state, -h)).first;
    for (std::size_t i = 0; i < value.size(); ++i) {
      Exact rate = 0;
      int column = 0;
      for (int c = 0; c < 6; ++c) rate += slopes(static_cast<int>(i), column++) * state.eta[c];
      for (const Exact& r : state.r_dot) rate += slopes(static_cast<int>(i), column++) * r;
      EXPECT_LT(abs((later[i] - earlier[i]) / (h + h) - rate).to_double(), 1e-30);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Contacts, ContactGeometryOf,
    ::testing::Values(
        Case{"rolling_disc", ""}, Case{"rattleback", ""}, Case{"ball_on_incline", ""},
        Case{"whipple_bicycle", ""},
        Case{"crowned_wheel", "kind = 'wheel'\nwheel = 'right'\nradius = 0.2\ncrown = 0.03"},
        Case{"mecanum_wheel", "kind = 'rollers'\nwheel = 'right'\nradius = 0.2\nroller_angle = 'pi/4'"},
        Case{"point", "kind = 'point'\nbody = 'left'\npoint = [0.1, 0.2, 0.3]"},
        Case{"line", "kind = 'line'\nbody = 'left'\npoint = [0.1, 0.2, 0.3]\nalong = [1, 2, 2]"},
        Case{"surface", "kind = 'surface'\nbody = 'left'\npoint = [0.1, 0.2, 0.3]"},
        Case{"ball_loop",
             "kind = 'loop'\njoint = 'ball'\nbody = 'left'\nother = 'right'\npoint = [0.1, 0.2, 0.3]"},
        Case{"hinge_loop",
             "kind = 'loop'\njoint = 'revolute'\nbody = 'left'\nother = 'right'\naxis = [0, 3, "
             "4]\nother_axis = [0, 1, 0]"},
        Case{"fixed_loop", "kind = 'loop'\njoint = 'fixed'\nbody = 'left'\nother = 'right'"},
        Case{"rod",
             "kind = 'loop'\njoint = 'rod'\nlength = 0.6\nbody = 'left'\nother = 'right'\nother_point = [0, "
             "0, 0.3]"}),
    [](const auto& info) { return info.param.name; });

// A motion that the rows allow keeps the conditions: the slopes are combinations of the rows.
TEST_P(ContactGeometryOf, MotionsThatTheRowsAllowKeepTheConditions) {
  for (int sample = 0; sample < 5; ++sample) {
    const State<Exact> state = random_state(model, source);
    const auto [G, bias] = dynamics.constraints(state);
    const auto slopes = dynamics.conditions(state).second;
    Eigen::MatrixXd rows(G.rows(), G.cols()), both(G.rows() + slopes.rows(), G.cols());
    for (int i = 0; i < G.rows(); ++i) {
      for (int j = 0; j < G.cols(); ++j) rows(i, j) = G(i, j).to_double();
    }
    both.topRows(rows.rows()) = rows;
    for (int i = 0; i < slopes.rows(); ++i) {
      for (int j = 0; j < G.cols(); ++j) both(G.rows() + i, j) = slopes(i, j).to_double();
    }
    const auto rank = [](const Eigen::MatrixXd& m) {
      const Eigen::VectorXd sigma = singular_values(m).sigma;
      // Entries are of size one, rounding 1e-16; orientations are orthogonal to 1e-16.
      return (sigma.array() > 1e-10 * sigma(0)).count();
    };
    EXPECT_EQ(rank(both), rank(rows));
  }
}

using Point = std::array<long double, 3>;

/// The least of f over two angles, by search on ever finer grids around the best point.
std::array<long double, 2> least(const std::function<long double(long double, long double)>& f) {
  std::array<long double, 2> best = {0, 0};
  long double lowest = f(0, 0);
  long double reach = 3.2L;
  for (int round = 0; round < 60; ++round, reach *= 0.6L) {
    const std::array<long double, 2> centre = best;
    for (int i = -12; i <= 12; ++i) {
      for (int j = -12; j <= 12; ++j) {
        const std::array<long double, 2> x = {centre[0] + reach * i / 12, centre[1] + reach * j / 12};
        if (const long double here = f(x[0], x[1]); here < lowest) best = x, lowest = here;
      }
    }
  }
  return best;
}

long double number(const Exact& x) { return FromExact<long double>{}(x); }

/// A body's rolling surface, as a point of its frame for two angles.
struct Surface {
  std::string model;
  std::function<Point(long double, long double)> point;
};

class LowestPoint : public ::testing::TestWithParam<Surface> {};

TEST_P(LowestPoint, HasTheMaterialVelocityOfTheRowsAndTheHeightOfTheCondition) {
  const Surface& surface = GetParam();
  const Model model = read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + surface.model + "/" +
                                 surface.model + ".toml");
  const Mechanism<Exact> mechanism = mechanise<Exact>(describe_mechanism(model), parameters_of(model));
  FreeDynamics<Exact> dynamics{mechanism};
  SampleSource source;
  for (int sample = 0; sample < 4; ++sample) {
    const State<Exact> state = random_state(model, source);
    const Point up = {number(state.R(2, 0)), number(state.R(2, 1)), number(state.R(2, 2))};
    const long double origin = number(state.p.z);
    const auto height = [&](long double u, long double v) {
      const Point x = surface.point(u, v);
      return origin + up[0] * x[0] + up[1] * x[1] + up[2] * x[2];
    };
    const auto angles = least(height);
    const Point x = surface.point(angles[0], angles[1]);
    // Near the minimum the height is flat: the search finds the place to about the root of the rounding,
    // 1e-9.
    EXPECT_NEAR(static_cast<double>(height(angles[0], angles[1])),
                dynamics.conditions(state).first[0].to_double(), 1e-15);
    const Values rows = rows_at(dynamics, state, state);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      const auto w = [&](std::size_t c) { return number(state.eta.angular[static_cast<int>(c)]); };
      const long double v = number(state.eta.linear[static_cast<int>(i)]) + w(j) * x[k] - w(k) * x[j];
      EXPECT_NEAR(static_cast<double>(v), rows[i].to_double(), 1e-8);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, LowestPoint,
                         ::testing::Values(Surface{"rolling_disc",
                                                   [](long double u, long double) {
                                                     return Point{0.4L * std::cos(u), 0, 0.4L * std::sin(u)};
                                                   }},
                                           Surface{"rattleback",
                                                   [](long double u, long double v) {
                                                     return Point{0.1L * std::cos(u) * std::cos(v),
                                                                  0.02L * std::sin(u) * std::cos(v),
                                                                  0.008L + 0.02L * std::sin(v)};
                                                   }},
                                           Surface{"ball_on_incline",
                                                   [](long double u, long double v) {
                                                     return Point{0.05L * std::cos(u) * std::cos(v),
                                                                  0.05L * std::sin(u) * std::cos(v),
                                                                  0.05L * std::sin(v)};
                                                   }}),
                         [](const auto& info) { return info.param.model; });

}  // namespace
}  // namespace anholon::test::geometry_test

// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/beam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "describe/read_model.hpp"
#include "tape/interpret.hpp"

namespace anholon {
namespace {

/// phi by its definition, in long double.
class Shape {
 public:
  explicit Shape(int index)
      : mode_(cantilever_mode(index)), b_(rounded(mode_.b)), sigma_(rounded(mode_.sigma)) {}
  long double operator()(long double x) const {
    return mode_.sign *
           (std::cosh(b_ * x) - std::cos(b_ * x) - sigma_ * (std::sinh(b_ * x) - std::sin(b_ * x))) / 2;
  }

 private:
  static long double rounded(const Exact& x) { return std::stold(x.decimal(25)); }
  CantileverMode mode_;
  long double b_, sigma_;
};

/// Integral over [0, 1] by Gauss-Legendre with five points on each of 64 parts.
long double integral(const std::function<long double(long double)>& f) {
  const long double a = std::sqrt(5.0L + 2 * std::sqrt(10.0L / 7)) / 3,
                    b = std::sqrt(5.0L - 2 * std::sqrt(10.0L / 7)) / 3;
  const long double wa = (322 - 13 * std::sqrt(70.0L)) / 900, wb = (322 + 13 * std::sqrt(70.0L)) / 900;
  const std::array<std::pair<long double, long double>, 5> rule = {
      {{-a, wa}, {-b, wb}, {0, 128.0L / 225}, {b, wb}, {a, wa}}};
  long double sum = 0;
  for (int part = 0; part < 64; ++part) {
    for (const auto& [x, w] : rule) sum += w * f((part + (1 + x) / 2) / 64) / 128;
  }
  return sum;
}

TEST(CantileverMode, FulfilsItsFrequencyEquationToWorkingDigits) {
  for (const int index : {1, 2, 3, 10, 30}) {
    SCOPED_TRACE(index);
    const CantileverMode mode = cantilever_mode(index);
    const Exact e = exp(mode.b);
    const Exact cosh_b = (e + Exact(1) / e) / Exact(2);
    EXPECT_LT(abs(cos(mode.b) + Exact(1) / cosh_b), Exact::from_decimal("1e-115"));
    EXPECT_NEAR(mode.b.to_double(), (index - 0.5) * M_PI, index == 1 ? 0.31 : 0.02);
  }
}

TEST(CantileverMode, HasUnitTipDeflection) {
  for (int index = 1; index <= 6; ++index)
    EXPECT_NEAR(static_cast<double>(Shape(index)(1)), 1, 1e-9) << index;
}

TEST(CantileverMode, IntegralsAgreeWithQuadrature) {
  for (int i = 1; i <= 4; ++i) {
    SCOPED_TRACE(i);
    const CantileverMode mode = cantilever_mode(i);
    const Shape phi(i);
    // the long-double phi loses exp(b) ulps: 1e-19 * 6e4
    EXPECT_NEAR(static_cast<double>(integral([&](long double x) { return phi(x); })), mode.mean.to_double(),
                1e-13);
    EXPECT_NEAR(static_cast<double>(integral([&](long double x) { return x * phi(x); })),
                mode.moment.to_double(), 1e-13);
    for (int j = 1; j <= i; ++j) {
      const Shape other(j);
      EXPECT_NEAR(static_cast<double>(integral([&](long double x) { return phi(x) * other(x); })),
                  i == j ? 0.25 : 0, 1e-13)
          << j;
    }
  }
}

TEST(Beam, HasTheIntegralsOfTheReference) {
  std::ifstream stream(ANHOLON_SOURCE_DIR "/tests/describe/beam_integrals.json");
  const nlohmann::json reference = nlohmann::json::parse(stream);
  const Model model = read_model(ANHOLON_SOURCE_DIR "/models/soft_snakeboard/soft_snakeboard.toml");
  const auto found = std::find_if(model.bodies.begin(), model.bodies.end(),
                                  [](const auto& body) { return body.name == "beam_3"; });
  ASSERT_NE(found, model.bodies.end());
  const BodyDescription& beam = *found;
  ASSERT_EQ(beam.modes.size(), 1U);
  const ModeDescription& mode = beam.modes.front();

  Tape& tape = *model.tape;
  const Expr r(tape, model.symbols.r[static_cast<std::size_t>(mode.coordinate)]);
  std::vector<Exact> inputs(tape.inputs().size());
  for (std::size_t i = 0; i < model.parameters.size(); ++i) inputs[i] = model.parameters[i].value;
  // with r_e3 = 1 alone, twice the potential is k_1
  inputs[tape.node(r.id(tape)).a] = 1;
  const std::vector<std::pair<std::string, Expr>> quantities = {
      {"m_b = int rhoA", beam.mass},
      {"S_b = int rhoA X", beam.first_moment[0]},
      {"J_b = int rhoA X^2", beam.inertia[2]},
      {"beta1 = int rhoA phi_1", mode.S[1]},
      {"kappa1 = int rhoA X phi_1", mode.X_phi[1]},
      {"m_f1 = int rhoA phi_1^2 (= rhoA L/4)", mode.phi_phi[0][4]},
      {"k_1", Expr(2) * model.potential}};
  for (const auto& [name, expression] : quantities) {
    const Exact expected = Exact::from_decimal(reference.at(name).get<std::string>());
    const Exact value = interpret<Exact>(tape, {expression.id(tape)}, inputs).front();
    EXPECT_LT(abs(value - expected), Exact::from_decimal("1e-28") * (Exact(1) + abs(expected))) << name;
  }
  const Exact b = Exact::from_decimal(reference.at("b").get<std::string>());
  EXPECT_LT(abs(cantilever_mode(1).b - b), Exact::from_decimal("1e-30"));
}

TEST(Beam, WithTwoPlanesHasModesAlongBothAxes) {
  const Model model = read_model_text(R"toml(
anholon = 1
name = "mast"
group = "SE3"
[[body]]
name = "hull"
inertia = { mass = 10, about_com = { xx = 1, yy = 1, zz = 1 } }
[[body]]
name = "mast"
parent = "hull"
joint = { kind = "fixed" }
beam = { length = 2, mass_per_length = 3, bending_stiffness = 50, modes = 2, planes = ["y", "z"], material_damping = 0.001, deformation = "quadratic" }
)toml",
                                      "mast.toml");
  ASSERT_EQ(model.coordinates.size(), 4U);
  EXPECT_EQ(model.coordinates[0].name, "mast_e1");
  EXPECT_EQ(model.coordinates[3].name, "mast_e4");
  const std::vector<ModeDescription>& modes = model.bodies[1].modes;
  ASSERT_EQ(modes.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t axis = i < 2 ? 1 : 2;
    EXPECT_EQ(modes[i].coordinate, static_cast<int>(i));
    EXPECT_FALSE(modes[i].S[axis].is_zero());
    EXPECT_TRUE(modes[i].S[3 - axis].is_zero());
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 9; ++k) {
        const bool is_set = i % 2 == j % 2 && k == 3 * axis + (j < 2 ? 1 : 2);
        EXPECT_EQ(!modes[i].phi_phi[j][k].is_zero(), is_set) << i << j << k;
      }
    }
  }
  ASSERT_EQ(model.notes.size(), 1U);
  EXPECT_EQ(model.notes[0],
            "the range of the beam of body 'mast' is taken as a fifth of its length, [-0.4, 0.4] m");
}

}  // namespace
}  // namespace anholon

// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/beam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "describe/read_model.hpp"
#include "tape/interpret.hpp"

namespace anholon::beam_test {
namespace {

const BeamSection uniform;

std::vector<BeamMode> clamped_modes(int n) {
  std::vector<BeamMode> modes;
  for (int i = 1; i <= n; ++i) modes.push_back({BeamFamily::bending_y, clamped_shape(clamped_mode(i))});
  return modes;
}

void expect_equal(const Exact& have, const Exact& want, const char* digits, const std::string& what) {
  EXPECT_LT(abs(have - want), Exact::from_decimal(digits) * (Exact(1) + abs(want))) << what;
}

TEST(ClampedMode, FulfilsItsFrequencyEquationToWorkingDigits) {
  const WorkingDigits digits(128);
  for (const int index : {1, 2, 3, 10, 30}) {
    SCOPED_TRACE(index);
    const ClampedMode mode = clamped_mode(index);
    const Exact e = exp(mode.b);
    const Exact cosh_b = (e + Exact(1) / e) / Exact(2);
    EXPECT_LT(abs(cos(mode.b) + Exact(1) / cosh_b), Exact::from_decimal("1e-108"));
    EXPECT_NEAR(mode.b.to_double(), (index - 0.5) * M_PI, index == 1 ? 0.31 : 0.02);
  }
}

TEST(ClampedMode, WithABodyAtItsEndMeetsTheBoundaryConditionsThere) {
  const WorkingDigits digits(128);
  const Exact mu = Exact::from_decimal("0.7"), kappa = Exact::from_decimal("0.02");
  const Exact h = Exact::from_decimal("1e-40");
  double before = 0;
  for (const int index : {1, 2, 5, 12}) {
    SCOPED_TRACE(index);
    const ClampedMode mode = clamped_mode(index, mu, kappa);
    EXPECT_GT(mode.b.to_double(), before);
    before = mode.b.to_double();
    EXPECT_LT(before, clamped_mode(index).b.to_double());  // more mass, lower frequency
    const BeamShape shape = clamped_shape(mode);
    const auto end = shape(Exact(1)), inside = shape(Exact(1) - h), root = shape(Exact(0));
    const Exact b4 = mode.b * mode.b * mode.b * mode.b;
    EXPECT_LT(abs(root[0]) + abs(root[1]), Exact::from_decimal("1e-60"));
    expect_equal(end[2], kappa * b4 * end[1], "1e-60", "moment");
    expect_equal((end[2] - inside[2]) / h, -(mu * b4 * end[0]), "1e-30", "shear");  // a difference over h
  }
}

// With s = (-1)^(i+1) and sigma of the first mode's formula: int f = s sigma/b, int x f = s/b^2, int f_i f_j
// = delta/4, int f_i'' f_j'' = delta b^4/4.
TEST(BeamIntegrals, OfCantileverModesAreThoseOfTheClosedForms) {
  const int n = 8;
  const BeamIntegrals I = beam_integrals(clamped_modes(n), {uniform});
  for (int i = 0; i < n; ++i) {
    SCOPED_TRACE(i + 1);
    const ClampedMode mode = clamped_mode(i + 1);
    const Exact s = i % 2 == 0 ? 1 : -1;
    const auto at = static_cast<std::size_t>(i);
    expect_equal(I.mean[at], s * mode.sigma / mode.b, "1e-45", "mean");
    expect_equal(I.moment[at], s / (mode.b * mode.b), "1e-45", "moment");
    for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j) {
      EXPECT_EQ(I.overlap[at][j], j == at ? Exact::ratio(1, 4) : Exact(0))
          << j;  // exactly, thanks to snapping
      const Exact b2 = mode.b * mode.b;
      expect_equal(I.stiffness[at][j], j == at ? b2 * b2 / Exact(4) : Exact(0), "1e-45", "stiffness");
    }
  }
  // int (1 - x^2) f'^2 / 2 over int f^2 is 1.193336374 for the first mode: what a rotating beam gains
  EXPECT_NEAR((I.shortening_moment[0][0] / I.overlap[0][0]).to_double(), 1.193336374, 1e-9);
}

TEST(BeamIntegrals, OfATaperedBeamInTwoSectionsAreThoseOfPolynomials) {
  BeamSection first, second;
  first.to = Exact::from_decimal("0.4");
  first.mass = [](const Exact& x) { return Exact(2) - x; };
  second.bending_y = [](const Exact& x) { return x * x; };
  const BeamShape square = [](const Exact& x) { return std::array<Exact, 3>{x * x, Exact(2) * x, Exact(2)}; };
  const BeamIntegrals I = beam_integrals({{BeamFamily::bending_y, square}}, {first, second});
  const auto decimal = [](const char* text) { return Exact::from_decimal(text); };
  expect_equal(I.mass[0], decimal("1.32"), "1e-45", "mass");  // int (2 - x) to 0.4, then 0.6
  // int (2 - x) x^4 to 0.4 = 2 * 0.4^5/5 - 0.4^6/6; int x^4 from there to 1 = (1 - 0.4^5)/5
  expect_equal(I.overlap[0][0],
               (decimal("0.01024") * Exact(2) / Exact(5)) - decimal("0.004096") / Exact(6) +
                   (Exact(1) - decimal("0.01024")) / Exact(5),
               "1e-45", "overlap");
  // 4 int_0^0.4 + 4 int x^2 from 0.4 to 1
  expect_equal(I.stiffness[0][0], decimal("1.6") + Exact(4) * (Exact(1) - decimal("0.064")) / Exact(3),
               "1e-45", "stiffness");
  // int m (4 x^3/3): 4/3 of int (2 - x) x^3 to 0.4 and of int x^3 from there
  const Exact third = decimal("0.0256") / Exact(2) - decimal("0.01024") / Exact(5) +
                      (Exact(1) - decimal("0.0256")) / Exact(4);
  expect_equal(I.shortening[0][0], Exact(4) * third / Exact(3), "1e-45", "shortening");
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
  EXPECT_LT(abs(clamped_mode(1).b - b), Exact::from_decimal("1e-30"));
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
}  // namespace anholon::beam_test

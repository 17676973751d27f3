// SPDX-License-Identifier: GPL-2.0-or-later
//
// Compliant beams against Gauss quadrature over the displaced line of mass: material abscissa x is at
// (x, sum phi_j(x) r_j, sum phi_j(x) r_j) in the beam's frame, with no rotary inertia.
#include <gtest/gtest.h>

#include "mechanics/beam_shapes.hpp"
#include "mechanics/witness.hpp"

namespace anholon::beam_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests

struct Beam {
  const char* name;
  int modes;
  const char* planes;   // of deflection, in the order of the coordinates
  const char* damping;  // a line of the description
  Real modal = 0, material = 0;
  const char* group = "SE3";
};
void PrintTo(const Beam& b, std::ostream* stream) { *stream << b.name; }

class CompliantBeam : public testing::TestWithParam<Beam> {};

// A beam behind a hinge about an oblique axis, which also carries a rigid tip mass of its own frame, on a
// free base.
TEST_P(CompliantBeam, MovesAsItsLineOfMass) {
  const Beam beam = GetParam();
  const std::string planes = beam.planes;
  std::string plane_list;
  for (const char plane : planes)
    plane_list += fmt::format("{}\"{}\"", plane_list.empty() ? "" : ", ", plane);
  const Real L = 0.8L, rhoA = 0.9L, EI = 1.4L;
  std::vector<Cantilever> shapes;
  for (int j = 1; j <= beam.modes; ++j) shapes.emplace_back(j);
  const auto rule = gauss_legendre(40);  // exact for the products of these modes to 1e-19

  Witness w;
  w.description =
      header(beam.group,
             "gravity = [0.6, -3.1, -8.8]\n[parameters]\nL = { value = 0.8, unit = \"m\" }\nrhoA = { value = "
             "0.9, unit = "
             "\"kg/m\" }\nEI = { value = 1.4, unit = \"N m^2\" }") +
      body("base", "", cloud(0)) +
      body("blade", "base", cloud(1),
           fmt::format(
               "pose = {{ translation = [0.2, -0.1, 0.3], rotation = {{ axis = \"z\", angle = 0.7 }} }}\n"
               "joint = {{ kind = \"revolute\", axis = [0, -0.28, 0.96], coordinate = \"a\" }}\n"
               "[body.beam]\nlength = \"L\"\nmass_per_length = \"rhoA\"\nbending_stiffness = \"EI\"\nmodes = "
               "{}\nplanes = [{}]\n"
               "deformation = \"quadratic\"\nrange = [-0.2, 0.2]\n{}\n",
               beam.modes, plane_list, beam.damping));
  w.gravity = {0.6L, -3.1L, -8.8L};
  w.masses = [=](const Pose& g, const std::vector<Jet>& r) {
    const Pose blade =
        g * moved({0.2L, -0.1L, 0.3L}) * turned({0, 0, 1}, 0.7L) * turned({0, -0.28L, 0.96L}, r[0]);
    std::vector<MassPoint> points;
    add(points, g, cloud(0)), add(points, blade, cloud(1));
    for (const auto& [s, weight] : rule) {
      Vector at(L * s, 0, 0);
      std::size_t coordinate = 1;
      for (const char plane : planes) {
        for (const Cantilever& shape : shapes) at[plane == 'y' ? 1 : 2] += Jet(shape.at(s)) * r[coordinate++];
      }
      points.push_back({rhoA * L * weight, blade * at});
    }
    return points;
  };
  // EI/2 times the integral of the squared curvature over each plane, modes and products of modes alike
  w.potential = [=](const Pose&, const std::vector<Jet>& r) {
    Jet energy = 0;
    for (const auto& [s, weight] : rule) {
      std::size_t coordinate = 1;
      for (std::size_t plane = 0; plane < planes.size(); ++plane) {
        Jet curvature = 0;
        for (const Cantilever& shape : shapes) curvature += Jet(shape.curvature(s)) * r[coordinate++];
        energy += Jet(EI * weight / (2 * L * L * L)) * curvature * curvature;
      }
    }
    return energy;
  };
  const std::size_t n = std::string(beam.group) == "SE3" ? 6 : 3;
  const auto forces = [=](const Sample& sample) {
    std::vector<Real> Q(n + sample.state.r.size(), 0);
    for (std::size_t i = 1; i < sample.state.r.size(); ++i) {
      const Cantilever& shape = shapes[(i - 1) % shapes.size()];
      const Real k = EI * std::pow(shape.b, 4) / (4 * L * L * L);
      Q[n + i] = -(beam.modal + beam.material * k) * sample.state.r_dot[i];
    }
    return Q;
  };
  w.forces = forces;
  w.dissipated_power = [=](const Sample& sample) {
    const std::vector<Real> Q = forces(sample);
    Real power = 0;
    for (std::size_t i = 1; i < sample.state.r.size(); ++i) power -= Q[n + i] * sample.state.r_dot[i];
    return power;
  };
  expect_mechanics_of(w);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, CompliantBeam,
    testing::Values(Beam{"OneModeInPlane", 1, "y", ""}, Beam{"OneModeOutOfPlane", 1, "z", ""},
                    Beam{"OneModeOnAPlanarBase", 1, "y", "", 0, 0, "SE2"},
                    Beam{"ThreeModes", 3, "y", "modal_damping = 0.2", 0.2L, 0},
                    Beam{"OneModeInBothPlanes", 1, "yz", ""},
                    Beam{"TwoModesInBothPlanes", 2, "zy", "material_damping = 0.002", 0, 0.002L}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace anholon::beam_test

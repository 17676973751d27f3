// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/modal_table.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "describe/beam.hpp"
#include "describe/read_model.hpp"
#include "tape/interpret.hpp"

namespace anholon::modal_table_test {
namespace {

const std::string beam_description = R"toml(
anholon = 1
name = "robot"
group = "SE2"
[[body]]
name = "hull"
[[body]]
name = "beam"
parent = "hull"
joint = { kind = "fixed" }
beam = { length = 1, mass_per_length = 2, bending_stiffness = 3, modes = 2, range = [-0.1, 0.1] }
[[body]]
name = "load"
parent = "beam"
joint = { kind = "fixed" }
inertia = { mass = 0.5 }
)toml";

/// Value of an expression with all inputs zero.
Exact value(const Model& model, const Expr& e) {
  const std::vector<Exact> inputs(model.tape->inputs().size(), Exact(0));
  return interpret<Exact>(*model.tape, {e.id(*model.tape)}, inputs).front();
}

/// The beam of a description as the table that a reduction would export, 15 digits.
std::string exported(const Model& model) {
  const BodyDescription& beam = model.bodies[1];
  const auto number = [&](const Expr& e) { return value(model, e).decimal(15); };
  const auto vector = [&](const std::array<Expr, 3>& v) {
    return fmt::format("[{}, {}, {}]", number(v[0]), number(v[1]), number(v[2]));
  };
  const auto tensor = [&](const std::array<Expr, 9>& t) {
    return fmt::format("[{}, {}, {}]", vector({t[0], t[1], t[2]}), vector({t[3], t[4], t[5]}),
                       vector({t[6], t[7], t[8]}));
  };
  const auto list = [](const auto& items, const auto& text) {
    std::string all;
    for (const auto& item : items) all += (all.empty() ? "" : ", ") + text(item);
    return "[" + all + "]";
  };
  const auto of_modes = [&](const auto& text) { return list(beam.modes, text); };
  const auto& i = beam.inertia;
  std::string text =
      fmt::format("anholon_modes = 1\nmass = {}\nfirst_moment = {}\ninertia = {}\n", number(beam.mass),
                  vector(beam.first_moment), tensor({i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2]}));
  text += "S = " + of_modes([&](const auto& m) { return vector(m.S); }) + "\n";
  text += "X_phi = " + of_modes([&](const auto& m) { return tensor(m.X_phi); }) + "\n";
  text += "phi_phi = " + of_modes([&](const auto& m) { return list(m.phi_phi, tensor); }) + "\n";
  text += "psi = " + of_modes([&](const auto& m) { return list(m.psi, vector); }) + "\n";
  text += "X_psi = " + of_modes([&](const auto& m) { return list(m.X_psi, tensor); }) + "\n";
  const BeamIntegrals I = beam_integrals({{BeamFamily::bending_y, clamped_shape(clamped_mode(1))},
                                          {BeamFamily::bending_y, clamped_shape(clamped_mode(2))}},
                                         {BeamSection{}});
  text += "stiffness = " +
          list(I.stiffness,
               [&](const std::vector<Exact>& row) {
                 return list(row, [](const Exact& x) { return (Exact(3) * x).decimal(15); });
               }) +
          "\n";
  const StationDescription& station = model.bodies[2].station;
  text += fmt::format("[[station]]\nname = \"tip\"\nat = {}\n", vector(station.at));
  text += "phi = " + list(station.modes, [&](const auto& m) { return vector(m.phi); }) + "\n";
  text += "turn = " + list(station.modes, [&](const auto& m) { return vector(m.turn); }) + "\n";
  text += "psi = " + list(station.modes, [&](const auto& m) { return list(m.psi, vector); }) + "\n";
  return text;
}

class TableOfModes : public testing::Test {
 protected:
  TableOfModes() { std::filesystem::create_directories(folder); }
  ~TableOfModes() override { std::filesystem::remove_all(folder); }

  /// Reads the description with the beam's body described by a table of this text.
  Model read(const std::string& table) const {
    std::ofstream(folder / "beam.modes.toml") << table;
    std::string text = beam_description;
    const std::size_t from = text.find("beam = {"), to = text.find('\n', from);
    text.replace(from, to - from, "modal = { table = \"beam.modes.toml\", range = [-0.1, 0.1] }");
    return read_model_text(text, (folder / "robot.toml").string());
  }
  std::string error(const std::string& table) const {
    try {
      read(table);
    } catch (const ModelError& e) {
      const std::string all = e.what();
      return all.substr(all.find("error: ") + 7);
    }
    return "";
  }
  static std::string changed(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) {
      ADD_FAILURE() << "no " << from;
      return text;
    }
    return text.replace(at, from.size(), to);
  }

  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "anholon_table_of_modes";
  const Model beam = read_model_text(beam_description, "robot.toml");
  const std::string table = exported(beam);
};

TEST_F(TableOfModes, OfABeamGivesTheBeam) {
  const Model same = read(table);
  const auto expect_near = [&](const Expr& have, const Expr& want, const char* what) {
    EXPECT_NEAR(value(same, have).to_double(), value(beam, want).to_double(), 1e-14)
        << what;  // printed with 15 digits
  };
  ASSERT_EQ(same.coordinates.size(), 2U);
  const BodyDescription &have = same.bodies[1], &want = beam.bodies[1];
  expect_near(have.mass, want.mass, "mass");
  for (std::size_t i = 0; i < 3; ++i) expect_near(have.inertia[i], want.inertia[i], "inertia");
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < 3; ++i) expect_near(have.modes[j].S[i], want.modes[j].S[i], "S");
    for (std::size_t l = 0; l < 2; ++l) {
      for (std::size_t i = 0; i < 9; ++i) {
        expect_near(have.modes[j].phi_phi[l][i], want.modes[j].phi_phi[l][i], "phi_phi");
        expect_near(have.modes[j].X_psi[l][i], want.modes[j].X_psi[l][i], "X_psi");
      }
      expect_near(same.bodies[2].station.modes[j].psi[l][0], beam.bodies[2].station.modes[j].psi[l][0],
                  "psi");
    }
    expect_near(same.bodies[2].station.modes[j].turn[2], beam.bodies[2].station.modes[j].turn[2], "turn");
  }
}

TEST_F(TableOfModes, IsRefusedWhereItCannotBe) {
  EXPECT_EQ(error(changed(table, "stiffness = [[", "stiffness = [[-")),
            "the stiffness is not positive semidefinite; check signs, units and the origin that the "
            "integrals refer to");
  EXPECT_EQ(error(changed(table, "mass = 2", "mass = 0.2")),
            "the mass matrix of body and modes is not positive semidefinite; check signs, units and the "
            "origin that the "
            "integrals refer to");
  const std::string first = error(changed(table, "S = [[", "S = [[0, 0, 0], ["));  // one for each other entry
  EXPECT_EQ(first.substr(0, first.find('\n')),
            "'X_phi' has 2 entries where 3 belong; write an array of 3; there are 3 modes");
  std::string asymmetric = table;
  asymmetric.replace(asymmetric.find("0], [0", asymmetric.find("stiffness")), 1, "1");
  EXPECT_EQ(error(asymmetric),
            "'stiffness' is not symmetric: entries differ by 1; entries of modes j and l are those of l and "
            "j, transposed");
  EXPECT_EQ(error(changed(table, "name = \"tip\"", "name = \"top\"")),
            "body 'load' hangs at station 'tip', which the table of modes has not; did you mean 'top'?");
}

}  // namespace
}  // namespace anholon::modal_table_test

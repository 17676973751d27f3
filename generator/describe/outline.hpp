// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// First look at a description: which bodies, joints, modes and couplings there are. It settles the
// coordinates and thereby the inputs of the model's tape, which every expression needs.

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "describe/modal_table.hpp"
#include "describe/reading.hpp"
#include "describe/table_reader.hpp"

namespace anholon {

/// Modes of a beam: for each plane, in order, the first `modes` ones; then those of torsion and axial ones.
struct BeamOutline {
  TableReader table;
  int modes = 1;
  std::vector<int> planes;  // axis of deflection, 1 (y) or 2 (z)
  int torsion_modes = 0;
  int axial_modes = 0;
  int first_coordinate = 0;  // the beam's coordinates follow each other in Model::coordinates
};

/// A compliant body that a table describes.
struct ModalOutline {
  TableReader table;
  ModalTable data;
  int first_coordinate = 0;
};

/// Where a body hangs on a compliant one, as its key `station` says, or at the tip.
/// @param station  null where there is no such key
using StationReader =
    std::function<StationDescription(const Value* station, const BodyDescription& hanging, Reading& reading)>;

/// The axis of a beam, along which sections may be taken.
struct BeamLine {
  Expr length = 1;
  /// @param x  fraction of the length
  std::function<StationDescription(const Exact& x, Reading& reading)> at;
};

struct BodyOutline {
  TableReader table;
  std::optional<TableReader> joint;
  std::optional<BeamOutline> beam;
  std::optional<ModalOutline> modal;
  StationReader station_on;      // what hangs on this body, once it has been read as compliant
  int coordinate = -1;           // of the joint in Model::coordinates; -1 where it is coupled or fixed
  std::optional<BeamLine> line;  // once it has been read as a beam
};

struct CouplingOutline {
  TableReader table;
  std::string coordinate;
  const Value* equals = nullptr;
  Location where;
};

struct Outline {
  std::deque<BodyOutline> bodies;  // in the order of Model::bodies
  std::vector<CouplingOutline> couplings;
};

/// Words that no parameter or coordinate may be called: states, functions and constants of expressions.
std::vector<std::string> reserved_names();

/// Reads the parameters and fills Model::parameters.
void read_parameters(TableReader& root, Reading& reading);

/// Finds bodies, joints and couplings; fills the names, parents and joint kinds of Model::bodies and the
/// coordinates. A model that has bodies already, from a robot file, gets more of them.
Outline read_outline(TableReader& root, Reading& reading);

/// Makes the inputs of the model's tape, in the order of StateSymbols, and the names that stand for them.
void make_symbols(Reading& reading);

/// The names of a model whose tape has its inputs, and the inputs' default values.
void name_symbols(Reading& reading);

/// The names of coupled coordinates, which stand for expressions of others.
void name_coupled_coordinates(Reading& reading);

/// Reads the expressions of coupled coordinates; then their names stand for them.
void read_couplings(Outline& outline, Reading& reading);

/// Index of a body by name, or -1.
int body_index(const Model& model, std::string_view name);
/// Index of an independent coordinate by name, or -1.
int coordinate_index(const Model& model, std::string_view name);

}  // namespace anholon

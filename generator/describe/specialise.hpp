// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A model cut down to what a scene needs, before anything is derived.

#include "describe/model.hpp"
#include "describe/scene.hpp"

namespace anholon {

/// A model on a tape of its own: frozen parameters are numbers, locked coordinates stand still, modes that
/// are not kept are gone, gravity is gone where the scene has none. What is left keeps its order.
/// @param model  the scene's model, or one with the same parameters, coordinates and bodies
/// @throws ModelError where the frozen values make an expression undefined
Model specialise(const Model& model, const Scene& scene);

/// Index in the specialised model of each coordinate of the original; -1 for those that are gone.
std::vector<int> kept_coordinates(const Model& model, const Scene& scene);

}  // namespace anholon

// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A start without ringing: coordinates that the scene names begin where the rest of the motion carries them.

#include "describe/scene.hpp"

namespace anholon {

/// The scene with the coordinates of initial.equilibrium, and their rates, as numbers: where their fourth and
/// fifth derivatives by time vanish. That is quasi-static equilibrium with its next correction: a mode of
/// frequency omega that is driven at Omega then rings with (Omega/omega)^4 of its deflection. Kreiss 1979,
/// "Problems with different time scales for ordinary differential equations", SIAM J. Numer. Anal. 16
/// (bounded derivatives).
/// @throws ModelError where Newton's method finds none
Scene settled(const Scene& scene);

}  // namespace anholon

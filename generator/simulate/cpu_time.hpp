// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <ctime>

namespace anholon {

/// CPU time of the process [s].
inline double cpu_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace anholon

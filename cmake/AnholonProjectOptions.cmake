# SPDX-License-Identifier: GPL-2.0-or-later
# Compile options of this project's own targets; never exported to consumers.
add_library(anholon_project_options INTERFACE)
target_compile_features(anholon_project_options INTERFACE cxx_std_20)
target_compile_options(anholon_project_options INTERFACE
  -Wall -Wextra -Wpedantic
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # false alarms on std::string concatenation, GCC bug 105329
  $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>  # false alarms on vectorised Eigen blocks of float at -O3
  -fno-math-errno -fno-trapping-math  # safe: no code here reads errno or floating-point traps
  $<$<BOOL:${ANHOLON_WARNINGS_AS_ERRORS}>:-Werror>)

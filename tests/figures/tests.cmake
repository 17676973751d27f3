# SPDX-License-Identifier: GPL-2.0-or-later
# The figures of the documentation, by the code that inserts them.
target_sources(figures_tests PRIVATE ${PROJECT_SOURCE_DIR}/bench/figures.cpp)
target_include_directories(figures_tests PRIVATE ${PROJECT_SOURCE_DIR}/bench)

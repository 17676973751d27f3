# SPDX-License-Identifier: GPL-2.0-or-later
# The robots that the tests read where they are given, and the Orocos library as an oracle where it is installed.
target_compile_definitions(urdf_tests PRIVATE ANHOLON_ROBOTS="${ANHOLON_ROBOTS}")
pkg_check_modules(KDL QUIET IMPORTED_TARGET orocos-kdl)
if(KDL_FOUND)
  target_compile_definitions(urdf_tests PRIVATE ANHOLON_HAVE_KDL)
  target_link_libraries(urdf_tests PRIVATE PkgConfig::KDL)
endif()

# SPDX-License-Identifier: GPL-2.0-or-later
# The robots that the tests read where they are given, and other engines as oracles where they are installed.
target_compile_definitions(urdf_tests PRIVATE ANHOLON_ROBOTS="${ANHOLON_ROBOTS}")
pkg_check_modules(KDL QUIET IMPORTED_TARGET orocos-kdl)
if(KDL_FOUND)
  target_compile_definitions(urdf_tests PRIVATE ANHOLON_HAVE_KDL)
  target_link_libraries(urdf_tests PRIVATE PkgConfig::KDL)
endif()
find_package(DART 6 QUIET CONFIG COMPONENTS dart)
if(DART_FOUND)
  target_compile_definitions(urdf_tests PRIVATE ANHOLON_HAVE_DART)
  target_link_libraries(urdf_tests PRIVATE dart)
endif()

# The verbs of the program on URDF files. A pattern is a pass only where the exit status is judged elsewhere.
function(anholon_urdf_verb name pattern)
  add_test(NAME UrdfVerb.${name} COMMAND anholon ${ARGN} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(UrdfVerb.${name} PROPERTIES LABELS quick TIMEOUT 300)
  if(pattern)
    set_tests_properties(UrdfVerb.${name} PROPERTIES PASS_REGULAR_EXPRESSION "${pattern}")
  endif()
endfunction()
anholon_urdf_verb(Check "merged +tool into hand" check models/arm7/arm7.urdf)
anholon_urdf_verb(CheckFloating "pelvis, free in SE3 .n = 6." check models/humanoid/humanoid.urdf --floating)
anholon_urdf_verb(Generate "" generate models/quadruped/quadruped.urdf --floating
  --functions all --no-search --c-abi -o ${CMAKE_CURRENT_BINARY_DIR}/urdf_generated)
anholon_urdf_verb(Verify "" verify models/arm7/arm7.urdf --samples 20)
anholon_urdf_verb(Gravity "0, 0, -1.62. m/s" check models/arm7/arm7.urdf --gravity 1.62)
anholon_urdf_verb(GravityIsANumber "--gravity is 'down', not a decimal number" check models/arm7/arm7.urdf --gravity down)
anholon_urdf_verb(OptionOfAnotherFormat "are for a robot file" check models/arm6/arm6.toml --floating)
anholon_urdf_verb(TreeFunctionsOfAModelFile "mass_matrix +[0-9]+" generate models/arm6/arm6.toml --functions mass_matrix
  -o ${CMAKE_CURRENT_BINARY_DIR}/urdf_generated)

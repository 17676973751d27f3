# SPDX-License-Identifier: GPL-2.0-or-later
# The formats' own libraries as oracles, where they are installed.
target_compile_definitions(robot_files_tests PRIVATE ANHOLON_ROBOTS="${ANHOLON_ROBOTS}")
pkg_check_modules(URDFDOM QUIET IMPORTED_TARGET urdfdom)
if(URDFDOM_FOUND)
  target_compile_definitions(robot_files_tests PRIVATE ANHOLON_HAVE_URDFDOM)
  target_link_libraries(robot_files_tests PRIVATE PkgConfig::URDFDOM)
endif()
find_package(sdformat12 QUIET CONFIG)
if(sdformat12_FOUND)
  target_compile_definitions(robot_files_tests PRIVATE ANHOLON_HAVE_SDFORMAT)
  target_link_libraries(robot_files_tests PRIVATE sdformat12::sdformat12)
endif()
# Not by its CMake package: Debian's names include folders that no package has.
find_path(MUJOCO_INCLUDE_DIR NAMES mujoco/mujoco.h)
find_library(MUJOCO_LIBRARY NAMES mujoco)
if(MUJOCO_INCLUDE_DIR AND MUJOCO_LIBRARY)
  target_compile_definitions(robot_files_tests PRIVATE ANHOLON_HAVE_MUJOCO)
  target_include_directories(robot_files_tests SYSTEM PRIVATE "${MUJOCO_INCLUDE_DIR}")
  target_link_libraries(robot_files_tests PRIVATE "${MUJOCO_LIBRARY}")
endif()

# The verbs of the program on these files.
set(files tests/robot_files)
anholon_urdf_verb(CheckSdf "merged +tool into hand" check ${files}/arm.sdf)
anholon_urdf_verb(CheckMjcf "trunk, free in SE3 .n = 6." check ${files}/walker.xml)
anholon_urdf_verb(GenerateSdf "" generate ${files}/walker.sdf --no-search -o ${CMAKE_CURRENT_BINARY_DIR}/urdf_generated)
anholon_urdf_verb(VerifySdf "" verify ${files}/arm.sdf --samples 20)
anholon_urdf_verb(VerifyMjcf "" verify ${files}/walker.xml --functions mass_matrix --samples 20)
anholon_urdf_verb(FloatingIsTheFilesMatter "leave out --floating" check ${files}/arm.xml --floating)
add_test(NAME RobotFile.IsADependency COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}"
  "-DWORK=${CMAKE_CURRENT_BINARY_DIR}/robot_file_dependency" "-DPROGRAM=$<TARGET_FILE:anholon>"
  "-DGENERATOR=${CMAKE_GENERATOR}" -P "${CMAKE_CURRENT_LIST_DIR}/dependency.cmake")
set_tests_properties(RobotFile.IsADependency PROPERTIES LABELS quick TIMEOUT 120)

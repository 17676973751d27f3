# SPDX-License-Identifier: GPL-2.0-or-later
#
# A header is made again when the robot file changes that its model stands on:
#   cmake -DSOURCE=<project> -DWORK=<folder> -DPROGRAM=<anholon> -DGENERATOR=<of CMake> -P dependency.cmake
file(REMOVE_RECURSE "${WORK}")
file(COPY "${SOURCE}/tests/robot_files/arm.sdf" DESTINATION "${WORK}")
file(WRITE "${WORK}/robot.toml" "anholon = 1\nsdf     = \"arm.sdf\"\n")
file(WRITE "${WORK}/CMakeLists.txt" "cmake_minimum_required(VERSION 3.20)
project(robot NONE)
add_executable(anholon::anholon IMPORTED)
set_target_properties(anholon::anholon PROPERTIES IMPORTED_LOCATION \"${PROGRAM}\")
include(\"${SOURCE}/cmake/AnholonAddModel.cmake\")
anholon_add_model(robot MODEL robot.toml FUNCTIONS mass_matrix)
")

function(build result)
  execute_process(COMMAND "${CMAKE_COMMAND}" --build "${WORK}/build" --target robot_generated
    OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
  if(output MATCHES "Generating robot.hpp")
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

execute_process(COMMAND "${CMAKE_COMMAND}" -S "${WORK}" -B "${WORK}/build" -G "${GENERATOR}"
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
build(at_first)
build(unchanged)
file(READ "${WORK}/arm.sdf" text)
string(REPLACE "<mass>3</mass>" "<mass>4</mass>" text "${text}")
file(WRITE "${WORK}/arm.sdf" "${text}")
build(changed)
if(NOT at_first OR unchanged OR NOT changed)
  message(FATAL_ERROR "generated at first ${at_first}, with nothing changed ${unchanged}, with another mass ${changed}")
endif()

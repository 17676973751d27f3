# SPDX-License-Identifier: MIT
#
# anholon_add_model(<target> MODEL <file> [SCENE <file>] [FUNCTIONS <name>...] [INVERSE <inverse>]
#                   [SINCOS cmath|batch] [OPTIMISE accuracy|balanced|speed] [OPTIONS <arg>...]
#                   [STATIC [COMPILE_OPTIONS <option>...]])
#
# Generates the C++ of a model at build time and makes it a target. Programs that link the target include
#
#   <model>.hpp  or, with a scene,  <model>_<scene>.hpp
#
# named after the files: board.toml with gait.scene.toml gives board_gait.hpp. A contact set adds its name, so that the
# headers of several sets can be included side by side.
#
#   MODEL, SCENE   description (TOML, or a robot file: URDF, SDFormat, MJCF) and scene (TOML); relative to the current
#                  source folder
#   FUNCTIONS      functions to generate; default: all that the model or the scene asks for
#   INVERSE        generalised inverse where rows are redundant: pseudo (default) or leading:ROW[,ROW...]
#   SINCOS         cmath (default): std::sin and std::cos; batch: those of double by one loop that compilers vectorise
#   OPTIMISE       accuracy, speed, or balanced (default): docs/accuracy.md
#   OPTIONS        further arguments of `anholon generate`, as they stand: --floating, --count N=8, --contacts stance
#   STATIC         a static library with the functions of double compiled in; without it an INTERFACE library, a header
#   COMPILE_OPTIONS  of the static library, after the project's own; default: -O2 -fno-math-errno -fno-trapping-math
#                  -ffp-contract=off, with g++ also -frename-registers
#
# Everything is written below the current build folder. The code is generated again when the program or a file that it read
# changes: model, scene, robot file, tables. Generated code needs C++17 and a standard library, nothing else.
include_guard(GLOBAL)

# A function keeps the policies of its definition, whatever its caller asks for; with CMP0116, a DEPFILE is read as written.
cmake_policy(PUSH)
cmake_policy(VERSION 3.22)

# A property, so that every folder of the project finds the script, wherever this file was included.
set_property(GLOBAL PROPERTY ANHOLON_INSTANTIATE_SCRIPT "${CMAKE_CURRENT_LIST_DIR}/AnholonInstantiate.cmake")

function(anholon_add_model target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "STATIC" "MODEL;SCENE;INVERSE;SINCOS;OPTIMISE" "FUNCTIONS;OPTIONS;COMPILE_OPTIONS")
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "anholon_add_model(${target}): unknown arguments: ${arg_UNPARSED_ARGUMENTS}")
  endif()
  if(arg_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "anholon_add_model(${target}): no value after ${arg_KEYWORDS_MISSING_VALUES}")
  endif()
  if(NOT arg_MODEL)
    message(FATAL_ERROR "anholon_add_model(${target}): MODEL <file> is missing")
  endif()
  if(arg_SINCOS AND NOT arg_SINCOS MATCHES "^(cmath|batch)$")
    message(FATAL_ERROR "anholon_add_model(${target}): SINCOS is '${arg_SINCOS}'; choose cmath or batch")
  endif()
  if(arg_OPTIMISE AND NOT arg_OPTIMISE MATCHES "^(accuracy|balanced|speed)$")
    message(FATAL_ERROR "anholon_add_model(${target}): OPTIMISE is '${arg_OPTIMISE}'; choose accuracy, balanced or speed")
  endif()
  if(NOT TARGET anholon::anholon)
    message(FATAL_ERROR "anholon_add_model(${target}): there is no program anholon::anholon; build it "
      "(ANHOLON_BUILD_GENERATOR=ON) or name it (ANHOLON_PROGRAM=<file>)")
  endif()
  foreach(kind IN ITEMS MODEL SCENE)
    if(arg_${kind})
      get_filename_component(arg_${kind} "${arg_${kind}}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
      if(NOT EXISTS "${arg_${kind}}")
        message(FATAL_ERROR "anholon_add_model(${target}): there is no file ${arg_${kind}}; ${kind} is relative to "
          "${CMAKE_CURRENT_SOURCE_DIR}")
      endif()
    endif()
  endforeach()

  get_filename_component(name "${arg_MODEL}" NAME_WLE)
  set(inputs "${arg_MODEL}")
  set(options "")
  if(arg_SCENE)
    get_filename_component(scene "${arg_SCENE}" NAME_WLE)
    string(REGEX REPLACE "\\.scene$" "" scene "${scene}")
    string(APPEND name "_${scene}")
    list(APPEND inputs "${arg_SCENE}")
    list(APPEND options --scene "${arg_SCENE}")
  endif()
  if(arg_FUNCTIONS)
    list(JOIN arg_FUNCTIONS "," functions)
    list(APPEND options --functions "${functions}")
  endif()
  if(arg_INVERSE)
    list(APPEND options --inverse "${arg_INVERSE}")
  endif()
  if(arg_SINCOS)
    list(APPEND options --sincos "${arg_SINCOS}")
  endif()
  if(arg_OPTIMISE)
    list(APPEND options --optimise "${arg_OPTIMISE}")
  endif()
  list(APPEND options ${arg_OPTIONS})
  if("${arg_OPTIONS}" MATCHES "(^|;)--contacts[=;]([^;]+)")
    string(APPEND name "_${CMAKE_MATCH_2}")
  endif()

  # The folder with what programs include holds nothing else.
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/anholon_models/${target}")
  set(include "${folder}/include")
  if(arg_STATIC)
    set(header "${folder}/generated/${name}.hpp")  # wrapped: see AnholonInstantiate.cmake
    list(APPEND options --c-abi)
  else()
    set(header "${include}/${name}.hpp")
  endif()
  file(MAKE_DIRECTORY "${include}")
  add_custom_command(
    OUTPUT "${header}"
    COMMAND anholon::anholon generate "${arg_MODEL}" ${options} -o "${header}" --depfile "${folder}/${name}.d"
    # The program leaves a file alone that has the right bytes already, so make it newer than what it came from.
    COMMAND "${CMAKE_COMMAND}" -E touch "${header}"
    DEPENDS ${inputs} "$<TARGET_FILE:anholon::anholon>"
    DEPFILE "${folder}/${name}.d"
    COMMENT "Generating ${name}.hpp"
    VERBATIM)
  set(outputs "${header}")

  if(arg_STATIC)
    get_property(script GLOBAL PROPERTY ANHOLON_INSTANTIATE_SCRIPT)
    set(source "${folder}/${name}.cpp")
    set(wrapper "${include}/${name}.hpp")
    add_custom_command(
      OUTPUT "${source}" "${wrapper}"
      COMMAND "${CMAKE_COMMAND}" "-DHEADER=${header}" "-DSOURCE=${source}" "-DWRAPPER=${wrapper}" -P "${script}"
      DEPENDS "${header}" "${script}"
      COMMENT "Instantiating ${name}.hpp for double"
      VERBATIM)
    list(APPEND outputs "${source}" "${wrapper}")
    add_library(${target} STATIC "${source}")
    set(scope PUBLIC)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    if(NOT arg_COMPILE_OPTIONS)
      # Safe: generated code reads neither errno nor floating-point traps. Fast also where the build type is empty.
      # Compensated operations need each operation rounded by itself.
      set(arg_COMPILE_OPTIONS
        "$<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-O2;-fno-math-errno;-fno-trapping-math;-ffp-contract=off>"
        "$<$<CXX_COMPILER_ID:GNU>:-frename-registers>")
    endif()
    target_compile_options(${target} PRIVATE ${arg_COMPILE_OPTIONS})
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(${target} ${scope} "$<BUILD_INTERFACE:${include}>")
  target_compile_features(${target} ${scope} cxx_std_17)

  # Whoever links the target waits for its files, also from other folders.
  add_custom_target(${target}_generated DEPENDS ${outputs})
  add_dependencies(${target} ${target}_generated)
endfunction()

cmake_policy(POP)

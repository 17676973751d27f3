# SPDX-License-Identifier: GPL-2.0-or-later
#
# The same description gives the same bytes, whatever the memory looks like and whichever compiler built the program.
set(script "${CMAKE_CURRENT_LIST_DIR}/same_bytes.cmake")
set(work "${CMAKE_CURRENT_BINARY_DIR}/generated/same_bytes")
file(GLOB folders CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}/models" "${PROJECT_SOURCE_DIR}/models/*")
set(models "")
foreach(model IN LISTS folders)
  if(NOT EXISTS "${PROJECT_SOURCE_DIR}/models/${model}/${model}.toml")
    continue()
  endif()
  list(APPEND models ${model})
  add_test(NAME generated.same_bytes.${model} COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}"
    "-DPROGRAM=$<TARGET_FILE:anholon>" "-DMODELS=${model}" "-DWORK=${work}/${model}" -P "${script}")
  # The program runs six times for each model, and more for its scenes: two stand for all of them where time counts.
  set(label long)
  if(model MATCHES "^(mobile_pendulum|rigid_snakeboard)$")
    set(label slow)
  endif()
  set_tests_properties(generated.same_bytes.${model} PROPERTIES LABELS ${label} TIMEOUT 900 SKIP_REGULAR_EXPRESSION "^skipped: ")
endforeach()

# The program once more, by the compiler that did not build this one.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  find_program(ANHOLON_OTHER_CXX g++)
else()
  find_program(ANHOLON_OTHER_CXX clang++)
endif()
mark_as_advanced(ANHOLON_OTHER_CXX)
if(ANHOLON_OTHER_CXX)
  add_test(NAME generated.same_bytes_of_two_compilers COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}"
    "-DPROGRAM=$<TARGET_FILE:anholon>" "-DMODELS=${models}" "-DWORK=${work}/two_compilers" "-DCXX=${ANHOLON_OTHER_CXX}"
    "-DGENERATOR=${CMAKE_GENERATOR}" "-DLAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}" -P "${script}")
  set_tests_properties(generated.same_bytes_of_two_compilers PROPERTIES LABELS long RUN_SERIAL ON TIMEOUT 3600)
endif()

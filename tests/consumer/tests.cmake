# SPDX-License-Identifier: GPL-2.0-or-later
#
# The consumer project, built and run in every way; included by tests/CMakeLists.txt. The program of this build serves
# where the way is not about building it, so that these tests stay short; label `long` builds everything from its source.
set(prefix "${CMAKE_CURRENT_BINARY_DIR}/consumer/installed")
set(driver "${CMAKE_CURRENT_LIST_DIR}/run_consumer.cmake")

function(add_consumer_test name)
  add_test(NAME consumer.${name} COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}"
    "-DWORK=${CMAKE_CURRENT_BINARY_DIR}/consumer/${name}" "-DGENERATOR=${CMAKE_GENERATOR}" "-DCXX=${CMAKE_CXX_COMPILER}"
    "-DCXX_FLAGS=${CMAKE_CXX_FLAGS}" "-DLAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}" ${ARGN} -P "${driver}")
  set_tests_properties(consumer.${name} PROPERTIES LABELS install TIMEOUT 600)
endfunction()

add_test(NAME consumer.install COMMAND "${CMAKE_COMMAND}" --install "${PROJECT_BINARY_DIR}" --prefix "${prefix}")
set_tests_properties(consumer.install PROPERTIES LABELS install FIXTURES_SETUP installed)

# What is exported knows nothing of this build: neither its folders nor its options.
add_test(NAME consumer.exports_are_clean COMMAND "${CMAKE_COMMAND}" "-DPREFIX=${prefix}" "-DSOURCE=${PROJECT_SOURCE_DIR}"
  "-DBUILD=${PROJECT_BINARY_DIR}" -P "${CMAKE_CURRENT_LIST_DIR}/check_exports.cmake")
set_tests_properties(consumer.exports_are_clean PROPERTIES LABELS install FIXTURES_REQUIRED installed)

add_consumer_test(package -DUSES=package "-DPREFIX=${prefix}" -DBUILD_TYPE=Release)
set_tests_properties(consumer.package PROPERTIES FIXTURES_REQUIRED installed)
add_consumer_test(subdirectory -DUSES=subdirectory "-DPROGRAM=$<TARGET_FILE:anholon>" -DBUILD_TYPE=Release)
add_consumer_test(fetch_content -DUSES=fetch_content "-DPROGRAM=$<TARGET_FILE:anholon>" -DBUILD_TYPE=Debug
  -DBUILT_ONCE=ON)

add_consumer_test(subdirectory_from_source -DUSES=subdirectory -DBUILD_TYPE=Release)
set_tests_properties(consumer.subdirectory_from_source PROPERTIES LABELS long TIMEOUT 3600)

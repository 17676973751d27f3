# SPDX-License-Identifier: GPL-2.0-or-later
#
# Builds and runs the consumer project, and checks what a build system owes its user: nothing is written outside the
# build folder, nothing is built twice, a change of the model reaches the program.
#
#   cmake -DUSES=package|subdirectory|fetch_content -DSOURCE=<anholon> -DWORK=<folder> -DGENERATOR=<cmake generator>
#         [-DPREFIX=<installed anholon>] [-DPROGRAM=<anholon>] [-DCOMPONENTS=<find_package arguments>]
#         [-DBUILD_TYPE=<type>] [-DCXX=<compiler>] [-DCXX_FLAGS=<flags>] [-DLAUNCHER=<launcher>] [-DBUILT_ONCE=ON] -P run_consumer.cmake
cmake_minimum_required(VERSION 3.22)

file(REMOVE_RECURSE "${WORK}")
set(project "${WORK}/project")
set(build "${WORK}/build")
file(COPY "${CMAKE_CURRENT_LIST_DIR}/" DESTINATION "${project}")
file(COPY "${SOURCE}/models/bicycle/" "${SOURCE}/bench/free_chain.urdf" DESTINATION "${project}/model")
file(WRITE "${project}/model/chain.toml" "anholon = 1\nname = \"chain\"\nurdf = \"free_chain.urdf\"\ngroup = \"SE3\"\n")

function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text ECHO_OUTPUT_VARIABLE
    ECHO_ERROR_VARIABLE)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " shown)
    message(FATAL_ERROR "status ${status} of: ${shown}")
  endif()
  set(text "${text}" PARENT_SCOPE)
endfunction()

# Names and contents of all files of a folder.
function(fingerprint folder result)
  file(GLOB_RECURSE files LIST_DIRECTORIES true RELATIVE "${folder}" "${folder}/*")
  set(text "")
  foreach(file IN LISTS files)
    if(NOT IS_DIRECTORY "${folder}/${file}")
      file(SHA256 "${folder}/${file}" hash)
      string(APPEND text "${file} ${hash}\n")
    endif()
  endforeach()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

function(expect_header pattern)
  foreach(header IN ITEMS bicycle/include/bicycle.hpp bicycle_compiled/generated/bicycle.hpp)
    file(READ "${build}/anholon_models/${header}" text)
    if(NOT text MATCHES "${pattern}")
      message(FATAL_ERROR "${header} does not match '${pattern}'")
    endif()
  endforeach()
endfunction()

fingerprint("${project}" before)
run(${CMAKE_COMMAND} -S "${project}" -B "${build}" -G "${GENERATOR}" "-DCMAKE_BUILD_TYPE=${BUILD_TYPE}"
  "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}" "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}"
  "-DCONSUMER_USES=${USES}" "-DANHOLON_SOURCE=${SOURCE}" "-DANHOLON_PROGRAM=${PROGRAM}" "-DCMAKE_PREFIX_PATH=${PREFIX}"
  "-DCONSUMER_COMPONENTS=${COMPONENTS}")
run(${CMAKE_COMMAND} --build "${build}")
run("${build}/controller/balance")
run("${build}/controller/balance_compiled")
run("${build}/controller/weave")
run("${build}/controller/weight")
if(EXISTS "${build}/embedded_generator")
  run("${build}/embedded_generator" "${project}/model/bicycle.toml")
elseif(COMPONENTS MATCHES "generator")
  message(FATAL_ERROR "the component generator gave no anholon::generator")
endif()
fingerprint("${project}" after)
if(NOT before STREQUAL after)
  message(FATAL_ERROR "the build wrote to the source folder; before:\n${before}after:\n${after}")
endif()

# Nothing to do, nothing done.
run(${CMAKE_COMMAND} --build "${build}")
if(GENERATOR STREQUAL "Ninja" AND NOT text MATCHES "no work to do")
  message(FATAL_ERROR "a second build was not idle")
endif()

expect_header("m_0 = detail::constant<Real>\\(8")
foreach(model IN ITEMS bicycle/include bicycle_compiled/generated)  # SINCOS reaches the program
  file(READ "${build}/anholon_models/${model}/bicycle.hpp" text)
  string(FIND "${text}" "detail::sines_cosines(" at)
  if((model MATCHES "compiled" AND at EQUAL -1) OR (NOT model MATCHES "compiled" AND NOT at EQUAL -1))
    message(FATAL_ERROR "SINCOS has not its effect on ${model}/bicycle.hpp")
  endif()
endforeach()
if(BUILT_ONCE)  # how a change reaches the program doesn't depend on where anholon comes from
  return()
endif()
file(READ "${project}/model/bicycle.toml" text)
string(REPLACE "m_0   = { value = 8," "m_0   = { value = 9," text "${text}")
file(WRITE "${project}/model/bicycle.toml" "${text}")
run(${CMAKE_COMMAND} --build "${build}")
expect_header("m_0 = detail::constant<Real>\\(9")
foreach(part IN ITEMS balance balance_compiled)
  if(NOT text MATCHES "${part}")
    message(FATAL_ERROR "the new model did not reach ${part}")
  endif()
endforeach()
run(${CMAKE_COMMAND} --build "${build}" --target chain_generated)
file(APPEND "${project}/model/free_chain.urdf" "<!-- changed -->\n")
run(${CMAKE_COMMAND} --build "${build}" --target chain_generated)
if(NOT text MATCHES "Generating chain.hpp")
  message(FATAL_ERROR "a new robot file did not reach the model that stands on it")
endif()

# A model with a fault stops the build at its line.
file(APPEND "${project}/model/bicycle.toml" "\n[[nonsense]]\n")
execute_process(COMMAND ${CMAKE_COMMAND} --build "${build}" RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
if(status EQUAL 0 OR NOT text MATCHES "bicycle\\.toml:[0-9]+:[0-9]+: error: ")
  message(FATAL_ERROR "a faulty model did not stop the build with its place:\n${text}")
endif()

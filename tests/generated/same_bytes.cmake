# SPDX-License-Identifier: GPL-2.0-or-later
#
# The same description gives the same bytes: writes everything that the program makes of some models several times and
# compares. GiNaC orders its terms by address, so that another layout of the memory is the hardest witness.
#
#   cmake -DSOURCE=<anholon> -DPROGRAM=<anholon> -DMODELS=<name>[;<name>...] -DWORK=<folder>
#         [-DCXX=<compiler> -DGENERATOR=<cmake generator> [-DLAUNCHER=<launcher>]] -P same_bytes.cmake
#
# Without CXX the program runs twice, and once without address randomisation. With CXX it is built again by that
# compiler, and both programs run.
cmake_minimum_required(VERSION 3.22)

file(REMOVE_RECURSE "${WORK}/first" "${WORK}/second" "${WORK}/unmoved" "${WORK}/other")
file(MAKE_DIRECTORY "${WORK}")

function(run)
  # Elsewhere than the description is: no path may reach the output.
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY "${WORK}" RESULT_VARIABLE status OUTPUT_VARIABLE text
    ERROR_VARIABLE text)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " shown)
    message(FATAL_ERROR "status ${status} of: ${shown}\n${text}")
  endif()
endfunction()

# Headers, C interfaces, tables and equations of the models and of their scenes; ARGN is the program, after its wrapper.
function(write_all name)
  foreach(model IN LISTS MODELS)
    set(folder "${SOURCE}/models/${model}")
    set(output "${WORK}/${name}/${model}")
    run(${ARGN} generate "${folder}/${model}.toml" --c-abi -o "${output}/standard.hpp")
    run(${ARGN} explain "${folder}/${model}.toml" -o "${output}/equations.md")
    file(GLOB scenes "${folder}/*.scene.toml")
    foreach(scene IN LISTS scenes)
      run(${ARGN} generate "${scene}" -o "${output}")
    endforeach()
  endforeach()
endfunction()

function(expect_same a b)
  file(GLOB_RECURSE files_a RELATIVE "${a}" "${a}/*")
  file(GLOB_RECURSE files_b RELATIVE "${b}" "${b}/*")
  if(NOT files_a OR NOT files_a STREQUAL files_b)
    message(FATAL_ERROR "other files; in ${a}: ${files_a}; in ${b}: ${files_b}")
  endif()
  foreach(file IN LISTS files_a)
    file(SHA256 "${a}/${file}" hash_a)
    file(SHA256 "${b}/${file}" hash_b)
    if(NOT hash_a STREQUAL hash_b)
      message(FATAL_ERROR "not the same bytes: diff '${a}/${file}' '${b}/${file}'")
    endif()
  endforeach()
endfunction()

write_all(first "${PROGRAM}")
if(CXX)
  set(build "${WORK}/build")
  run(${CMAKE_COMMAND} -S "${SOURCE}" -B "${build}" -G "${GENERATOR}" -DCMAKE_BUILD_TYPE=Release
    "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" -DANHOLON_BUILD_TESTS=OFF
    -DANHOLON_BUILD_BENCH=OFF)
  run(${CMAKE_COMMAND} --build "${build}" --target anholon)
  write_all(other "${build}/generator/anholon")
  expect_same("${WORK}/first" "${WORK}/other")
else()
  write_all(second "${PROGRAM}")
  expect_same("${WORK}/first" "${WORK}/second")
  set(unmoved setarch ${CMAKE_HOST_SYSTEM_PROCESSOR} --addr-no-randomize)
  execute_process(COMMAND ${unmoved} ${CMAKE_COMMAND} -E true RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(NOT status EQUAL 0)
    message("skipped: setarch cannot switch address randomisation off here")
    return()
  endif()
  write_all(unmoved ${unmoved} "${PROGRAM}")
  expect_same("${WORK}/first" "${WORK}/unmoved")
endif()

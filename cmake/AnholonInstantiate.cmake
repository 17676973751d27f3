# SPDX-License-Identifier: MIT
#
# Run by anholon_add_model(... STATIC) at build time:
#
#   cmake -DHEADER=<generated header> -DSOURCE=<file> -DWRAPPER=<file> -P AnholonInstantiate.cmake
#
# Writes SOURCE, which instantiates every function of the header for double, and WRAPPER, a header of the same name
# which includes HEADER and declares those instances, so that callers link them in place of compiling them again.
# The functions come from the JSON beside the header.
cmake_minimum_required(VERSION 3.22)

get_filename_component(name "${HEADER}" NAME)
get_filename_component(folder "${HEADER}" DIRECTORY)
get_filename_component(stem "${HEADER}" NAME_WLE)
file(READ "${folder}/${stem}.json" table)
file(READ "${HEADER}" text)
if(NOT text MATCHES "\nnamespace ([A-Za-z_][A-Za-z0-9_:]*) {\n")
  message(FATAL_ERROR "${HEADER} opens no namespace: it does not come from this version of anholon")
endif()
set(namespace "${CMAKE_MATCH_1}")

set(functions prepare)
string(JSON count LENGTH "${table}" functions)
if(count GREATER 0)
  math(EXPR last "${count} - 1")
  foreach(i RANGE ${last})
    string(JSON function GET "${table}" functions ${i} name)
    list(APPEND functions "${function}")
  endforeach()
endif()

set(definitions "")
set(declarations "")
foreach(function IN LISTS functions)
  set(instance "${namespace}::${function}<double>")
  # The type of a function is all that an instantiation needs.
  string(APPEND definitions "template decltype(${instance}) ${instance};\n")
  string(APPEND declarations "extern template decltype(${instance}) ${instance};\n")
endforeach()

set(head "// SPDX-License-Identifier: MIT\n// Made by anholon_add_model: do not edit.\n")
file(RELATIVE_PATH path "${folder}/.." "${HEADER}")  # generated/<name>.hpp
file(CONFIGURE OUTPUT "${SOURCE}" @ONLY CONTENT "@head@#include \"@path@\"\n\n@definitions@")
file(CONFIGURE OUTPUT "${WRAPPER}" @ONLY
  CONTENT "@head@// @name@, whose functions of double are compiled into a library.\n#pragma once\n#include \"../@path@\"\n\n@declarations@")
file(TOUCH "${SOURCE}" "${WRAPPER}")

# SPDX-License-Identifier: GPL-2.0-or-later
#
# `cmake --install`: the program with anholon_add_model(), the runtime, the generator as a library, the models.
# Three sets of targets, because the program alone must work where neither Eigen nor GiNaC is installed.
include(CMakePackageConfigHelpers)
set(ANHOLON_CMAKE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/anholon")

install(TARGETS anholon_runtime EXPORT anholon-runtime)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/runtime/include/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(EXPORT anholon-runtime FILE anholon-runtime-targets.cmake NAMESPACE anholon::
  DESTINATION "${ANHOLON_CMAKE_DIR}")

if(ANHOLON_BUILD_GENERATOR)
  install(TARGETS anholon EXPORT anholon-program)
  install(EXPORT anholon-program FILE anholon-program-targets.cmake NAMESPACE anholon::
    DESTINATION "${ANHOLON_CMAKE_DIR}")

  install(TARGETS anholon_generator EXPORT anholon-generator)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/generator/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/anholon-generator"
    FILES_MATCHING PATTERN "*.hpp" PATTERN cli EXCLUDE)
  install(EXPORT anholon-generator FILE anholon-generator-targets.cmake NAMESPACE anholon::
    DESTINATION "${ANHOLON_CMAKE_DIR}")
endif()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/anholon-config.cmake.in"
  "${CMAKE_CURRENT_BINARY_DIR}/anholon-config.cmake" INSTALL_DESTINATION "${ANHOLON_CMAKE_DIR}")
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/anholon-config-version.cmake"
  COMPATIBILITY SameMinorVersion)  # below 1.0 a minor version may change the description or the contract
install(FILES
  "${CMAKE_CURRENT_BINARY_DIR}/anholon-config.cmake"
  "${CMAKE_CURRENT_BINARY_DIR}/anholon-config-version.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/AnholonAddModel.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/AnholonInstantiate.cmake"
  DESTINATION "${ANHOLON_CMAKE_DIR}")

install(DIRECTORY "${PROJECT_SOURCE_DIR}/models" DESTINATION "${CMAKE_INSTALL_DATADIR}/anholon")
install(DIRECTORY "${PROJECT_SOURCE_DIR}/LICENSES" DESTINATION "${CMAKE_INSTALL_DOCDIR}")

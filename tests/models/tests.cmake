# SPDX-License-Identifier: GPL-2.0-or-later
# Every shipped model passes `anholon verify`: one process a model, few states.
set(few_states ANHOLON_CACHE=${PROJECT_BINARY_DIR}/verify_cache ${ANHOLON_TEST_ENVIRONMENT})
file(GLOB ANHOLON_MODEL_FOLDERS CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/models ${PROJECT_SOURCE_DIR}/models/*)
foreach(model IN LISTS ANHOLON_MODEL_FOLDERS)
  file(GLOB descriptions CONFIGURE_DEPENDS
    ${PROJECT_SOURCE_DIR}/models/${model}/*.toml ${PROJECT_SOURCE_DIR}/models/${model}/*.urdf)
  list(FILTER descriptions EXCLUDE REGEX "\\.scene\\.toml$")
  foreach(description IN LISTS descriptions)
    get_filename_component(name ${description} NAME_WE)
    set(options --samples 12)
    if(description MATCHES "\\.urdf$" AND NOT name STREQUAL "arm7")
      list(APPEND options --floating)
    endif()
    add_test(NAME Verify.${name} COMMAND anholon verify ${description} ${options})
    set_tests_properties(Verify.${name} PROPERTIES LABELS slow TIMEOUT 900 ENVIRONMENT "${few_states}")
    # At many states and with a tighter bound: the rounding of generated code, model by model.
    list(TRANSFORM options REPLACE "^12$" "100000")
    add_test(NAME Ulps.${name} COMMAND anholon verify ${description} ${options} --bound 50)
    set_tests_properties(Ulps.${name} PROPERTIES LABELS long TIMEOUT 7200
      ENVIRONMENT ANHOLON_CACHE=${PROJECT_BINARY_DIR}/verify_cache)
  endforeach()
endforeach()

# One function alone is verified with what its comparison starts from.
foreach(function IN ITEMS inverse_torques energies multipliers)
  add_test(NAME Verify.${function}_alone COMMAND anholon verify
    ${PROJECT_SOURCE_DIR}/models/trailer/trailer.toml --functions ${function} --samples 5)
  set_tests_properties(Verify.${function}_alone PROPERTIES LABELS slow TIMEOUT 900 ENVIRONMENT "${few_states}")
endforeach()

# The derivatives of the rates of the state, against differences in exact arithmetic: in the plane and in space, with motions and
# with torques, in several charts.
foreach(model IN ITEMS soft_snakeboard/soft_snakeboard.toml whipple_bicycle/whipple_bicycle.toml
                       wheeled_snake3/wheeled_snake3.toml two_wheeled_pendulum/balance.scene.toml)
  get_filename_component(name ${model} NAME_WE)
  add_test(NAME Verify.state_jacobian_of_${name} COMMAND anholon verify
    ${PROJECT_SOURCE_DIR}/models/${model} --functions state_jacobian --samples 5)
  set_tests_properties(Verify.state_jacobian_of_${name} PROPERTIES LABELS slow TIMEOUT 900 ENVIRONMENT "${few_states}")
endforeach()

# SPDX-License-Identifier: GPL-2.0-or-later
# Measures a model twice into the same folder. -DPROGRAM, -DSOURCE, -DFOLDER
file(REMOVE_RECURSE ${FOLDER})
foreach(result IN ITEMS "[0-9.]+ s" "kept from an earlier run")
  execute_process(COMMAND ${PROGRAM} report ${SOURCE}/models/double_pendulum/double_pendulum.toml --no-motions
    --samples 5 -o ${FOLDER} OUTPUT_VARIABLE printed RESULT_VARIABLE status)
  if(NOT status EQUAL 0 OR NOT printed MATCHES "double_pendulum: ${result}\n")
    message(FATAL_ERROR "status ${status}, wanted '${result}':\n${printed}")
  endif()
endforeach()
foreach(file IN ITEMS index.html report.json)
  if(NOT EXISTS ${FOLDER}/${file})
    message(FATAL_ERROR "no ${file}")
  endif()
endforeach()

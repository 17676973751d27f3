# SPDX-License-Identifier: GPL-2.0-or-later
# Measures a model with its motions and opens the page in a browser without a window: what the browser has made of it
# holds the tables and the plots, and a picture of it is drawn. -DPROGRAM, -DSOURCE, -DFOLDER, -DCHROMIUM
file(REMOVE_RECURSE ${FOLDER})
execute_process(COMMAND ${PROGRAM} report ${SOURCE}/models/double_pendulum/double_pendulum.toml --samples 20 -o ${FOLDER}
  COMMAND_ERROR_IS_FATAL ANY)
set(browser ${CHROMIUM} --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking
  --disable-component-update --disable-sync --user-data-dir=${FOLDER}/profile --window-size=1200,1600)
execute_process(COMMAND ${browser} --dump-dom file://${FOLDER}/index.html
  OUTPUT_VARIABLE dom ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
foreach(wanted IN ITEMS "<title>anholon: speed against error</title>" "<td>forward_dynamics</td>"
    "<h2 id=\"double_pendulum\">" "error of the final state")
  string(FIND "${dom}" "${wanted}" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "the page has no ${wanted}")
  endif()
endforeach()
execute_process(COMMAND ${browser} --screenshot=${FOLDER}/page.png file://${FOLDER}/index.html
  OUTPUT_QUIET ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(SIZE ${FOLDER}/page.png size)
if(size LESS 20000)
  message(FATAL_ERROR "a picture of ${size} bytes is empty")
endif()

# SPDX-License-Identifier: GPL-2.0-or-later
# The verb `report`: twice, since the second time keeps what the first has measured; with motions in a real browser.
add_test(NAME Report.IsMeasuredOnce COMMAND ${CMAKE_COMMAND}
  -DPROGRAM=$<TARGET_FILE:anholon> -DSOURCE=${PROJECT_SOURCE_DIR} -DFOLDER=${CMAKE_CURRENT_BINARY_DIR}/report_once
  -P ${CMAKE_CURRENT_SOURCE_DIR}/report/measured_once.cmake)
set_tests_properties(Report.IsMeasuredOnce PROPERTIES LABELS slow TIMEOUT 900
  ENVIRONMENT ANHOLON_CACHE=${PROJECT_BINARY_DIR}/verify_cache)
find_program(CHROMIUM NAMES chromium)
if(CHROMIUM)
  add_test(NAME Report.InABrowser COMMAND ${CMAKE_COMMAND}
    -DPROGRAM=$<TARGET_FILE:anholon> -DSOURCE=${PROJECT_SOURCE_DIR} -DFOLDER=${CMAKE_CURRENT_BINARY_DIR}/report_browser
    -DCHROMIUM=${CHROMIUM} -P ${CMAKE_CURRENT_SOURCE_DIR}/report/browser.cmake)
  set_tests_properties(Report.InABrowser PROPERTIES LABELS long TIMEOUT 1800
    ENVIRONMENT ANHOLON_CACHE=${PROJECT_BINARY_DIR}/verify_cache)
endif()

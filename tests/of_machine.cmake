# SPDX-License-Identifier: MIT
# What tests of the machine, of the Python package and of the lab need beside their places.

# The console, on bare sockets and in a browser: host_sim/console/console_<name>.py.
find_program(SV_PYTHON NAMES python3 DOC "The interpreter of tests in Python")
set(console_tests author browser life server)
if(NOT SV_SANITIZE) # what these drive is driven by the others, too, and they take minutes there
  list(APPEND console_tests brush given hand proxy reader sonographer)
endif()
set(SV_TEST_PART host_sim)
foreach(name ${console_tests})
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/host_sim/console/console_${name}.py)
  sv_register_test(test_console_${name} console ${script} ${SV_PYTHON} -B ${script} ${CMAKE_BINARY_DIR})
endforeach()

# The Python package; see there.
add_subdirectory(python)

# Every program, the package's among them, on machines that are not as they should be.
if(NOT SV_SANITIZE)
  set(SV_TEST_PART house)
  set(script ${CMAKE_CURRENT_SOURCE_DIR}/house/fault/machines.py)
  sv_register_test(test_machines fault ${script} ${SV_PYTHON} -B ${script} ${CMAKE_BINARY_DIR})
  foreach(test fault/test_machines fault/test_machines_night)
    set_tests_properties(${test} PROPERTIES FIXTURES_REQUIRED python_environment COST 30)
  endforeach()
endif()

# The machine as a library.
target_link_libraries(test_door PRIVATE smartvis_host)
target_link_libraries(test_door_told PRIVATE smartvis_host)
target_link_libraries(test_door_sizes PRIVATE smartvis_host)
add_dependencies(test_door host_sim wrong_plugins)

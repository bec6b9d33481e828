# SPDX-License-Identifier: MIT
# SV_VERSION in sv_version.h, "1.0.0+6da99c0a3f21": the version and the commit that is built. The file is looked after at every build,
# and written when that differs. What links sv_version may include it: few small files, so that a commit rebuilds little. commit.txt
# beside the plugin has the commit for Python.
set(SV_VERSION_FOLDER ${CMAKE_BINARY_DIR}/obj/version)
add_custom_target(sv_stamp
  COMMAND ${CMAKE_COMMAND} -DVERSION=${PROJECT_VERSION} -DSOURCE=${CMAKE_SOURCE_DIR} -DHEADER=${SV_VERSION_FOLDER}/sv_version.h
          -DCOMMIT=${CMAKE_BINARY_DIR}/commit.txt -P ${CMAKE_CURRENT_LIST_DIR}/stamp.cmake
  BYPRODUCTS ${SV_VERSION_FOLDER}/sv_version.h ${CMAKE_BINARY_DIR}/commit.txt
  COMMENT "" VERBATIM)
add_library(sv_version INTERFACE)
target_include_directories(sv_version INTERFACE ${SV_VERSION_FOLDER})
add_dependencies(sv_version sv_stamp)
add_dependencies(embedded sv_stamp)

# SPDX-License-Identifier: MIT
# find_package(SmartVisPlugin 1.0): the headers for a plugin or a host. The version is that of the ABI.
#
#   SmartVis::Plugin             interface target: the include folder of smartvis_plugin.h and smartvis/*.h. A plugin with
#                                kernels (smartvis/author_cl.h) links OpenCL::OpenCL besides.
#   SmartVisPlugin_INCLUDE_DIR   that folder
#   SmartVisPlugin_PLUGIN_DIR    where a plugin is installed, so that hosts of this installation find it
#   smartvis_kernels(...)        the kernels of a .cl file as a header (SmartVisPluginKernels.cmake)
#
# All paths are told from where this file lies: an installation can be moved.
get_filename_component(SmartVisPlugin_PREFIX "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(SmartVisPlugin_INCLUDE_DIR "${SmartVisPlugin_PREFIX}/include")
set(SmartVisPlugin_PLUGIN_DIR "${SmartVisPlugin_PREFIX}/lib/smartvis")
if(NOT EXISTS "${SmartVisPlugin_INCLUDE_DIR}/smartvis_plugin.h")
  set(SmartVisPlugin_FOUND FALSE)
  set(SmartVisPlugin_NOT_FOUND_MESSAGE "no smartvis_plugin.h in ${SmartVisPlugin_INCLUDE_DIR}")
  return()
endif()
if(NOT TARGET SmartVis::Plugin)
  add_library(SmartVis::Plugin INTERFACE IMPORTED)
  set_target_properties(SmartVis::Plugin PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${SmartVisPlugin_INCLUDE_DIR}")
endif()
include("${CMAKE_CURRENT_LIST_DIR}/SmartVisPluginKernels.cmake")

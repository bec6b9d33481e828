# SPDX-License-Identifier: MIT
# What is installed, and where: every path is relative to the prefix, and each part finds the others from where it lies
# itself, so that an installation can be moved. The build folder mirrors it: CMAKE_PREFIX_PATH=<build folder> finds the
# headers, and build/host_sim its scenes.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
# Not ${CMAKE_INSTALL_LIBDIR}: hosts look in <prefix>/lib/smartvis on every system (docs/abi.md).
set(SV_PLUGIN_FOLDER lib/smartvis)
set(SV_PACKAGE_FOLDER share/cmake/SmartVisPlugin)
set(SV_PC_FOLDER share/pkgconfig)

# The packages' version is that of the ABI: it is what a plugin or a host is written for.
file(STRINGS ${CMAKE_SOURCE_DIR}/include/smartvis_plugin.h SV_ABI_LINES REGEX "^#define SV_ABI_(MAJOR|MINOR) [0-9]+u")
string(REGEX REPLACE ".*MAJOR ([0-9]+)u.*MINOR ([0-9]+)u.*" "\\1.\\2" SV_ABI_VERSION "${SV_ABI_LINES}")
if(NOT SV_ABI_VERSION MATCHES "^[0-9]+\\.[0-9]+$")
  message(FATAL_ERROR "include/smartvis_plugin.h: no SV_ABI_MAJOR and SV_ABI_MINOR, found '${SV_ABI_LINES}'")
endif()
foreach(part Config Kernels)
  configure_file(cmake/SmartVisPlugin${part}.cmake ${SV_PACKAGE_FOLDER}/SmartVisPlugin${part}.cmake COPYONLY)
endforeach()
write_basic_package_version_file(${CMAKE_BINARY_DIR}/${SV_PACKAGE_FOLDER}/SmartVisPluginConfigVersion.cmake
  VERSION ${SV_ABI_VERSION} COMPATIBILITY SameMajorVersion ARCH_INDEPENDENT)
configure_file(cmake/smartvis-plugin.pc.in ${SV_PC_FOLDER}/smartvis-plugin.pc @ONLY)
if(NOT WIN32)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share/smartvis)
  file(CREATE_LINK ${CMAKE_SOURCE_DIR}/data/scenes ${CMAKE_BINARY_DIR}/share/smartvis/scenes SYMBOLIC)
  file(CREATE_LINK ${CMAKE_SOURCE_DIR}/include ${CMAKE_BINARY_DIR}/include SYMBOLIC)
  # So that the commands of the examples hold for both.
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/bin ${CMAKE_BINARY_DIR}/${SV_PLUGIN_FOLDER})
  file(CREATE_LINK ../../smartvis.so ${CMAKE_BINARY_DIR}/${SV_PLUGIN_FOLDER}/smartvis.so SYMBOLIC)
  foreach(program host_sim sv_validate)
    file(CREATE_LINK ../${program} ${CMAKE_BINARY_DIR}/bin/${program} SYMBOLIC)
  endforeach()
  # Here Python would take smartvis.so for its module: it looks for a folder first.
  file(CREATE_LINK ${CMAKE_SOURCE_DIR}/python/smartvis ${CMAKE_BINARY_DIR}/smartvis SYMBOLIC)
  foreach(folder examples bindings)
    file(CREATE_LINK ${CMAKE_SOURCE_DIR}/${folder} ${CMAKE_BINARY_DIR}/share/smartvis/${folder} SYMBOLIC)
  endforeach()
endif()

set(SV_INSTALLED smartvis)
foreach(target host_sim sv_validate sv_replay sv_bench smartvis_check smartvis_host)
  if(TARGET ${target})
    list(APPEND SV_INSTALLED ${target})
  endif()
endforeach()
set(SV_PROGRAMS ${SV_INSTALLED})
list(FILTER SV_PROGRAMS EXCLUDE REGEX "^smartvis")
if(SV_PROGRAMS)
  install(TARGETS ${SV_PROGRAMS} RUNTIME DESTINATION bin COMPONENT smartvis)
endif()
install(TARGETS smartvis LIBRARY DESTINATION ${SV_PLUGIN_FOLDER} COMPONENT smartvis)
# Not where hosts look: it would be a second plugin of the same id.
if(TARGET smartvis_check)
  install(TARGETS smartvis_check LIBRARY DESTINATION ${SV_PLUGIN_FOLDER}/check COMPONENT smartvis)
endif()
install(DIRECTORY data/scenes DESTINATION share/smartvis COMPONENT smartvis FILES_MATCHING PATTERN "*.json"
  PATTERN "*.mha")
install(FILES LICENSE README.md CHANGELOG.md SECURITY.md DESTINATION share/doc/smartvis COMPONENT smartvis)
install(DIRECTORY docs DESTINATION share/doc/smartvis COMPONENT smartvis FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.jpg")
install(DIRECTORY lab/notes DESTINATION share/doc/smartvis/lab COMPONENT smartvis)

if(TARGET smartvis_host)
  install(TARGETS smartvis_host LIBRARY DESTINATION lib COMPONENT smartvis NAMELINK_COMPONENT dev
    RUNTIME DESTINATION bin COMPONENT smartvis ARCHIVE DESTINATION lib COMPONENT dev)
  install(FILES host_sim/door/smartvis_host.h DESTINATION include COMPONENT dev)
endif()
install(DIRECTORY include/ DESTINATION include COMPONENT dev FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp")
install(DIRECTORY ${CMAKE_BINARY_DIR}/${SV_PACKAGE_FOLDER}/ DESTINATION ${SV_PACKAGE_FOLDER} COMPONENT dev
  FILES_MATCHING PATTERN "*.cmake")
install(FILES ${CMAKE_BINARY_DIR}/${SV_PC_FOLDER}/smartvis-plugin.pc DESTINATION ${SV_PC_FOLDER} COMPONENT dev)
install(DIRECTORY examples DESTINATION share/smartvis COMPONENT dev
  PATTERN build EXCLUDE
  PATTERN examples/CMakeLists.txt EXCLUDE)
install(DIRECTORY bindings DESTINATION share/smartvis COMPONENT dev
  PATTERN target EXCLUDE
  PATTERN Cargo.lock EXCLUDE)

# Manual pages are made from what the programs say of themselves, so they cannot differ from it.
if(NOT WIN32 AND NOT CMAKE_CROSSCOMPILING)
  foreach(program ${SV_PROGRAMS})
    set(page ${CMAKE_BINARY_DIR}/share/man/man1/${program}.1)
    add_custom_command(OUTPUT ${page}
      COMMAND bash ${CMAKE_SOURCE_DIR}/scripts/man_page.sh $<TARGET_FILE:${program}> ${page}
      DEPENDS ${program} ${CMAKE_SOURCE_DIR}/scripts/man_page.sh
      COMMENT "Manual page ${program}(1)" VERBATIM)
    list(APPEND SV_MAN_PAGES ${page})
  endforeach()
  add_custom_target(man_pages ALL DEPENDS ${SV_MAN_PAGES})
  install(FILES ${SV_MAN_PAGES} DESTINATION share/man/man1 COMPONENT smartvis)
endif()

# What an installation is made of, and nothing else, for `make install`.
add_custom_target(installed DEPENDS ${SV_INSTALLED} ${SV_MAN_PAGES})

# Last: the sums of all that was put there, for `host_sim verify` and `sha256sum -c`. Only of a whole installation.
install(CODE [[
  set(sums "")
  set(prefix "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}")
  list(SORT CMAKE_INSTALL_MANIFEST_FILES)
  foreach(file ${CMAKE_INSTALL_MANIFEST_FILES})
    file(RELATIVE_PATH name "${CMAKE_INSTALL_PREFIX}" "${file}")
    if(NOT IS_SYMLINK "$ENV{DESTDIR}${file}")
      file(SHA256 "$ENV{DESTDIR}${file}" sum)
      string(APPEND sums "${sum}  ${name}\n")
    endif()
  endforeach()
  file(WRITE "${prefix}/share/smartvis/sums/smartvis.sha256" "${sums}")
]])

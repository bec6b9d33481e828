# SPDX-License-Identifier: MIT
# smartvis_kernels(<target> <name>.cl): what the target includes as kernels_<name>.h has the file's text as
# `static const char kernels_<name>[]`. A `#line` stands before it, so that build errors name the file and its lines.
function(smartvis_kernels target file)
  get_filename_component(path ${file} ABSOLUTE)
  get_filename_component(symbol ${file} NAME_WE)
  get_filename_component(file ${file} NAME)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/smartvis_kernels)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path}) # a change of the file makes the header anew
  file(READ ${path} text HEX)
  string(HEX "#line 1 \"${file}\"\n" line)
  # Characters, not a string: ISO C bounds the length of a literal.
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," text "${line}${text}")
  file(GENERATE OUTPUT ${out}/kernels_${symbol}.h CONTENT "static const char kernels_${symbol}[] = {${text}0};\n")
  target_include_directories(${target} PRIVATE ${out})
endfunction()

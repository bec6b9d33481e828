# SPDX-License-Identifier: MIT
# sv_embed(<out.h> <symbol> <file>...): a header with the files, one after the other, as one byte array
# `static const unsigned char <symbol>[]` and its length `<symbol>_size`. A `#line 1 "<file>"` stands before each,
# so that a kernel's build log names the real file. A byte array, not a string: ISO C bounds the length of a literal.
# All headers that are made so are the target embedded: what reads sources without compiling them needs them.
add_custom_target(embedded)
set(SV_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_script.cmake)
# sv_embed_text(<out.h> <symbol> <file>...): the same without the lines between, for what is no kernel.
function(sv_embed out symbol)
  sv_embed_as(lines ${out} ${symbol} ${ARGN})
endfunction()
function(sv_embed_text out symbol)
  sv_embed_as(plain ${out} ${symbol} ${ARGN})
endfunction()
function(sv_embed_as how out symbol)
  set(inputs)
  foreach(file ${ARGN})
    get_filename_component(path ${file} ABSOLUTE BASE_DIR ${CMAKE_SOURCE_DIR})
    list(APPEND inputs ${path})
  endforeach()
  string(REPLACE ";" "|" joined "${inputs}")
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DHOW=${how} -DOUT=${out} -DSYMBOL=${symbol} -DINPUTS=${joined} -DROOT=${CMAKE_SOURCE_DIR}
            -P ${SV_EMBED_SCRIPT}
    DEPENDS ${inputs} ${SV_EMBED_SCRIPT}
    COMMENT "Embedding ${symbol}"
    VERBATIM)
  string(MAKE_C_IDENTIFIER embedded_${out} target)
  add_custom_target(${target} DEPENDS ${out})
  add_dependencies(embedded ${target})
endfunction()

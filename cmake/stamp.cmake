# SPDX-License-Identifier: MIT
# cmake -DVERSION=.. -DSOURCE=.. -DHEADER=.. -DCOMMIT=.. -P stamp.cmake: writes the version with its commit as SV_VERSION into HEADER, and
# the commit alone into COMMIT; a file that says so already stays as old as it is. The commit is what `git archive` wrote into
# commit.txt, else git's of SOURCE, with ".changed" where files differ from it. Where neither knows it, the version stands alone.
file(STRINGS ${SOURCE}/cmake/commit.txt commit LIMIT_COUNT 1)
if(NOT commit MATCHES "^[0-9a-f]+$")
  set(commit "")
  find_program(GIT git)
  if(GIT)
    # Sources that were unpacked inside of another repository are none of its commits.
    execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --show-prefix HEAD
      OUTPUT_VARIABLE said ERROR_QUIET RESULT_VARIABLE code OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(code EQUAL 0 AND said MATCHES "^\n?([0-9a-f]+)$")
      set(commit ${CMAKE_MATCH_1})
      execute_process(COMMAND ${GIT} --no-optional-locks -C ${SOURCE} status --porcelain OUTPUT_VARIABLE changes)
    endif()
  endif()
endif()
string(SUBSTRING "${commit}" 0 12 commit)
if(changes)
  string(APPEND commit ".changed")
endif()
set(version ${VERSION})
if(commit)
  string(APPEND version "+${commit}")
endif()

function(put path text)
  if(EXISTS ${path})
    file(READ ${path} old)
  endif()
  if(NOT "${old}" STREQUAL "${text}")
    file(WRITE ${path} "${text}")
  endif()
endfunction()
put(${HEADER} "/* made by cmake/stamp.cmake */\n#define SV_VERSION \"${version}\"\n")
put(${COMMIT} "${commit}\n")

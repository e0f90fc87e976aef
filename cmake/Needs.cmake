# SPDX-License-Identifier: Apache-2.0
# What the project needs of other people, and what of it is missing here: told all at once, each with the package that brings
# it. tools/demo and tools/test ask with -DDISPARITYD_REPORT_NEEDS=FILE, which only writes the list.

# disparityd_need(WHAT FOUND [FOR build|test] PACKAGES ALTERNATIVE... [HINT TEXT]): FOUND is true when it is there. An
# alternative is one or several names of Debian packages, apart by spaces, with ">=VERSION" where an older one does not do.
function(disparityd_need what found)
  cmake_parse_arguments(N "" "FOR;HINT" "PACKAGES" ${ARGN})
  if(NOT N_FOR)
    set(N_FOR build)
  endif()
  if(found)
    set(state found)
  else()
    set(state missing)
    list(GET N_PACKAGES 0 packages)
    string(REGEX REPLACE ">=[^ ]*" "" packages "${packages}")
    set_property(GLOBAL APPEND PROPERTY disparityd_missing "${what} (apt-get install ${packages})")
  endif()
  string(REPLACE ";" "|" alternatives "${N_PACKAGES}")
  set_property(GLOBAL APPEND_STRING PROPERTY disparityd_needs
    "${state}\t${N_FOR}\t${what}\t${alternatives}\t${N_HINT}\n")
endfunction()

# After the last need: writes the list, or refuses to go on.
function(disparityd_end_of_needs)
  if(DISPARITYD_REPORT_NEEDS)
    get_property(needs GLOBAL PROPERTY disparityd_needs)
    file(WRITE "${DISPARITYD_REPORT_NEEDS}" "${needs}")
    return()
  endif()
  get_property(missing GLOBAL PROPERTY disparityd_missing)
  if(missing)
    list(JOIN missing "\n  " lines)
    message(FATAL_ERROR "What is needed and was not found here, or is too old:\n  ${lines}\n"
      "tools/demo installs what it needs, tools/test what the tests need; docs/install.md says what else can be done.")
  endif()
endfunction()

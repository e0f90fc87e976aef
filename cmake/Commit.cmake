# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_COMMIT: the commit that --version tells; git is asked where it is not given. Sources that are no checkout of their
# own have none. A new commit configures again; what is then compiled again is base/version.cpp alone.
set(DISPARITYD_COMMIT "" CACHE STRING "Commit that --version tells; empty: git's, if the sources are a checkout")
find_package(Git QUIET)
if(DISPARITYD_COMMIT OR NOT GIT_FOUND OR NOT EXISTS ${PROJECT_SOURCE_DIR}/.git)
  return()
endif()

# disparityd_git(RESULT ARGUMENTS...): what git says of the sources in one line; empty when it refuses.
function(disparityd_git result)
  execute_process(COMMAND ${GIT_EXECUTABLE} ${ARGN} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(said "")
  endif()
  set(${result} "${said}" PARENT_SCOPE)
endfunction()

disparityd_git(DISPARITYD_COMMIT rev-parse --short=12 HEAD)
disparityd_git(log_of_head rev-parse --git-path logs/HEAD)
get_filename_component(log_of_head "${log_of_head}" ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
if(DISPARITYD_COMMIT AND EXISTS ${log_of_head})
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${log_of_head})
endif()

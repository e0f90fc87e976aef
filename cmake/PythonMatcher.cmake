# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_PYTHON_MATCHER: AUTO builds the Python matcher where pybind11 and Python's headers are found, ON demands them, OFF
# does not look. Sets DISPARITYD_WITH_PYTHON_MATCHER, DISPARITYD_PYTHON_SUFFIX and the target pybind11_headers.
set(DISPARITYD_PYTHON_MATCHER AUTO CACHE STRING "Matcher for Python: AUTO (where pybind11 is found), ON or OFF")
set_property(CACHE DISPARITYD_PYTHON_MATCHER PROPERTY STRINGS AUTO ON OFF)
set(DISPARITYD_WITH_PYTHON_MATCHER FALSE)

# The distribution's Python before any other: numpy, Protobuf and pybind11 come from its packages; another one by -DDISPARITYD_PYTHON=PATH.
find_program(DISPARITYD_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
find_program(DISPARITYD_PYTHON python3)
mark_as_advanced(DISPARITYD_PYTHON)

# disparityd_find_python_matcher(): sets what is above where all is here.
function(disparityd_find_python_matcher)
  find_path(PYBIND11_HEADERS pybind11/pybind11.h)
  mark_as_advanced(PYBIND11_HEADERS)
  set(suffix .so)  # of a cross build: Python takes it without its own version, too
  set(folder "")
  if(CMAKE_CROSSCOMPILING)
    find_path(PYTHON_HEADERS Python.h PATH_SUFFIXES python3.13 python3.12 python3.11 python3.10 python3.9)
    set(folder "${PYTHON_HEADERS}")
  elseif(DISPARITYD_PYTHON)
    execute_process(
      COMMAND ${DISPARITYD_PYTHON} -c "import sysconfig; print(sysconfig.get_path('include'), sysconfig.get_config_var('EXT_SUFFIX'), sep=';')"
      OUTPUT_VARIABLE said OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    list(LENGTH said words)
    if(words EQUAL 2)
      list(GET said 0 folder)
      list(GET said 1 suffix)
    endif()
  endif()
  if(NOT PYBIND11_HEADERS OR NOT folder OR NOT EXISTS "${folder}/Python.h")
    return()
  endif()
  add_library(pybind11_headers INTERFACE)
  target_include_directories(pybind11_headers SYSTEM INTERFACE ${PYBIND11_HEADERS} ${folder})
  set(DISPARITYD_PYTHON_SUFFIX ${suffix} PARENT_SCOPE)
  set(DISPARITYD_WITH_PYTHON_MATCHER TRUE PARENT_SCOPE)
endfunction()

if(NOT DISPARITYD_PYTHON_MATCHER)
  return()
endif()
if(DISPARITYD_SANITIZE)
  if(NOT DISPARITYD_PYTHON_MATCHER STREQUAL AUTO)
    message(FATAL_ERROR "DISPARITYD_PYTHON_MATCHER=${DISPARITYD_PYTHON_MATCHER} and DISPARITYD_SANITIZE: an instrumented library "
      "cannot be loaded into a Python that is not; leave one of them out")
  endif()
  return()
endif()
disparityd_find_python_matcher()
if(NOT DISPARITYD_PYTHON_MATCHER STREQUAL AUTO OR DISPARITYD_REPORT_NEEDS)
  disparityd_need("pybind11 and Python's headers" ${DISPARITYD_WITH_PYTHON_MATCHER} FOR python
    PACKAGES "pybind11-dev libpython3-dev")
elseif(NOT DISPARITYD_WITH_PYTHON_MATCHER)
  message(STATUS "The Python matcher is not built: found no pybind11 or no headers of Python (apt-get install pybind11-dev libpython3-dev)")
endif()

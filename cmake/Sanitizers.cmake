# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_SANITIZE=address,undefined or thread: everything built after this point is instrumented, tests included.
# A report ends the program with an error, so that ctest sees it.
set(DISPARITYD_SANITIZE "" CACHE STRING "Sanitizers to build with, comma separated: address,undefined or thread")
set(called_checks)
if(DISPARITYD_SANITIZE)
  add_compile_options(-fsanitize=${DISPARITYD_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${DISPARITYD_SANITIZE})
  if(DISPARITYD_SANITIZE MATCHES "address" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # A fifth of the time to compile: null pointers end in the address sanitizer anyway, and clang's build of tests/fuzz
    # checks dynamic types.
    add_compile_options(-fno-sanitize=null,vptr)
    # For code of many loads and stores in few loops: half the time to compile, and slower to run.
    set(called_checks --param=asan-instrumentation-with-call-threshold=0)
  endif()
endif()

# For folders whose code waits more than it computes: under GCC's sanitizers it is built in half the time.
macro(disparityd_waits_more_than_it_computes)
  if(DISPARITYD_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-O0 ${called_checks})
  endif()
endmacro()

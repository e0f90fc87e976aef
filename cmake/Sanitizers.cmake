# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_SANITIZE=address,undefined or thread: everything built after this point is instrumented, tests included.
# A report ends the program with an error, so that ctest sees it. With clang, which compiles instrumented code in half of GCC's
# time. fuzzer-no-link in the list: the fuzzers of tests/fuzz are built from the same libraries as the tests.
set(DISPARITYD_SANITIZE "" CACHE STRING "Sanitizers to build with, comma separated: address,undefined or thread")
# For code of many loads and stores in few loops.
set(kernel_checks)
# For the few other files whose loops over pixels are most of what tests compute.
set(pixel_loop_checks)
if(DISPARITYD_SANITIZE)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "DISPARITYD_SANITIZE needs clang, found ${CMAKE_CXX_COMPILER_ID}: apt-get install clang libclang-rt-dev; "
      "then cmake --preset asan-ubsan or tsan, in a build folder that no other compiler has configured")
  endif()
  add_compile_options(-fsanitize=${DISPARITYD_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${DISPARITYD_SANITIZE})
  # In a quarter of the time.
  find_program(DISPARITYD_LLD ld.lld)
  if(DISPARITYD_LLD)
    add_link_options(-fuse-ld=lld)
  endif()
  add_compile_definitions(DISPARITYD_SANITIZED)
  set(pixel_loop_checks -O2)
  if(DISPARITYD_SANITIZE MATCHES "undefined")
    # Programs in C use libraries in C++.
    add_link_options("$<$<LINK_LANGUAGE:C>:-fsanitize-link-c++-runtime;-lstdc++>")
  endif()
  if(DISPARITYD_SANITIZE MATCHES "address")
    # The address sanitizer ends on null pointers, too.
    add_compile_options(-fno-sanitize=null)
    # Calls instead of code in place, no counters for fuzzers, and of undefined behaviour what their indices could do: half the
    # time to compile.
    set(kernel_checks -mllvm -asan-instrumentation-with-call-threshold=0 -fno-sanitize-coverage=edge,trace-cmp
      -fno-sanitize=alignment,object-size,pointer-overflow,vptr)
    list(APPEND pixel_loop_checks -fno-sanitize-coverage=edge,trace-cmp)
  endif()
endif()

# For folders whose code waits more than it computes: not optimised under sanitizers, it is built in two thirds of the time, and
# without -O3, which no loop there needs, in five sixths.
macro(disparityd_waits_more_than_it_computes)
  if(DISPARITYD_SANITIZE)
    add_compile_options(-O0)
  elseif(CMAKE_CXX_FLAGS_RELEASE MATCHES "-O3")  # whoever asks for less gets it
    add_compile_options($<$<CONFIG:Release>:-O2>)
  endif()
endmacro()

# For folders that no fuzzer of tests/fuzz reaches: without what guides one they are built in four fifths of the time.
macro(disparityd_is_not_fuzzed)
  if(DISPARITYD_SANITIZE MATCHES "fuzzer")
    add_compile_options(-fno-sanitize-coverage=edge,trace-cmp,indirect-calls,inline-8bit-counters,pc-table,stack-depth)
  endif()
endmacro()

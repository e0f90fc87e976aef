# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_SANITIZE=address,undefined or thread: everything built after this point is instrumented, tests included.
# A report ends the program with an error, so that ctest sees it.
set(DISPARITYD_SANITIZE "" CACHE STRING "Sanitizers to build with, comma separated: address,undefined or thread")
if(DISPARITYD_SANITIZE)
  add_compile_options(-fsanitize=${DISPARITYD_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=${DISPARITYD_SANITIZE})
endif()

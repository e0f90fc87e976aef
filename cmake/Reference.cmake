# SPDX-License-Identifier: Apache-2.0
# Target `reference` and the test of it: the reference of the public headers in HTML. Without Doxygen there is neither.
find_program(DOXYGEN_PROGRAM doxygen)
mark_as_advanced(DOXYGEN_PROGRAM)
if(NOT DOXYGEN_PROGRAM OR CMAKE_CROSSCOMPILING)
  return()
endif()

set(DISPARITYD_REFERENCE ${PROJECT_BINARY_DIR}/reference)
set(public_headers
  ${PROJECT_SOURCE_DIR}/clients/cpp/disparity_client.h
  ${PROJECT_SOURCE_DIR}/clients/cpp/disparity_client.hpp
  ${PROJECT_SOURCE_DIR}/clients/cpp/disparity_inertial.hpp
  ${PROJECT_BINARY_DIR}/clients/cpp/disparity_products.h
  ${PROJECT_BINARY_DIR}/clients/cpp/disparity_products.hpp
  ${PROJECT_SOURCE_DIR}/kernels/pair_matcher.h)
list(JOIN public_headers "\" \"" DISPARITYD_REFERENCE_INPUT)
set(DISPARITYD_REFERENCE_INPUT "\"${PROJECT_SOURCE_DIR}/docs/reference.md\" \"${DISPARITYD_REFERENCE_INPUT}\"")
configure_file(${CMAKE_CURRENT_LIST_DIR}/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)

add_custom_target(reference
  COMMAND ${DOXYGEN_PROGRAM} ${PROJECT_BINARY_DIR}/Doxyfile
  COMMENT "Reference: ${DISPARITYD_REFERENCE}/html/index.html"
  VERBATIM)

# Once is enough: sanitizers see nothing in it.
if(DISPARITYD_TESTS AND NOT DISPARITYD_SANITIZE)
  add_test(NAME docs.reference COMMAND ${DOXYGEN_PROGRAM} ${PROJECT_BINARY_DIR}/Doxyfile)
endif()

# SPDX-License-Identifier: Apache-2.0
# Installs the kernels alone, builds the example against what was installed, and lets it find a known shift.
# cmake -DBUILD=build folder -DWORK=scratch folder -DEXAMPLE=folder -DGENERATOR=... -DCOMPILER=c++ -P installed_library.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}exit status ${status}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --component kernels --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${EXAMPLE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER}
  -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build)
foreach(shift 0 9 37)
  run(${WORK}/build/match_pair ${shift})
  if(NOT output STREQUAL "${shift}.00 px\n")
    message(FATAL_ERROR "match_pair ${shift} printed: ${output}")
  endif()
endforeach()

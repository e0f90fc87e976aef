# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_CUDA: AUTO builds the back end cuda where a CUDA compiler is found, ON demands one, OFF does not look. LOCAL is AUTO
# for the GPU of this machine alone, and OFF where it has none. Sets DISPARITYD_WITH_CUDA. The program starts on machines without
# a driver: the runtime is linked statically and looks for it.
set(DISPARITYD_CUDA AUTO CACHE STRING "Back end for NVIDIA GPUs: AUTO (where nvcc is found), LOCAL (for this machine), ON or OFF")
set_property(CACHE DISPARITYD_CUDA PROPERTY STRINGS AUTO LOCAL ON OFF)

# The sources of kernels/cuda: what the CUDA compiler builds (and, for the tests, the C++ compiler), and what it does not.
set(DISPARITYD_CUDA_STEPS
  block_winners.cu
  census.cu
  guided_median.cu
  interpolate_depth.cu
  left_right_median.cu
  paths.cu
  rectify.cu
  sgm_winners.cu
  speckle.cu
  sweep.cu)
set(DISPARITYD_CUDA_HOST
  backend.cpp
  device.cpp
  graph.cpp
  match_stage.cpp
  memory.cpp
  rectify_stage.cpp
  stream.cpp
  stream_clock.cpp)

# Of the machines that are looked after those that this toolkit builds for: Ampere (80, which 86 and Ada's 89 run too), Jetson
# Orin, Hopper, Blackwell (100, 120), Jetson Thor (101 before CUDA 13, then 110). The last one's intermediate code makes newer
# devices start slowly once, and then run.
function(disparityd_cuda_architectures result)
  execute_process(COMMAND ${CMAKE_CUDA_COMPILER} --list-gpu-code OUTPUT_VARIABLE known ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(known "sm_80 sm_87")
  endif()
  string(REGEX MATCHALL "sm_[0-9]+" known "${known}")
  set(architectures "")
  foreach(architecture 80 87 90 100 101 110 120)
    if("sm_${architecture}" IN_LIST known)
      list(APPEND architectures ${architecture})
    endif()
  endforeach()
  list(POP_BACK architectures newest)
  list(TRANSFORM architectures APPEND "-real")
  list(APPEND architectures ${newest})
  set(${result} "${architectures}" PARENT_SCOPE)
endfunction()

# The compute capability of this machine's first GPU, such as 87; "some" where nothing says which it has, "" without a GPU.
function(disparityd_local_gpu result)
  execute_process(COMMAND nvidia-smi --query-gpu=compute_cap --format=csv,noheader OUTPUT_VARIABLE told ERROR_QUIET
    RESULT_VARIABLE failed)
  set(found "")
  if(NOT failed AND told MATCHES "^([0-9]+)[.]([0-9])")
    set(found "${CMAKE_MATCH_1}${CMAKE_MATCH_2}")
  else()
    # A desktop's driver, and those of Jetsons before and from JetPack 6 on.
    foreach(device nvidiactl nvhost-gpu nvhost-ctrl-gpu nvgpu)
      if(EXISTS /dev/${device})
        set(found some)
      endif()
    endforeach()
    # nvidia-smi does not tell it on Jetsons; the board does: Orin.
    if(found AND EXISTS /proc/device-tree/compatible)
      file(STRINGS /proc/device-tree/compatible board)
      if(board MATCHES "tegra234")
        set(found 87)
      endif()
    endif()
  endif()
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

set(DISPARITYD_WITH_CUDA OFF)
if(NOT DISPARITYD_CUDA)
  return()
endif()
set(local_gpu some)
if(DISPARITYD_CUDA STREQUAL LOCAL)
  disparityd_local_gpu(local_gpu)
  if(local_gpu STREQUAL "")
    message(STATUS "Back end cuda: this machine has no NVIDIA GPU, built without")
    return()
  endif()
endif()

# Unlike enable_language(CUDA), this also looks where the toolkit installs itself.
find_package(CUDAToolkit 11.4 QUIET)
if(CUDAToolkit_FOUND AND NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
  set(CMAKE_CUDA_COMPILER ${CUDAToolkit_NVCC_EXECUTABLE})
endif()
include(CheckLanguage)
check_language(CUDA)
if(CMAKE_CUDA_COMPILER AND CUDAToolkit_FOUND)
  # Not kept in the cache: another value of DISPARITYD_CUDA asks for others.
  if(NOT CMAKE_CUDA_ARCHITECTURES)
    if(local_gpu STREQUAL some)
      disparityd_cuda_architectures(CMAKE_CUDA_ARCHITECTURES)
    else()
      set(CMAKE_CUDA_ARCHITECTURES ${local_gpu}-real)
    endif()
  endif()
  enable_language(CUDA)
  set(DISPARITYD_WITH_CUDA ON)
  message(STATUS "Back end cuda: ${CMAKE_CUDA_COMPILER} ${CMAKE_CUDA_COMPILER_VERSION} for ${CMAKE_CUDA_ARCHITECTURES}")
elseif(DISPARITYD_CUDA MATCHES "AUTO|LOCAL")
  message(STATUS "Back end cuda: no CUDA compiler found, built without")
else()
  message(FATAL_ERROR "DISPARITYD_CUDA=ON, but no CUDA toolkit from 11.4 on was found: install one and put nvcc into PATH or "
    "name it with -DCMAKE_CUDA_COMPILER=FILE; DISPARITYD_CUDA=AUTO builds without where there is none")
endif()

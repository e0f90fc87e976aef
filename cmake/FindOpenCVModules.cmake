# SPDX-License-Identifier: Apache-2.0
# OpenCV by module, so that only libopencv-{core,imgproc,calib3d}-dev are needed: OpenCVConfig.cmake comes
# with libopencv-dev alone, which pulls in a graphics stack. Gives the targets opencv::<module>.

find_path(OPENCV_INCLUDE_DIR opencv2/core/version.hpp PATH_SUFFIXES opencv4)
if(OPENCV_INCLUDE_DIR)
  file(STRINGS ${OPENCV_INCLUDE_DIR}/opencv2/core/version.hpp lines REGEX "#define CV_VERSION_(MAJOR|MINOR|REVISION)")
  string(REGEX REPLACE ".*MAJOR +([0-9]+).*MINOR +([0-9]+).*REVISION +([0-9]+).*" "\\1.\\2.\\3"
    OpenCVModules_VERSION "${lines}")
endif()

set(required OPENCV_INCLUDE_DIR)
foreach(module ${OpenCVModules_FIND_COMPONENTS})
  find_library(OPENCV_${module}_LIBRARY opencv_${module})
  list(APPEND required OPENCV_${module}_LIBRARY)
  if(OPENCV_${module}_LIBRARY AND NOT TARGET opencv::${module})
    add_library(opencv::${module} UNKNOWN IMPORTED)
    set_target_properties(opencv::${module} PROPERTIES
      IMPORTED_LOCATION ${OPENCV_${module}_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${OPENCV_INCLUDE_DIR})
    if(NOT module STREQUAL core)
      target_link_libraries(opencv::${module} INTERFACE opencv::core)
    endif()
  endif()
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVModules REQUIRED_VARS ${required} VERSION_VAR OpenCVModules_VERSION)

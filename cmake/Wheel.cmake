# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_WHEEL=ON: nothing but the Python module of tools/wheel (target disparity_matcher), in the root of tools/setup/wheel-root:
# an old C library, headers of OpenCV and pybind11, the source of yaml-cpp and Highway. What libraries it has are inside.
set(DISPARITYD_WHEEL_PYTHON 3.11 CACHE STRING "The CPython that the module is for: one whose headers the root has")
find_package(Threads REQUIRED)
set(headers ${CMAKE_SYSROOT}/usr/include)
set(source ${CMAKE_SYSROOT}/source)
if(NOT EXISTS ${headers}/python${DISPARITYD_WHEEL_PYTHON}/Python.h)
  message(FATAL_ERROR "DISPARITYD_WHEEL_PYTHON=${DISPARITYD_WHEEL_PYTHON}: ${headers} has no headers of it; tools/wheel --help says which there are")
endif()

# Of Highway: which instruction sets the processor has. The rest is headers.
add_library(highway STATIC ${source}/highway/hwy/targets.cc ${source}/highway/hwy/per_target.cc)
target_include_directories(highway SYSTEM PUBLIC ${source}/highway)
file(GLOB yaml_cpp_sources ${source}/yaml-cpp/src/*.cpp)
add_library(yaml_cpp STATIC ${yaml_cpp_sources})
target_include_directories(yaml_cpp SYSTEM PUBLIC ${source}/yaml-cpp/include)
foreach(name PkgConfig::HIGHWAY PkgConfig::YAMLCPP opencv::core CLI11::CLI11 nlohmann_json::nlohmann_json OpenSSL::Crypto fmt::fmt opencv::imgproc
    opencv::calib3d)
  add_library(${name} INTERFACE IMPORTED)  # some are only named, by targets that are not built here
endforeach()
target_link_libraries(PkgConfig::HIGHWAY INTERFACE highway)
target_link_libraries(PkgConfig::YAMLCPP INTERFACE yaml_cpp)
target_include_directories(opencv::core SYSTEM INTERFACE ${headers}/opencv4)

add_library(pybind11_headers INTERFACE)
target_include_directories(pybind11_headers SYSTEM INTERFACE ${headers}/python${DISPARITYD_WHEEL_PYTHON})
# -B: a native compiler would link the C library of the machine it runs on. -pthread: a library of its own before glibc 2.34.
target_link_options(pybind11_headers INTERFACE -static-libstdc++ -s -pthread -B${CMAKE_SYSROOT}/usr/lib/${CMAKE_SYSTEM_PROCESSOR}-linux-gnu)
string(REPLACE . "" version ${DISPARITYD_WHEEL_PYTHON})
set(DISPARITYD_PYTHON_SUFFIX .cpython-${version}-${CMAKE_SYSTEM_PROCESSOR}-linux-gnu.so)
set(DISPARITYD_WITH_PYTHON_MATCHER TRUE)

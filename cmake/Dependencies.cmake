# SPDX-License-Identifier: Apache-2.0
# Third-party libraries, all from distribution packages (tools/packages lists them). The oldest versions are those of
# Ubuntu 22.04 where it has them; an older one is refused here, not by a compiler error.

find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)

find_package(OpenCVModules 4.5 REQUIRED COMPONENTS core imgproc calib3d imgcodecs)
find_package(Boost 1.74 REQUIRED)
find_package(Protobuf 3.12 REQUIRED)

pkg_check_modules(FFMPEG REQUIRED IMPORTED_TARGET libavformat>=58.76 libavcodec>=58.134 libavutil>=56.70 libswscale>=5.9)
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd>=249)
pkg_check_modules(LIBUSB REQUIRED IMPORTED_TARGET libusb-1.0>=1.0.25)
# Older ones take as much stack as a file is deep.
pkg_check_modules(YAMLCPP REQUIRED IMPORTED_TARGET yaml-cpp>=0.7)
pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET libzstd>=1.4)

find_package(fmt 8 REQUIRED)
find_package(spdlog 1.9 REQUIRED)
find_package(CLI11 2.1 REQUIRED)
find_package(nlohmann_json 3.10 REQUIRED)

find_path(CONCURRENTQUEUE_INCLUDE_DIR concurrentqueue/blockingconcurrentqueue.h REQUIRED)
add_library(concurrentqueue INTERFACE)
target_include_directories(concurrentqueue SYSTEM INTERFACE ${CONCURRENTQUEUE_INCLUDE_DIR})

find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
add_library(tomlplusplus INTERFACE)
target_include_directories(tomlplusplus SYSTEM INTERFACE ${TOMLPLUSPLUS_INCLUDE_DIR})

# Vector code for several instruction sets; 1.0.3 is Debian 12's. Ubuntu 22.04 has 0.16, without the operations used here.
# The package of the installed library (disparityd-config.cmake) asks for the same.
set(HIGHWAY_REQUIREMENT "libhwy>=1.0.3")
pkg_check_modules(HIGHWAY IMPORTED_TARGET ${HIGHWAY_REQUIREMENT})
if(NOT HIGHWAY_FOUND)
  message(FATAL_ERROR "Highway (libhwy) 1.0.3 or newer is needed and was not found. Debian 12 has it as libhwy-dev; "
    "Ubuntu 22.04 has 0.16: build a newer one from source and name it in PKG_CONFIG_PATH.")
endif()

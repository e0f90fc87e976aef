# SPDX-License-Identifier: Apache-2.0
# Third-party libraries, all from distribution packages. The oldest versions are those of Ubuntu 22.04 where it has them; an
# older one is refused here, not by a compiler error. What is there in any form is taken: a vendor's package, /usr/local.
include(Needs)

set(compiler_fits TRUE)
if((CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 11) OR
   (CMAKE_CXX_COMPILER_ID STREQUAL Clang AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 14))
  set(compiler_fits FALSE)
endif()
disparityd_need("g++ 11 or clang 14 or newer; found ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}" ${compiler_fits}
  PACKAGES "g++-11" "g++-12" "g++-13" HINT "then set CXX to it and CC to its gcc")

find_package(Threads REQUIRED)
find_package(PkgConfig QUIET)
disparityd_need("pkg-config" "${PKG_CONFIG_FOUND}" PACKAGES "pkg-config" "pkgconf")

# pkg_module(PREFIX MODULE>=VERSION...): as pkg_check_modules, quietly, and nothing is found without pkg-config.
macro(pkg_module prefix)
  if(PKG_CONFIG_FOUND)
    pkg_check_modules(${prefix} QUIET IMPORTED_TARGET ${ARGN})
  endif()
endmacro()

find_package(OpenCVModules 4.5 QUIET COMPONENTS core imgproc calib3d)
# NVIDIA's Jetsons have all of OpenCV in one package.
disparityd_need("OpenCV 4.5 (core, imgproc, calib3d)" "${OpenCVModules_FOUND}"
  PACKAGES "libopencv-core-dev libopencv-imgproc-dev libopencv-calib3d-dev" "libopencv-dev")
# CMake's own search, from 3.30 on only when asked for: it also takes an unpacked release, which has no package of CMake's.
if(POLICY CMP0167)
  cmake_policy(SET CMP0167 OLD)
endif()
find_package(Boost 1.74 QUIET)
disparityd_need("Boost 1.74 (headers)" "${Boost_FOUND}" PACKAGES "libboost-dev")
find_package(Protobuf 3.12 QUIET)
set(protobuf_and_protoc FALSE)
if(Protobuf_FOUND AND Protobuf_PROTOC_EXECUTABLE)
  set(protobuf_and_protoc TRUE)
endif()
disparityd_need("Protobuf 3.12 and protoc" ${protobuf_and_protoc} PACKAGES "libprotobuf-dev protobuf-compiler")

pkg_module(FFMPEG libavformat>=58.76 libavcodec>=58.134 libavutil>=56.70 libswscale>=5.9)
disparityd_need("FFmpeg 4.4 (libavformat, libavcodec, libavutil, libswscale)" "${FFMPEG_FOUND}"
  PACKAGES "libavformat-dev libavcodec-dev libavutil-dev libswscale-dev")
pkg_module(SYSTEMD libsystemd>=249)
disparityd_need("libsystemd 249" "${SYSTEMD_FOUND}" PACKAGES "libsystemd-dev")
pkg_module(LIBUSB libusb-1.0>=1.0.25)
disparityd_need("libusb 1.0.25" "${LIBUSB_FOUND}" PACKAGES "libusb-1.0-0-dev")
# Older ones take as much stack as a file is deep.
pkg_module(YAMLCPP yaml-cpp>=0.7)
disparityd_need("yaml-cpp 0.7" "${YAMLCPP_FOUND}" PACKAGES "libyaml-cpp-dev")
pkg_module(ZSTD libzstd>=1.4)
disparityd_need("zstd 1.4" "${ZSTD_FOUND}" PACKAGES "libzstd-dev")
pkg_module(LZ4 liblz4>=1.9)
disparityd_need("lz4 1.9" "${LZ4_FOUND}" PACKAGES "liblz4-dev")
pkg_module(SQLITE sqlite3>=3.37)
disparityd_need("SQLite 3.37" "${SQLITE_FOUND}" PACKAGES "libsqlite3-dev")
find_package(BZip2 QUIET)
disparityd_need("bzip2" "${BZIP2_FOUND}" PACKAGES "libbz2-dev")

pkg_module(TURBOJPEG libturbojpeg>=2.0)
disparityd_need("libjpeg-turbo 2.0 (turbojpeg)" "${TURBOJPEG_FOUND}" PACKAGES "libturbojpeg0-dev")
# Its other interface: only that says what it warns of.
pkg_module(LIBJPEG libjpeg>=2.0)
disparityd_need("libjpeg-turbo 2.0 (libjpeg)" "${LIBJPEG_FOUND}" PACKAGES "libjpeg-dev")
pkg_module(LIBPNG libpng>=1.6)
disparityd_need("libpng 1.6" "${LIBPNG_FOUND}" PACKAGES "libpng-dev")
pkg_module(LIBTIFF libtiff-4>=4.3)
disparityd_need("libtiff 4.3" "${LIBTIFF_FOUND}" PACKAGES "libtiff-dev")
pkg_module(WEBP libwebp>=1.2)
disparityd_need("libwebp 1.2" "${WEBP_FOUND}" PACKAGES "libwebp-dev")
find_package(ZLIB QUIET)
disparityd_need("zlib" "${ZLIB_FOUND}" PACKAGES "zlib1g-dev")
find_package(OpenSSL 3.0 QUIET)
disparityd_need("OpenSSL 3.0" "${OPENSSL_FOUND}" PACKAGES "libssl-dev")

find_package(fmt 8 QUIET)
disparityd_need("fmt 8" "${fmt_FOUND}" PACKAGES "libfmt-dev")
if(fmt_FOUND)  # spdlog's package ends the configuration where it does not find it
  find_package(spdlog 1.9 QUIET)
endif()
disparityd_need("spdlog 1.9" "${spdlog_FOUND}" PACKAGES "libspdlog-dev")
find_package(CLI11 2.1 QUIET)
disparityd_need("CLI11 2.1" "${CLI11_FOUND}" PACKAGES "libcli11-dev")
find_package(nlohmann_json 3.10 QUIET)
disparityd_need("nlohmann-json 3.10" "${nlohmann_json_FOUND}" PACKAGES "nlohmann-json3-dev")

# Where the headers lie depends on the release: since 1.0.4 in a folder of their own.
find_path(CONCURRENTQUEUE_HEADERS blockingconcurrentqueue.h
  PATH_SUFFIXES concurrentqueue/moodycamel concurrentqueue)
disparityd_need("concurrentqueue 1.0.3" "${CONCURRENTQUEUE_HEADERS}" PACKAGES "libconcurrentqueue-dev")
add_library(concurrentqueue INTERFACE)
target_include_directories(concurrentqueue SYSTEM INTERFACE ${CONCURRENTQUEUE_HEADERS})

# The header beside toml.hpp tells toml11 from other libraries: the first is that of 4, the second that of 3.
find_path(TOML11_HEADERS NAMES toml11/parser.hpp toml/combinator.hpp)
disparityd_need("toml11 3.7" "${TOML11_HEADERS}" PACKAGES "libtoml11-dev")
add_library(toml11 INTERFACE)
target_include_directories(toml11 SYSTEM INTERFACE ${TOML11_HEADERS})

# Vector code for several instruction sets; 1.0.3 is Debian 12's. Ubuntu 22.04 has 0.16, without the operations used here:
# tools/setup/highway builds a newer one into the build folder. The package of the installed library
# (disparityd-config.cmake) asks for the same.
set(HIGHWAY_REQUIREMENT "libhwy>=1.0.3")
set(own_highway ${PROJECT_SOURCE_DIR}/build/deps/lib/pkgconfig)
if(NOT CMAKE_CROSSCOMPILING AND EXISTS ${own_highway}/libhwy.pc)
  set(ENV{PKG_CONFIG_PATH} "${own_highway}:$ENV{PKG_CONFIG_PATH}")
endif()
pkg_module(HIGHWAY ${HIGHWAY_REQUIREMENT})
disparityd_need("Highway (libhwy) 1.0.3" "${HIGHWAY_FOUND}" PACKAGES "libhwy-dev>=1.0.3"
  HINT "tools/setup/highway builds one")

if(DISPARITYD_TESTS)
  find_package(GTest 1.11 QUIET)
  disparityd_need("GoogleTest 1.11" "${GTest_FOUND}" FOR test PACKAGES "libgtest-dev libgmock-dev")
  find_package(OpenCVModules 4.5 QUIET COMPONENTS core features2d imgcodecs)
  # The independent matcher of the self-calibration's tests, and independent readers and writers of images.
  disparityd_need("OpenCV 4.5 (features2d, imgcodecs)" "${OpenCVModules_FOUND}" FOR test
    PACKAGES "libopencv-features2d-dev libopencv-imgcodecs-dev" "libopencv-dev")
  find_package(Boost 1.74 QUIET COMPONENTS context)
  disparityd_need("Boost 1.74 (context)" "${Boost_FOUND}" FOR test PACKAGES "libboost-context-dev")
endif()

include(PythonMatcher)
include(Gstreamer)
include(CycloneDds)

disparityd_end_of_needs()

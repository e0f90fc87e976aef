# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_ROS2: AUTO builds disparity-ros2 where Cyclone DDS is found, ON demands it, OFF does not look. Sets
# DISPARITYD_WITH_ROS2. 0.10 is Debian 12's and Ubuntu 24.04's; the interface for types of one's own is another one before.
set(DISPARITYD_ROS2 AUTO CACHE STRING "disparity-ros2, the bridge to ROS 2: AUTO (where Cyclone DDS is found), ON or OFF")
set_property(CACHE DISPARITYD_ROS2 PROPERTY STRINGS AUTO ON OFF)

set(DISPARITYD_WITH_ROS2 OFF)
if(NOT DISPARITYD_ROS2)
  return()
endif()
pkg_module(CYCLONEDDS CycloneDDS>=0.10)
if(CYCLONEDDS_FOUND)
  set(DISPARITYD_WITH_ROS2 ON)
endif()
if(NOT DISPARITYD_ROS2 STREQUAL AUTO OR DISPARITYD_REPORT_NEEDS)
  disparityd_need("Cyclone DDS 0.10" ${DISPARITYD_WITH_ROS2} FOR ros2 PACKAGES "cyclonedds-dev>=0.10")
elseif(NOT DISPARITYD_WITH_ROS2)
  message(STATUS "disparity-ros2 is not built: found no Cyclone DDS 0.10 (apt-get install cyclonedds-dev)")
endif()

# Another DDS, to test against: what nodes of ROS 2 use by default.
set(DISPARITYD_WITH_FAST_DDS OFF)
if(DISPARITYD_TESTS AND DISPARITYD_WITH_ROS2)
  find_package(fastrtps 2.5 QUIET)
  set(DISPARITYD_WITH_FAST_DDS ${fastrtps_FOUND})
  if(NOT fastrtps_FOUND)
    message(STATUS "disparity-ros2 is not tested against another DDS: found no Fast DDS 2.5 (apt-get install libfastrtps-dev)")
  endif()
endif()

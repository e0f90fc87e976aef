# SPDX-License-Identifier: Apache-2.0
# DISPARITYD_GSTREAMER: AUTO builds the source gst: where GStreamer is found, ON demands it, OFF does not look. Sets
# DISPARITYD_WITH_GSTREAMER. 1.20 is Ubuntu 22.04's.
set(DISPARITYD_GSTREAMER AUTO CACHE STRING "Source gst: of GStreamer pipelines: AUTO (where it is found), ON or OFF")
set_property(CACHE DISPARITYD_GSTREAMER PROPERTY STRINGS AUTO ON OFF)

set(DISPARITYD_WITH_GSTREAMER OFF)
if(NOT DISPARITYD_GSTREAMER)
  return()
endif()
pkg_module(GSTREAMER gstreamer-app-1.0>=1.20 gstreamer-video-1.0>=1.20)
if(GSTREAMER_FOUND)
  set(DISPARITYD_WITH_GSTREAMER ON)
endif()
if(NOT DISPARITYD_GSTREAMER STREQUAL AUTO OR DISPARITYD_REPORT_NEEDS)
  disparityd_need("GStreamer 1.20 (core, app, video)" ${DISPARITYD_WITH_GSTREAMER} FOR gstreamer
    PACKAGES "libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev")
elseif(NOT DISPARITYD_WITH_GSTREAMER)
  message(STATUS "The source gst: is not built: found no GStreamer 1.20 (apt-get install libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev)")
endif()

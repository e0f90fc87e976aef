// SPDX-License-Identifier: Apache-2.0
//
// What a build without GStreamer has instead of gst_source.cpp.
#include <stdexcept>

#include "capture/gstreamer/gst_source.h"

namespace disparityd::capture {

std::unique_ptr<FrameSource> open_gst(const SourceOptions&) {
    throw std::invalid_argument(
        "source gst: this disparityd was built without GStreamer; install libgstreamer1.0-dev and "
        "libgstreamer-plugins-base1.0-dev and build it again with -DDISPARITYD_GSTREAMER=ON");
}

}  // namespace disparityd::capture

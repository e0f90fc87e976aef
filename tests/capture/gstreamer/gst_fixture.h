// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <gst/gst.h>

#include "capture/frame_source.h"
#include "tests/capture/images/image_fixture.h"
#include "tests/capture/played_source.h"

namespace disparityd::capture::test {

inline constexpr int width = 64;  ///< of an eye, px
inline constexpr int height = 48;

inline SourceOptions options_of(const std::string& pipeline) {
    SourceOptions options;
    options.uri = "gst:" + pipeline;
    options.pace = Pace::fastest;
    return options;
}

/// Whether the plugin of an element is installed.
inline bool has_element(const char* name) {
    gst_init(nullptr, nullptr);
    GstElementFactory* const factory = gst_element_factory_find(name);
    if (factory != nullptr) {
        gst_object_unref(factory);
    }
    return factory != nullptr;
}

/// A test source of both eyes, with these properties, at this rate.
inline std::string test_source(const std::string& properties, const std::string& rate, int frame_width = 2 * width) {
    return "videotestsrc " + properties + " ! video/x-raw,format=GRAY8,width=" + std::to_string(frame_width) +
           ",height=" + std::to_string(height) + ",framerate=" + rate + "/1 ";
}

}  // namespace disparityd::capture::test

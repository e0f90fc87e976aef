// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_uri.h"

#include <cmath>
#include <stdexcept>

#include "capture/source_uri.h"

namespace disparityd::capture {

bool is_gst(const std::string& uri) {
    return uri.starts_with("gst:") || uri.starts_with("gst?");
}

GstUri parse_gst_uri(const std::string& uri) {
    constexpr double most_ms = 1000;
    GstUri gst;
    const auto colon = uri.find(':');
    const std::string options = "gst:" + uri.substr(3, colon == std::string::npos ? colon : colon - 3);
    const SourceUri parameters(options);
    for (const SourceUri::Parameter& parameter : parameters.parameters()) {
        if (parameter.key != "within_ms") {
            parameters.fail("option", parameter.text, "within_ms=0 to 1000, as in gst?within_ms=10:PIPELINE");
        }
        gst.within_ns = std::llround(1e6 * parameters.number("within_ms", parameter.value, 0, most_ms));
    }
    gst.pipeline = colon == std::string::npos ? "" : uri.substr(colon + 1);
    if (gst.pipeline.find_first_not_of(' ') == std::string::npos) {
        throw std::invalid_argument(
            "source gst: there is no pipeline; expected one that ends in an appsink, as "
            "gst:v4l2src device=/dev/video0 ! jpegdec ! appsink");
    }
    return gst;
}

}  // namespace disparityd::capture

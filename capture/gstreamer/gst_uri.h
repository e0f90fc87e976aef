// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace disparityd::capture {

/// "gst:PIPELINE", or with options in front of the pipeline, which may have any character: "gst?within_ms=10:PIPELINE".
struct GstUri {
    std::string pipeline;
    std::int64_t within_ns = 5'000'000;  ///< stamps of a pair are at most so far apart
};

/// Whether a text begins as the source does.
bool is_gst(const std::string& uri);

/// Throws std::invalid_argument with one line for options that are not allowed, and for no pipeline.
GstUri parse_gst_uri(const std::string& uri);

}  // namespace disparityd::capture

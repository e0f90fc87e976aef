// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "capture/gstreamer/gst_opened.h"

namespace disparityd::capture {

/// Gives the newest frames of a live pipeline. With SourceOptions::wait_for_camera a pipeline that fails, ends or gives
/// nothing for SourceOptions::stall_time is made and started anew, at growing intervals; condition() says so. Without,
/// that ends the source. Throws std::invalid_argument for a calibration that is not there or does not fit.
std::unique_ptr<FrameSource> make_gst_live(const GstUri& uri, const SourceOptions& options, GstOpened opened);

}  // namespace disparityd::capture

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "capture/frame_source.h"

namespace disparityd::capture {

/// Plays what a GStreamer pipeline gives to one appsink, both eyes side by side, or to two, named left and right, as
/// "gst:PIPELINE" (gst_uri.h). GStreamer tells whether it is live. Of live ones the newest frames are given, stamped by
/// this machine's clocks; with SourceOptions::wait_for_camera one that fails, ends or stalls is started anew, and
/// waited for at the start. Others are played as open_recording() does: no frame is lost, stamps count from the first.
///
/// Returns when the first frame has come. Throws std::invalid_argument with one line for a pipeline that cannot be
/// made, or gives what is not taken; std::runtime_error where an element fails, or no frame comes in ten times
/// SourceOptions::stall_time. A build without GStreamer refuses all.
std::unique_ptr<FrameSource> open_gst(const SourceOptions& options);

}  // namespace disparityd::capture

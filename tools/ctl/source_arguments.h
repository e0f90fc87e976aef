// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "capture/frame_source.h"

namespace disparityd::tools {

/// Opens a source with a progress bar while it prepares itself. Throws as capture::open_source does.
std::unique_ptr<capture::FrameSource> open_with_progress(capture::SourceOptions options);

/// Returns the next frame, which the source lends; nothing at its end or after Ctrl-C (see catch_interrupts()).
std::optional<capture::RawFrame> next_frame(capture::FrameSource& source);

/// Returns "1280 x 720 per eye, yuyv, 15 frames/s, 90 frames" and whether a calibration is known.
std::string summary(const capture::SourceInfo& source);

}  // namespace disparityd::tools

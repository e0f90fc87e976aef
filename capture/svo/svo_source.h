// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "capture/frame_source.h"

namespace disparityd::capture {

/// True for names that end in .svo2, and in .svo where the file is MCAP as those are.
bool is_svo(const std::string& uri);

/// Replays a recording of the ZED SDK from 4.1 on, with the samples of its inertial sensor. Experimental: it was made
/// from public descriptions, without a real file. Threads, pace and loops are those of open_recording(). The
/// calibration is that of SourceOptions::calibration_path, else the one that calibration_folders have for the serial
/// number in the file.
///
/// Throws std::invalid_argument with one line for what is no such recording, is encrypted, or holds payloads that are
/// not known; std::runtime_error when it is damaged before the first frame. A recording that was cut off plays what is
/// whole; then next() throws std::runtime_error. So it does where messages had to be left out, and says how many.
std::unique_ptr<FrameSource> open_svo(const SourceOptions& options);

}  // namespace disparityd::capture

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "capture/frame_source.h"
#include "capture/recording/recording_reader.h"

namespace disparityd::capture {

/// True for names that end as video files do, and for every other existing file: reading it tells more.
bool is_recording(const std::string& uri);

/// Replays a recording of this project, or any side-by-side video that FFmpeg can read.
///
/// A thread of its own decodes a few frames ahead of next(). No frame is lost. With Pace::source a frame comes at its
/// recorded distance from the one before, or at once when the taker is late; capture/pacer.h has the rules. With `loop`
/// the sequence goes on counting, the first frame of each further round is flagged as a discontinuity, and the recorded
/// times start again.
///
/// Throws std::invalid_argument when the file is no video that can be taken. A truncated file plays what is whole;
/// then next() throws std::runtime_error, once, saying how many frames could be read.
std::unique_ptr<FrameSource> open_recording(const SourceOptions& options);

/// Opens what is played from its first frame.
using OpenReader = std::function<std::unique_ptr<RecordingReader>()>;

/// Replays what a reader gives, as open_recording() does. `open_reader` is called at once, in this thread, and with
/// `loop` for each further round, in the thread that decodes. Throws what it throws.
std::unique_ptr<FrameSource> play(const SourceOptions& options, const OpenReader& open_reader);

}  // namespace disparityd::capture

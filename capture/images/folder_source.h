// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "capture/frame_source.h"

namespace disparityd::capture {

/// Plays image files: a Middlebury scene, KITTI's folders, or a pattern with %d (see image_sequence.h). Grey images
/// give grey8, colour bgr24; the first pair decides. No frame is lost.
///
/// Times are the folder's own where it has some; the monotonic clock then starts at 0 with the first frame. Otherwise
/// they are 10 frames per second, from 0 and from 2000-01-01. With `loop` the sequence and such times go on counting;
/// the folder's own start again.
///
/// Throws std::invalid_argument: no images, images of unequal sizes (PNG, PGM and PPM are all looked at before the
/// first frame), a calibration that does not fit.
std::unique_ptr<FrameSource> open_images(const SourceOptions& options);

}  // namespace disparityd::capture

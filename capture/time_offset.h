// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "capture/frame_source.h"

namespace disparityd::capture {

/// Returns a source whose frames are stamped SourceOptions::time_offset_us later than those of `source`, on both
/// clocks; the samples of sensors keep their times. Its info() says what the stamps contain. Where they contain an
/// offset already, as those of a recording may, or none is asked for, it returns `source` itself, and tells `report`
/// why.
std::unique_ptr<FrameSource> with_time_offset(std::unique_ptr<FrameSource> source, const SourceOptions& options);

}  // namespace disparityd::capture

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "capture/frame_source.h"
#include "tools/ctl/processing/process_arguments.h"

namespace disparityd::tools {

/// Which frames of a part are processed.
struct FrameRange {
    std::uint64_t first = 0;
    std::optional<std::uint64_t> count;  ///< nothing: all behind it
    /// Gets each good frame before the first one, in the thread that calls next(); may be empty.
    std::function<void(const capture::RawFrame& frame)> skipped;
};

/// Opens a part of arguments.source for a range of its frames, to be read as fast as it goes. `report` as
/// SourceOptions::report. Throws as open_with_progress(), and std::invalid_argument where the source has no frame of
/// the range, as far as that is known.
std::unique_ptr<capture::FrameSource> open_part(const ProcessArguments& arguments,
                                                const capture::RunOfOneGeometry& part, FrameRange frames, int loans,
                                                std::function<void(const std::string&, bool)> report);

/// Returns how many frames are wanted at most.
std::optional<std::uint64_t> frames_of(const ProcessArguments& arguments);

}  // namespace disparityd::tools

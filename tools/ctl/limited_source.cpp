// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/limited_source.h"

#include <algorithm>
#include <utility>

namespace disparityd::tools {

LimitedSource::LimitedSource(std::unique_ptr<capture::FrameSource> source, std::uint64_t frames)
    : source_(std::move(source)), info_(source_->info()), left_(frames) {
    info_.frame_count = std::min(info_.frame_count.value_or(frames), frames);
}

capture::FrameSource::Next LimitedSource::next(capture::RawFrame& frame,
                                               std::chrono::steady_clock::time_point deadline) {
    if (left_ == 0) {
        return Next::end;
    }
    const Next got = source_->next(frame, deadline);
    if (got == Next::frame) {
        --left_;
    }
    return got;
}

}  // namespace disparityd::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "capture/frame_source.h"

namespace disparityd::tools {

/// Ends a source after a number of frames. Threads as FrameSource.
class LimitedSource final : public capture::FrameSource {
public:
    LimitedSource(std::unique_ptr<capture::FrameSource> source, std::uint64_t frames);

    const capture::SourceInfo& info() const override { return info_; }
    Next next(capture::RawFrame& frame, std::chrono::steady_clock::time_point deadline) override;
    void give_back(const capture::RawFrame& frame) noexcept override { source_->give_back(frame); }
    void interrupt() noexcept override { source_->interrupt(); }

private:
    std::unique_ptr<capture::FrameSource> source_;
    capture::SourceInfo info_;
    std::uint64_t left_;
};

}  // namespace disparityd::tools

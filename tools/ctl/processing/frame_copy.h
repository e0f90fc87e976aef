// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "calibration/rectification.h"
#include "kernels/matcher.h"

namespace disparityd::tools {

/// What the files of a frame are made of, copied out of the pipeline's slot, which goes on to the next frame meanwhile.
class FrameCopy {
public:
    /// Takes what is finished of a frame: the planes of `frame` that have pixels, without gaps between rows. Its memory
    /// is kept for the next one.
    void take(const FrameView& frame, std::shared_ptr<const calibration::Rectification> rectification);

    /// The planes that were taken; no input, and no scratch.
    const FrameView& view() const { return view_; }
    const calibration::Rectification& rectification() const { return *rectification_; }

private:
    std::vector<std::byte> memory_;
    FrameView view_;
    std::shared_ptr<const calibration::Rectification> rectification_;
};

}  // namespace disparityd::tools

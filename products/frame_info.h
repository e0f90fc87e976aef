// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/options.h"
#include "pipeline/frame_slot.h"
#include "proto/frame_info.h"

/// What the protocol says of a frame that the pipeline has finished.
namespace disparityd::products {

/// Fills in the part of the geometry that a correction of the calibration changes.
void put_geometry(proto::FrameInfo& info, const calibration::Rectification& rectification);

/// Returns what the frames of a rectification and a range have in common; what belongs to a single frame is 0.
proto::FrameInfo geometry_of(const calibration::Rectification& rectification, DisparityRange range);

/// What a frame's flags say beside the frame's own facts.
struct FrameFacts {
    bool synthetic = false;     ///< SourceInfo::synthetic
    bool interpolated = false;  ///< rejected pixels are filled
    bool first = false;         ///< of the run: nothing continues
};

/// Fills in what belongs to the single frame: its numbers, times of capture and flags, but for publish_index and age_ns
/// and the flags of added stages.
void put_frame(proto::FrameInfo& info, const pipeline::FrameSlot& slot, const FrameFacts& facts);

}  // namespace disparityd::products

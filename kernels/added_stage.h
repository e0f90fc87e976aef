// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "kernels/matcher.h"
#include "kernels/parallel.h"

namespace disparityd {

/// Where an added stage stands between those of the matcher.
enum class StagePlace : unsigned char {
    /// May change the rectified pair, which is matched and served as the stage leaves it.
    before_matching,
    /// May change disparity and confidence, from which depth and depth error are computed then. A pixel that it rejects
    /// gets invalid_disparity() and the confidence 0.
    after_matching,
    /// Changes no plane. What it finds out is in StageFrame::memory when it returns.
    record,
    /// May reject pixels of what is served, in all planes: disparity, confidence, depth and depth error. Records have
    /// been made.
    served,
};

/// A direction along the axes of the camera's inertial sensor, of any length above 0.
struct SensorDirection {
    double x = 0;
    double y = 0;
    double z = 0;

    friend bool operator==(const SensorDirection&, const SensorDirection&) = default;
};

/// A frame as an added stage gets it, valid during the call.
struct StageFrame {
    const FrameView& view;          ///< raw pixels and scratch are not for the stage
    std::span<std::byte> memory;    ///< AddedStage::bytes_per_frame(), aligned to 64; holds what an earlier frame left
    std::uint64_t sequence = 0;     ///< of the source; grows, but not always by 1
    std::int64_t monotonic_ns = 0;  ///< when it was captured; of a replay, as recorded
    bool discontinuity = false;     ///< the source began anew: earlier frames have nothing to do with this one
    // The rectified left camera, px. f = 0: not known.
    double f = 0;
    double cx = 0;
    double cy = 0;
    /// Away from gravity; nothing where no sensor has told it.
    std::optional<SensorDirection> up;
};

/// A stage that a configuration adds to those of the matcher. All its memory is allocated by its constructor and, for
/// each frame in flight, by the pipeline; run() allocates none.
class AddedStage {
public:
    virtual ~AddedStage() = default;

    /// The name of its time in the status and in traces, of static life. No other step has it.
    virtual std::string_view name() const = 0;

    virtual StagePlace place() const = 0;

    /// Whether what it makes of a frame depends on the frames before it. If so, parts of a recording give other results
    /// than the whole.
    virtual bool depends_on_earlier_frames() const = 0;

    /// Memory that each frame in flight holds for this stage. A record is as large as this.
    virtual std::size_t bytes_per_frame() const { return 0; }

    /// Processes a frame. Called by one thread, for one frame at a time, in the order of capture; other stages work on
    /// other frames meanwhile. `workers` may share the work. An exception ends the pipeline with its text.
    virtual void run(const StageFrame& frame, Parallel& workers) = 0;

    /// One line for people on what the stage lacks; empty as long as all is well. From any thread.
    virtual std::string notice() const { return {}; }
};

}  // namespace disparityd

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "capture/frame_source.h"
#include "capture/rectification.h"
#include "capture/rectification_schedule.h"
#include "kernels/matcher.h"
#include "pipeline/frame_slot.h"
#include "pipeline/histogram.h"
#include "pipeline/worker_pool.h"

namespace disparityd::pipeline {

enum class Policy {
    live,    ///< the newest frame wins: when the pipeline is behind, older waiting frames are dropped and counted
    replay,  ///< nothing is dropped; the source waits for the pipeline
};

struct PipelineConfig {
    Policy policy = Policy::replay;
    int slots = 4;             ///< frames in flight, 2 .. 32
    bool depth = true;         ///< compute depth
    bool left_colour = false;  ///< also rectify the left image in colour
};

/// Counters since start; a snapshot taken at any time, from any thread.
struct PipelineStatus {
    std::uint64_t captured = 0;         ///< frames taken from the source
    std::uint64_t published = 0;        ///< frames that reached the sink
    std::uint64_t dropped = 0;          ///< by the live policy
    std::uint64_t lost_before = 0;      ///< by the source: the sum of RawFrame::dropped_before
    std::uint64_t skipped_corrupt = 0;  ///< frames that came flagged as damaged and were not processed
    bool ended = false;                 ///< the source has ended and every frame was published
    std::string error;                  ///< why the source, a stage or the sink ended early; empty = none did
    double rate = 0;                    ///< published frames per second over the last seconds
    struct Step {
        std::string name;
        HistogramSummary time;  ///< microseconds
    };
    std::vector<Step> steps;  ///< "capture" (waiting excluded), then the matcher's, then "publish" and "total"
};

/// Frames from a source through a matcher to a sink: one thread per stage, a lock-free queue in front of each.
///
/// Owns its threads and slots; borrows source, matcher, workers and rectifications, which must outlive it. start(),
/// stop() and the destructor are called by one thread; the sink is called by the publish thread, one frame at a time
/// in order of capture. An exception of the source, a stage or the sink ends the pipeline: status().error says why.
class Pipeline {
public:
    /// Gets each finished frame; valid only during the call. Must not block for long in live use.
    using Sink = std::function<void(const FrameSlot&)>;
    /// Sees each raw frame in the capture thread before processing (a recorder copies it here). Must not block.
    using RawTap = std::function<void(const capture::RawFrame&)>;

    /// Allocates all slots. Throws std::invalid_argument when `config` is not allowed, std::logic_error when matcher
    /// and rectification differ in size, std::runtime_error when memory is missing.
    Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
             const capture::Rectification& rectification, Sink sink, RawTap raw_tap = {});
    /// The same where the rectification may change from one frame to the next.
    Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
             capture::RectificationSchedule& rectifications, Sink sink, RawTap raw_tap = {});
    ~Pipeline();
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;

    /// Once; std::logic_error the second time. std::runtime_error when the system starts no more threads: none runs
    /// then.
    void start();

    /// Interrupts the source, lets the frames in flight finish, joins all threads. Safe to call twice.
    void stop();

    /// Waits until the source has ended and all frames were published; false when `timeout` passed first.
    bool wait_until_ended(std::chrono::milliseconds timeout);

    PipelineStatus status() const;

    /// What FrameSlot::step_times holds: "capture", then the matcher's steps in order.
    const std::vector<std::string>& steps() const;

    /// The name of a stage thread that has not answered for longer than `limit` (waiting for a frame is an answer);
    /// empty when all answer. For the service manager's watchdog; any thread.
    std::string stuck_stage(std::chrono::milliseconds limit) const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace disparityd::pipeline

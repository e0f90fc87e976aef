// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/added_stage.h"
#include "kernels/matcher.h"
#include "pipeline/frame_slot.h"
#include "pipeline/heartbeat.h"
#include "pipeline/histogram.h"
#include "pipeline/noise_levels.h"
#include "pipeline/rate_meter.h"
#include "pipeline/rectification_schedule.h"
#include "pipeline/trace.h"
#include "pipeline/worker_pool.h"

namespace disparityd::pipeline {

class Admission;
class CoreBudget;
// Declared only: their header brings the library of the lock-free queues.
class CaptureStage;
class FreeSlots;
class StageQueue;

enum class Policy {
    live,    ///< the newest frame wins: when the pipeline is behind, older waiting frames are dropped and counted
    replay,  ///< nothing is dropped; the source waits for the pipeline
};

struct PipelineConfig {
    Policy policy = Policy::replay;
    int slots = 4;              ///< frames in flight, 2 .. 32
    bool depth = true;          ///< compute depth
    bool left_colour = false;   ///< also rectify the left image in colour
    bool right_colour = false;  ///< also rectify the right image in colour
    bool raw = false;           ///< also keep both eyes as captured; allowed where images are matched in their size
    /// Also compute the depth error, from this sigma of a disparity in 1/256 px, 1 .. 1024.
    std::optional<int> depth_error = std::nullopt;
    /// Stages beside the matcher's, which outlive the pipeline. Those of one place run in this order.
    std::vector<AddedStage*> stages = {};
    /// Asked in the capture thread for each frame that came: one that is not wanted is not processed. Must not block.
    /// Empty: all are wanted.
    std::function<bool()> wanted = {};
    /// Asked for each frame that is wanted, in the capture thread; outlives the pipeline. A frame that it does not
    /// admit is left out with Policy::live, and waits with Policy::replay. Null: all may begin.
    CoreBudget* budget = nullptr;
};

/// Counters since the start.
struct PipelineStatus {
    std::uint64_t captured = 0;       ///< frames taken from the source
    std::uint64_t published = 0;      ///< frames that reached the sink
    std::uint64_t dropped = 0;        ///< for newer ones by the live policy, or because the pipeline ended early
    std::uint64_t lost = 0;           ///< by the source: the sum of RawFrame::dropped_before
    std::uint64_t damaged = 0;        ///< frames that came flagged as damaged and were not processed
    std::uint64_t unwanted = 0;       ///< frames that PipelineConfig::wanted refused
    std::uint64_t over_budget = 0;    ///< frames that PipelineConfig::budget did not admit
    bool ended = false;               ///< the source has ended and every frame was published
    std::string error;                ///< why the source, a stage or the sink ended early; empty = none did
    double rate = 0;                  ///< published frames per second over the last seconds
    std::optional<FrameNoise> noise;  ///< of the newest frame, where the noise level is adaptive and it was found
    struct Step {
        std::string name;
        HistogramSummary time;  ///< microseconds
        HistogramTotals totals;
    };
    std::vector<Step> steps;  ///< those of Pipeline::steps() ("capture" without waiting), then "publish" and "total"
};

/// Takes frames from a source through a matcher to a sink: one thread per stage, a lock-free queue in front of each.
/// Added stages run in the threads next to them: those before matching after rectification, all others before the sink.
///
/// Owns its threads and slots; borrows source, matcher, stages, workers and rectifications, which must outlive it.
/// start(), stop() and the destructor are called by one thread; the sink is called by the publish thread, one frame at
/// a time in order of capture. An exception of the source, a stage or the sink ends the pipeline: status().error says
/// why.
class Pipeline {
public:
    /// Gets each finished frame, which is valid during the call. Must not block for long in live use.
    using Sink = std::function<void(const FrameSlot&)>;
    /// Gets each raw frame in the capture thread, before it is processed: a recorder copies it. Must not block.
    using RawTap = std::function<void(const capture::RawFrame&)>;

    /// Allocates all slots. Throws std::invalid_argument when `config` is not allowed, std::logic_error when matcher
    /// and rectification differ in size, std::runtime_error when memory is missing.
    Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
             const calibration::Rectification& rectification, Sink sink, RawTap raw_tap = {});
    /// Takes a rectification that may change from one frame to the next.
    Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
             RectificationSchedule& rectifications, Sink sink, RawTap raw_tap = {});
    ~Pipeline();
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;

    /// Starts the threads. Throws std::logic_error the second time, std::runtime_error when the system starts no more
    /// threads: none runs then.
    void start();

    /// Interrupts the source, lets the frames in flight finish, joins all threads. Safe to call twice.
    void stop();

    /// Waits until the source has ended and all frames were published; false when `timeout` passed first.
    bool wait_until_ended(std::chrono::milliseconds timeout);

    /// Returns a snapshot. Any thread.
    PipelineStatus status() const;

    /// Returns the names of the times in FrameSlot::step_times in the order in which a frame passes them: "capture",
    /// "wait-start" (for the cores), the matcher's steps and added stages, "depth" where stages after matching leave it
    /// to the pipeline, "wait-between" (in front of stages and for workers, in all).
    const std::vector<std::string>& steps() const;

    /// Returns the name of a stage thread whose last heartbeat is older than `limit`; empty when there is none. A
    /// thread that waits for a frame beats, too. For the service manager's watchdog. Any thread.
    std::string stuck_stage(std::chrono::milliseconds limit) const;

private:
    // Threads wait at the gate until all are started: what one enqueues, another has to take.
    enum class Gate { closed, open, given_up };

    Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
             std::unique_ptr<RectificationSchedule> own, RectificationSchedule* borrowed, Sink sink, RawTap raw_tap);

    /// Of the steady clock.
    struct Period {
        std::int64_t begin_ns = 0;
        std::int64_t end_ns = 0;
    };

    /// A thread's track, and how its work is called there.
    struct Traced {
        std::unique_ptr<TraceTrack> track;
        std::uint16_t name = 0;
    };

    /// An added stage, and what of a slot is its own.
    struct Added {
        AddedStage* stage;
        std::size_t step;    ///< index of step_names_
        std::size_t memory;  ///< index of FrameSlot::stage_memory
    };

    void add_steps(const PipelineConfig& config);
    void add(StagePlace place, std::vector<Added>& to);
    void check(const PipelineConfig& config, const calibration::Rectification& rectification) const;
    void start_thread(std::function<void()> loop);
    void open_gate(Gate gate);
    void join();
    std::string_view thread_name(std::size_t thread) const;
    void fail() noexcept;
    void keep_failure() noexcept;
    void capture_loop();
    void stage_loop(std::size_t stage);
    FrameSlot* take(std::size_t thread);
    void put(StageQueue& queue, FrameSlot* slot);
    void work(std::size_t stage, FrameSlot& slot);
    void begins(std::size_t stage);  ///< of the threads after capture
    void ends(std::size_t stage);
    void trace_steps(std::size_t stage, const FrameSlot& slot, const Period& work);
    void publish_loop();
    /// Runs stages in the thread of that number; false: one failed, and so does the pipeline.
    bool run_added(const std::vector<Added>& stages, std::size_t thread, FrameSlot& slot);
    void run_added(const Added& added, const Traced& traced, FrameSlot& slot);
    bool publish(const FrameSlot& slot);  ///< false: it failed, and so does the pipeline

    const std::unique_ptr<RectificationSchedule> own_rectifications_;  ///< where the caller has one rectification only
    RectificationSchedule& rectifications_;
    capture::FrameSource& source_;
    Matcher& matcher_;
    WorkerPool& workers_;
    const Sink sink_;

    std::unique_ptr<AddedStage> depth_stage_;    ///< where stages after matching change what depth follows from
    std::unique_ptr<NoiseLevels> noise_levels_;  ///< where the matcher wants a level with each frame
    std::vector<AddedStage*> stages_;            ///< all added ones; depth_stage_ and noise_levels_ last
    std::vector<Added> before_matching_;
    std::vector<Added> before_sink_;
    std::vector<std::string> step_names_;
    std::vector<std::size_t> first_step_;      ///< per matcher stage, an index of step_names_
    std::vector<Histogram> times_;             ///< per step, then "publish" and "total"
    std::vector<std::uint16_t> traced_steps_;  ///< per step, its name in the tracer
    std::vector<Traced> traced_;               ///< per thread, as heartbeats_
    std::vector<Heartbeat> heartbeats_;        ///< per thread: capture, the matcher's stages, publish
    std::vector<std::atomic<bool>> finished_;  ///< per thread, as heartbeats_
    std::vector<std::unique_ptr<FrameSlot>> slots_;
    std::unique_ptr<FreeSlots> free_slots_;
    std::vector<std::unique_ptr<StageQueue>> queues_;  ///< in front of each matcher stage, and of publish
    std::unique_ptr<CaptureStage> capture_stage_;
    std::unique_ptr<Admission> admission_;  ///< null: frames begin as soon as there is room

    std::atomic<bool> stopping_{false};
    std::atomic<bool> failed_{false};
    std::atomic<std::uint64_t> published_{0};
    std::atomic<std::uint64_t> abandoned_{0};  ///< frames that the publish thread got and did not publish
    RateMeter rate_;
    mutable std::mutex mutex_;  ///< the two below
    bool ended_ = false;
    std::exception_ptr failure_;
    std::condition_variable ended_changed_;
    std::atomic<Gate> gate_{Gate::closed};
    std::vector<std::thread> threads_;
};

}  // namespace disparityd::pipeline

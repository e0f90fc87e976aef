// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "capture/frame_source.h"
#include "daemon/config/config.h"
#include "daemon/configured_source.h"
#include "daemon/frame_cost.h"
#include "daemon/level_watch.h"
#include "daemon/load_watch.h"
#include "daemon/measured_watch.h"
#include "daemon/memory_bounds.h"
#include "daemon/published_frame.h"
#include "daemon/raw_cameras.h"
#include "daemon/self_calibrator.h"
#include "daemon/stage_table.h"
#include "daemon/system/core_locks.h"
#include "daemon/trust_watch.h"
#include "kernels/matcher.h"
#include "pipeline/calibrating_schedule.h"
#include "pipeline/core_budget.h"
#include "pipeline/pipeline.h"
#include "pipeline/rectification_schedule.h"
#include "pipeline/worker_pool.h"

namespace disparityd::daemon {

/// The chain from source to finished frame, built from a configuration as a whole and replaced as a whole. One thread
/// at a time builds, starts and stops it; any thread may call the rest.
class Engine {
public:
    /// The notice of a source that renders its frames.
    static constexpr const char* synthetic_notice =
        "the frames are synthetic, no camera saw them: for those of a camera set [source] uri, such as \"v4l2:auto\"";

    /// What one engine passes to the next.
    using CarryOver = SourceCarryOver;

    /// Opens and allocates everything. The source reports its preparation by `progress`, which may throw to give up.
    /// Throws std::invalid_argument when the user must change something, std::runtime_error when the system refuses.
    Engine(const Config& config, const CarryOver& carry_over, std::function<void(int done, int total)> progress);
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    /// Gets frames in the publish thread; see Pipeline.
    using Sink = std::function<void(const PublishedFrame&)>;

    /// Starts the pipeline; frames are numbered from `first_index` on. `raw` is called in the capture thread. So is
    /// `wanted`, whether anybody wants frames: for each with [pipeline] on_demand, and before the first one where
    /// [source] start waits for a client. Throws std::runtime_error when the system starts no more threads.
    void start(Sink sink, pipeline::Pipeline::RawTap raw, std::function<bool()> wanted, std::uint64_t first_index);
    void stop();
    bool stopped() const { return stopped_; }

    /// Returns the number of the next frame; to be called after stop().
    std::uint64_t next_index() const { return next_index_; }

    const capture::SourceInfo& source() const { return source_->info(); }
    const StreamLayout& layout() const { return layout_; }
    /// Returns the workers for people: "2 workers, pinned, each to one of cores 0-1", and their budget.
    std::string workers() const;

    enum class State { waiting, running, idle, ended };
    struct Condition {
        State state = State::waiting;
        std::string detail;   ///< one line for people
        bool failed = false;  ///< ended because of damaged input
    };
    Condition condition() const;

    /// Returns whether the source is no longer what this engine was built for, such as another camera: build a new one.
    bool source_changed() const;

    /// Returns the USB port of the live camera, or of the one that it changed to; empty for other sources.
    std::string camera_port() const;

    /// Takes where up is from a client (LevelWatch), and returns what scans have then. Throws std::invalid_argument
    /// with one line for what cannot be taken.
    v1::LevelStatus take_level(const v1::GiveLevel& message, std::uint64_t client);

    /// See capture::FrameSource::set_camera_controls().
    std::vector<capture::CameraControl> control_camera(const std::vector<capture::CameraSetting>& settings);

    /// Fills in state, source, method, counters, step times and notices; leaves the rest of the message alone. Its
    /// totals are those of this engine; after stop() they are final.
    void fill(v1::Status& status) const;

    /// Returns a line for people where [pipeline] on_demand is set and has no effect; else an empty text.
    std::string on_demand_note() const;

    /// Returns a line for people: what [pipeline] cores means for this source; empty where it is "all".
    std::string core_share() const;

    /// Returns what the user should know, such as workers without cores of their own, or small pages.
    std::vector<std::string> notices() const;

    /// Checks once whether the system gave huge pages: after the first frame, when all memory is in use. Returns true
    /// when that has left a notice. One thread.
    bool check_memory();

    /// Returns, once, that matching is slower than the source, which stays as a notice (LoadWatch); else an empty text.
    /// The same thread.
    std::string check_load();

    /// Looks whether cores have come free that workers lack, and gives all back once nothing is matched any more.
    /// Returns whether workers() says something else since. The thread that starts and stops the engine.
    bool check_cores();

    /// Returns lines for the log: alarms that have begun or ended (TrustWatch). The same thread.
    std::vector<std::string> check_trust() { return trust_.check(std::chrono::steady_clock::now()); }

    /// Returns one line for people when much of the image has become nearer than can be measured, once each time. As
    /// check_load().
    std::string check_near();

    /// See Matcher::trouble().
    std::string matcher_trouble() const { return matcher_->trouble(); }

    /// Returns the most memory that the daemon holds with this engine, which was just made. The engine has all of its
    /// own since.
    MemoryBounds memory() const;

    /// Lets a few frames through all that start() would let them through, as far apart as they would come, but for
    /// clients and recordings: those of the source, or of noise in place of a camera's. Returns what one costs. Instead
    /// of start(), once. Throws std::runtime_error when a stage fails or the system refuses threads or memory.
    FrameCost cost_of_frame();

    /// Returns cost_of_frame() as a line for people, and where frames come faster than that, what would fit.
    std::string work();

    /// One line for people: the distances that are measured (calibration/depth_range.h). Empty as long as a camera is
    /// waited for whose calibration is unknown.
    std::string distances() const;

    /// Records what the threads of this engine do; see pipeline::Tracer.
    pipeline::Tracer& tracer() { return workers_.tracer(); }

    std::string stuck_stage(std::chrono::milliseconds limit) const;

private:
    Condition condition_of(const pipeline::PipelineStatus& status) const;
    void publish(const pipeline::FrameSlot& slot);
    Plane<const std::uint8_t> record_plane(const pipeline::FrameSlot& slot, v1::Product product) const;
    pipeline::PipelineConfig pipeline_config() const;
    FrameLoad load() const;
    void make_self_calibrator();
    void make_measured();
    void note_rectification(const pipeline::FrameSlot& slot);
    void fill_self_calibration(v1::Status& status) const;
    void note_activity();
    bool wants_frame();

    Config config_;
    std::unique_ptr<capture::FrameSource> source_;
    std::unique_ptr<pipeline::RectificationSchedule> rectifications_;
    pipeline::CorrectedRectification* corrected_ = nullptr;       ///< the same, where it is one
    const pipeline::CalibratingSchedule* calibrating_ = nullptr;  ///< the same, where it is one
    std::unique_ptr<Matcher> matcher_;
    std::string backend_;
    CoreLocks core_locks_;
    std::optional<pipeline::CoreBudget> budget_;
    pipeline::WorkerPool workers_;
    LevelWatch level_;
    std::vector<ConfiguredStage> stages_;
    StreamLayout layout_;
    std::unique_ptr<SelfCalibrator> self_calibrator_;  ///< null where there is nothing to estimate
    std::unique_ptr<MeasuredWatch> measured_;          ///< null before start()
    TrustWatch trust_;
    Sink sink_;
    pipeline::Pipeline::RawTap raw_;
    std::function<bool()> wanted_;
    std::atomic<bool> idle_{false};  ///< the newest frame was wanted by nobody
    bool started_ = false;
    bool stopped_ = false;          ///< of the thread that calls stop()
    std::uint64_t next_index_ = 0;  ///< the publish thread's while it runs
    bool first_frame_ = true;
    std::atomic<std::int64_t> last_activity_ns_{0};
    bool memory_checked_ = false;  ///< of the thread that calls check_memory()
    LoadWatch load_;               ///< of the same
    mutable std::mutex mutex_;     ///< the four below
    std::string memory_notice_;
    std::string load_notice_;
    proto::FrameInfo geometry_{};                         ///< of the newest frame; the publish thread writes it
    Turns to_rectified_;                                  ///< of the same: how its images were turned; as geometry_
    calibration::CalibrationCorrection correction_ = {};  ///< of the same: what the calibration was corrected by
    std::unique_ptr<pipeline::Pipeline> pipeline_;        ///< last: its threads use the rest
};

/// Returns "waiting", "running", "idle" or "ended".
const char* to_string(Engine::State state);

}  // namespace disparityd::daemon

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

#include "calibration/calibrating_schedule.h"
#include "capture/frame_source.h"
#include "capture/rectification_schedule.h"
#include "daemon/config.h"
#include "daemon/published_frame.h"
#include "daemon/self_calibrator.h"
#include "kernels/matcher.h"
#include "pipeline/pipeline.h"
#include "pipeline/worker_pool.h"

namespace disparityd {

/// The chain from source to finished frame, built from a configuration as a whole and replaced as a whole. Made,
/// started and stopped by one thread at a time; the rest from any.
class Engine {
public:
    /// What an engine is told of those before it; see SourceOptions.
    struct Heritage {
        std::shared_ptr<capture::SetControls> set_controls;
        std::string camera_port;
    };

    /// Opens and allocates everything. `progress` hears how far the source is with preparing itself and may throw to
    /// give up. Throws std::invalid_argument when the user must change something, std::runtime_error when the system
    /// refuses.
    Engine(const Config& config, const Heritage& heritage, std::function<void(int done, int total)> progress);
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    /// Sinks get frames in the publish thread, `raw` in the capture thread; see Pipeline.
    using Sink = std::function<void(const PublishedFrame&)>;

    /// Frames are numbered from `first_index` on. Throws std::runtime_error when the system starts no more threads.
    void start(Sink sink, pipeline::Pipeline::RawTap raw, std::uint64_t first_index);
    void stop();
    bool stopped() const { return stopped_; }

    /// Number of the next frame; after stop().
    std::uint64_t next_index() const { return next_index_; }

    const capture::SourceInfo& source() const { return source_->info(); }
    const StreamLayout& layout() const { return layout_; }
    /// "2 workers, pinned, each to one of cores 0-1"
    std::string workers() const;

    enum class State { waiting, running, ended };
    struct Condition {
        State state = State::waiting;
        std::string detail;   ///< one line for people
        bool failed = false;  ///< ended because of damaged input
    };
    Condition condition() const;

    /// The source is no longer what this engine was built for, such as another camera: build a new one.
    bool source_changed() const;

    /// Where the live camera is plugged in, or the one that it changed to; empty for other sources.
    std::string camera_port() const;

    /// See capture::FrameSource::control().
    std::vector<capture::CameraControl> control_camera(const std::vector<capture::CameraSetting>& settings);

    /// State, source, method, counters, step times and notices; the rest of the message is left alone.
    void fill(v1::Status& status) const;

    /// What the user should know: workers without cores of their own, small pages.
    std::vector<std::string> notices() const;

    /// Once there was a frame, and so all memory is in use, looks whether the system gave huge pages for it. True when
    /// that has left a notice. From one thread.
    bool check_memory();

    /// See Matcher::trouble().
    std::string matcher_trouble() const { return matcher_->trouble(); }

    std::string stuck_stage(std::chrono::milliseconds limit) const;

private:
    Condition condition_of(const pipeline::PipelineStatus& status) const;
    void publish(const pipeline::FrameSlot& slot);
    void make_self_calibrator();
    void note_rectification(const capture::Rectification& used);
    void fill_self_calibration(v1::Status& status) const;
    void note_activity();

    Config config_;
    std::unique_ptr<capture::FrameSource> source_;
    std::unique_ptr<capture::RectificationSchedule> rectifications_;
    capture::RectificationBook* book_ = nullptr;                     ///< the same, where it is one
    const calibration::CalibratingSchedule* calibrating_ = nullptr;  ///< the same, where it is one
    std::unique_ptr<Matcher> matcher_;
    std::string backend_;
    pipeline::WorkerPool workers_;
    StreamLayout layout_;
    std::unique_ptr<SelfCalibrator> self_calibrator_;  ///< none where there is nothing to estimate
    Sink sink_;
    pipeline::Pipeline::RawTap raw_;
    bool started_ = false;
    bool stopped_ = false;          ///< of the thread that calls stop()
    std::uint64_t next_index_ = 0;  ///< the publish thread's while it runs
    bool first_frame_ = true;
    std::atomic<std::int64_t> last_activity_ns_{0};
    bool memory_checked_ = false;  ///< of the thread that calls check_memory()
    mutable std::mutex mutex_;     ///< the two below
    std::string memory_notice_;
    proto::ShmFrame geometry_{};                    ///< of the newest frame; written by the publish thread
    std::unique_ptr<pipeline::Pipeline> pipeline_;  ///< last: its threads use the rest
};

/// "waiting", "running", "ended"
const char* name(Engine::State state);

}  // namespace disparityd

// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include <pthread.h>

#include "capture/start_thread.h"
#include "pipeline/intake.h"
#include "pipeline/rate_meter.h"
#include "pipeline/stage_queue.h"

namespace disparityd::pipeline {

using std::chrono::steady_clock;

namespace {

void name_this_thread(std::string_view stage) {
    // The kernel takes 15 characters.
    pthread_setname_np(pthread_self(), std::string(stage.substr(0, 15)).c_str());
}

int steps_of(const Matcher& matcher) {
    int steps = 0;
    for (const StageInfo& stage : matcher.stages()) {
        steps += static_cast<int>(stage.steps.size());
    }
    return steps;
}

}  // namespace

class Pipeline::Impl {
public:
    Impl(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
         std::unique_ptr<capture::RectificationSchedule> own, capture::RectificationSchedule& rectifications, Sink sink,
         RawTap raw_tap)
        : own_rectifications_(std::move(own)),
          source_(source),
          matcher_(matcher),
          workers_(workers),
          sink_(std::move(sink)),
          times_(static_cast<std::size_t>(steps_of(matcher)) + 3),
          pulses_(matcher.stages().size() + 2),
          finished_(pulses_.size()),
          free_slots_(static_cast<std::size_t>(config.slots)) {
        check(config, rectifications.factory());
        step_names_.emplace_back("capture");
        for (const StageInfo& stage : matcher.stages()) {
            first_step_.push_back(step_names_.size());
            step_names_.insert(step_names_.end(), stage.steps.begin(), stage.steps.end());
        }
        // Live: one waiting frame in front of each stage keeps it busy, more would only be older.
        const auto capacity = config.policy == Policy::live ? 1U : static_cast<std::size_t>(config.slots);
        for (std::size_t i = 0; i <= matcher.stages().size(); ++i) {
            queues_.push_back(std::make_unique<StageQueue>(capacity));
        }
        for (int i = 0; i < config.slots; ++i) {
            slots_.push_back(std::make_unique<FrameSlot>(matcher, FrameSlot::Products{config.depth, config.left_colour},
                                                         step_names_.size()));
            slots_.back()->view.rectifier = &slots_.back()->rectifier;
            free_slots_.put_back(slots_.back().get());
        }
        intake_ = std::make_unique<Intake>(config.policy, source, free_slots_, *queues_[0], rectifications,
                                           std::move(raw_tap));
    }

    ~Impl() { stop(); }

    void start() {
        if (!threads_.empty()) {
            throw std::logic_error("a pipeline starts once");
        }
        threads_.reserve(pulses_.size());
        try {
            start_thread([this] { capture_loop(); });
            for (std::size_t i = 0; i < matcher_.stages().size(); ++i) {
                start_thread([this, i] { stage_loop(i); });
            }
            start_thread([this] { publish_loop(); });
        } catch (...) {
            open_gate(Gate::given_up);
            join();
            threads_.clear();
            gate_.store(Gate::closed);
            throw;
        }
        for (Pulse& pulse : pulses_) {
            pulse.beat();  // it is long since they were made
        }
        open_gate(Gate::open);
    }

    void stop() {
        stopping_.store(true, std::memory_order_relaxed);
        source_.interrupt();
        join();
    }

    bool wait_until_ended(std::chrono::milliseconds timeout) {
        std::unique_lock lock(mutex_);
        return ended_changed_.wait_for(lock, timeout, [this] { return ended_; });
    }

    PipelineStatus status() const {
        PipelineStatus status;
        {
            // First, so that the status of a source that has ended counts all its frames.
            const std::lock_guard lock(mutex_);
            status.ended = ended_;
            status.error = error_;
        }
        const Intake::Counters& counters = intake_->counters();
        // Against the flow, so that a frame which moves meanwhile is never published before it was captured.
        status.published = published_.load(std::memory_order_acquire);
        status.captured = counters.captured.load(std::memory_order_relaxed);
        status.dropped = counters.dropped.load(std::memory_order_relaxed);
        status.lost_before = counters.lost_before.load(std::memory_order_relaxed);
        status.skipped_corrupt = counters.corrupt.load(std::memory_order_relaxed);
        status.rate = rate_.per_second(steady_clock::now());
        for (std::size_t i = 0; i < times_.size(); ++i) {
            const std::size_t extra = i - step_names_.size();
            status.steps.push_back({i < step_names_.size() ? step_names_[i]
                                    : extra == 0           ? "publish"
                                                           : "total",
                                    times_[i].summary()});
        }
        return status;
    }

    const std::vector<std::string>& steps() const { return step_names_; }

    std::string stuck_stage(std::chrono::milliseconds limit) const {
        if (threads_.empty()) {
            return {};
        }
        for (std::size_t i = 0; i < pulses_.size(); ++i) {
            if (!finished_[i].load(std::memory_order_relaxed) && pulses_[i].silence() > limit) {
                return std::string(thread_name(i));
            }
        }
        return {};
    }

private:
    // Threads begin when all are there: what one hands on, another has to take.
    enum class Gate { closed, open, given_up };

    void start_thread(std::function<void()> loop) {
        threads_.push_back(capture::start_thread([this, loop = std::move(loop)] {
            gate_.wait(Gate::closed);
            if (gate_.load() == Gate::open) {
                loop();
            }
        }));
    }

    void open_gate(Gate gate) {
        gate_.store(gate);
        gate_.notify_all();
    }

    void join() {
        for (std::thread& thread : threads_) {
            if (thread.joinable()) {
                thread.join();
            }
        }
    }

    void check(const PipelineConfig& config, const capture::Rectification& rectification) const {
        if (config.slots < 2 || config.slots > 32) {
            throw std::invalid_argument("pipeline: slots = " + std::to_string(config.slots) + ": allowed is 2 to 32");
        }
        const MatcherConfig& matcher = matcher_.config();
        if (matcher.width != rectification.width || matcher.height != rectification.height) {
            throw std::logic_error("matcher and rectification differ in size");
        }
    }

    std::string_view thread_name(std::size_t thread) const {
        const std::size_t stages = matcher_.stages().size();
        return thread == 0 ? "capture" : thread <= stages ? matcher_.stages()[thread - 1].name : "publish";
    }

    // A failure anywhere ends the whole: frames still on their way are passed on without being worked on.
    void fail(const std::exception& error) {
        {
            const std::lock_guard lock(mutex_);
            if (error_.empty()) {
                error_ = error.what();
            }
        }
        failed_.store(true, std::memory_order_relaxed);
        stopping_.store(true, std::memory_order_relaxed);
        source_.interrupt();
    }

    void capture_loop() {
        name_this_thread(thread_name(0));
        try {
            intake_->run(pulses_[0], times_[0], stopping_);
        } catch (const std::exception& error) {
            const std::lock_guard lock(mutex_);
            if (error_.empty()) {
                error_ = error.what();
            }
        }
        queues_[0]->reserve(pulses_[0]);
        finished_[0].store(true, std::memory_order_relaxed);
        queues_[0]->put(nullptr);
    }

    void stage_loop(std::size_t stage) {
        name_this_thread(thread_name(stage + 1));
        Pulse& pulse = pulses_[stage + 1];
        StageQueue& next = *queues_[stage + 1];
        FrameSlot* slot = nullptr;
        do {
            // Room first, frame second: what waits for room is still the newest when the work begins.
            next.reserve(pulse);
            slot = queues_[stage]->take(pulse);
            if (slot != nullptr) {
                work(stage, *slot);
            } else {
                finished_[stage + 1].store(true, std::memory_order_relaxed);
            }
            next.put(slot);
        } while (slot != nullptr);
    }

    void work(std::size_t stage, FrameSlot& slot) {
        const std::size_t first = first_step_[stage];
        const std::span<std::chrono::nanoseconds> times(&slot.step_times[first], matcher_.stages()[stage].steps.size());
        if (!failed_.load(std::memory_order_relaxed)) {
            try {
                const WorkerPool::Seat seat(workers_);
                matcher_.run(static_cast<int>(stage), slot.view, workers_, times);
            } catch (const std::exception& error) {
                fail(error);
            }
        }
        for (std::size_t i = 0; i < times.size(); ++i) {
            times_[first + i].record(times[i]);
        }
        if (stage == 0) {
            source_.give_back(slot.raw);
            slot.view.raw.data = nullptr;
        }
    }

    void publish_loop() {
        const std::size_t thread = pulses_.size() - 1;
        name_this_thread(thread_name(thread));
        while (FrameSlot* slot = queues_.back()->take(pulses_[thread])) {
            if (!failed_.load(std::memory_order_relaxed)) {
                publish(*slot);
            }
            free_slots_.put_finished(slot);
        }
        finished_[thread].store(true, std::memory_order_relaxed);
        {
            const std::lock_guard lock(mutex_);
            ended_ = true;
        }
        ended_changed_.notify_all();
    }

    void publish(const FrameSlot& slot) {
        const auto start = steady_clock::now();
        // Counted first: who has received a frame must not read a status that does not know of it.
        published_.fetch_add(1, std::memory_order_release);
        rate_.tick(start);
        try {
            sink_(slot);
        } catch (const std::exception& error) {
            published_.fetch_sub(1, std::memory_order_relaxed);
            fail(error);
            return;
        }
        const auto end = steady_clock::now();
        times_[step_names_.size()].record(end - start);
        times_[step_names_.size() + 1].record(end - slot.captured);
    }

    const std::unique_ptr<capture::RectificationSchedule> own_rectifications_;  // where the caller has one only
    capture::FrameSource& source_;
    Matcher& matcher_;
    WorkerPool& workers_;
    const Sink sink_;

    std::vector<std::string> step_names_;
    std::vector<std::size_t> first_step_;      // per matcher stage, an index of step_names_
    std::vector<Histogram> times_;             // per step, then "publish" and "total"
    std::vector<Pulse> pulses_;                // per thread: capture, the matcher's stages, publish
    std::vector<std::atomic<bool>> finished_;  // per thread, as pulses_
    std::vector<std::unique_ptr<FrameSlot>> slots_;
    FreeSlots free_slots_;
    std::vector<std::unique_ptr<StageQueue>> queues_;  // in front of each matcher stage, and of publish
    std::unique_ptr<Intake> intake_;

    std::atomic<bool> stopping_{false};
    std::atomic<bool> failed_{false};
    std::atomic<std::uint64_t> published_{0};
    RateMeter rate_;
    mutable std::mutex mutex_;
    std::condition_variable ended_changed_;
    bool ended_ = false;
    std::string error_;
    std::atomic<Gate> gate_{Gate::closed};
    std::vector<std::thread> threads_;
};

Pipeline::Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
                   const capture::Rectification& rectification, Sink sink, RawTap raw_tap)
    : impl_([&] {
          auto fixed = std::make_unique<capture::FixedRectification>(rectification);
          capture::RectificationSchedule& schedule = *fixed;
          return std::make_unique<Impl>(config, source, matcher, workers, std::move(fixed), schedule, std::move(sink),
                                        std::move(raw_tap));
      }()) {}

Pipeline::Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
                   capture::RectificationSchedule& rectifications, Sink sink, RawTap raw_tap)
    : impl_(std::make_unique<Impl>(config, source, matcher, workers, nullptr, rectifications, std::move(sink),
                                   std::move(raw_tap))) {}

Pipeline::~Pipeline() = default;

void Pipeline::start() {
    impl_->start();
}

void Pipeline::stop() {
    impl_->stop();
}

bool Pipeline::wait_until_ended(std::chrono::milliseconds timeout) {
    return impl_->wait_until_ended(timeout);
}

PipelineStatus Pipeline::status() const {
    return impl_->status();
}

const std::vector<std::string>& Pipeline::steps() const {
    return impl_->steps();
}

std::string Pipeline::stuck_stage(std::chrono::milliseconds limit) const {
    return impl_->stuck_stage(limit);
}

}  // namespace disparityd::pipeline

// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <pthread.h>

#include "base/failure_text.h"
#include "base/start_thread.h"
#include "kernels/added_stage.h"
#include "kernels/frame_stages.h"
#include "kernels/noise/noise_level.h"
#include "kernels/parallel_rows.h"
#include "kernels/steps.h"
#include "pipeline/admission.h"
#include "pipeline/capture_stage.h"
#include "pipeline/stage_queue.h"

namespace disparityd::pipeline {

using std::chrono::steady_clock;

namespace {

/// Index of step_names_: from capture until the first stage begins.
constexpr std::size_t wait_start = 1;

bool any_after_matching(const std::vector<AddedStage*>& stages) {
    return std::any_of(stages.begin(), stages.end(),
                       [](const AddedStage* stage) { return stage->place() == StagePlace::after_matching; });
}

void name_this_thread(std::string_view stage) {
    // The kernel allows 15 characters.
    pthread_setname_np(pthread_self(), std::string(stage.substr(0, 15)).c_str());
}

FrameView without_depth(FrameView view) {
    view.depth = {};
    view.depth_error = {};
    return view;
}

/// Computes depth and depth error, step 13 of docs/algorithm.md, from the disparities that stages after matching leave:
/// in place of the matcher, with its bytes.
class DepthStage final : public AddedStage {
public:
    explicit DepthStage(const MatcherConfig& config)
        : steps_(fastest_frame_steps()), range_(config.options.range), height_(config.height) {}

    std::string_view name() const override { return "depth"; }
    StagePlace place() const override { return StagePlace::after_matching; }
    bool depends_on_earlier_frames() const override { return false; }
    void run(const StageFrame& frame, Parallel& workers) override {
        parallel_rows(height_, workers, [&](Rows rows) { write_depth(steps_, range_, frame.view, rows); });
    }

private:
    const FrameSteps& steps_;  // finding them allocates
    DisparityRange range_;
    int height_;
};

}  // namespace

Pipeline::Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
                   const calibration::Rectification& rectification, Sink sink, RawTap raw_tap)
    : Pipeline(config, source, matcher, workers, std::make_unique<FixedRectification>(rectification), nullptr,
               std::move(sink), std::move(raw_tap)) {}

Pipeline::Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
                   RectificationSchedule& rectifications, Sink sink, RawTap raw_tap)
    : Pipeline(config, source, matcher, workers, nullptr, &rectifications, std::move(sink), std::move(raw_tap)) {}

Pipeline::Pipeline(const PipelineConfig& config, capture::FrameSource& source, Matcher& matcher, WorkerPool& workers,
                   std::unique_ptr<RectificationSchedule> own, RectificationSchedule* borrowed, Sink sink,
                   RawTap raw_tap)
    : own_rectifications_(std::move(own)),
      rectifications_(own_rectifications_ ? *own_rectifications_ : *borrowed),
      source_(source),
      matcher_(matcher),
      workers_(workers),
      sink_(std::move(sink)),
      heartbeats_(matcher.stages().size() + 2),
      finished_(heartbeats_.size()),
      free_slots_(std::make_unique<FreeSlots>(static_cast<std::size_t>(config.slots))) {
    check(config, rectifications_.factory());
    add_steps(config);
    times_ = std::vector<Histogram>(step_names_.size() + 2);
    Tracer& tracer = workers.tracer();
    for (std::size_t i = 0; i < heartbeats_.size(); ++i) {
        const std::string name(thread_name(i));
        traced_.push_back({std::make_unique<TraceTrack>(tracer, name), tracer.index_of(name)});
    }
    for (const std::string& name : step_names_) {
        traced_steps_.push_back(tracer.index_of(name));
    }
    // Live: one waiting frame keeps a stage busy; more would only be older.
    const auto capacity = config.policy == Policy::live ? 1U : static_cast<std::size_t>(config.slots);
    for (std::size_t i = 0; i <= matcher.stages().size(); ++i) {
        queues_.push_back(std::make_unique<StageQueue>(capacity));
    }
    for (int i = 0; i < config.slots; ++i) {
        slots_.push_back(std::make_unique<FrameSlot>(
            matcher,
            FrameSlot::Products{config.depth, config.left_colour, config.right_colour, config.raw, config.depth_error},
            stages_, step_names_.size()));
        slots_.back()->view.rectifier = &slots_.back()->rectifier;
        free_slots_->put_back(slots_.back().get());
    }
    // A device has queues of its own, which it keeps full.
    if (config.policy == Policy::live && matcher.computes_on_workers()) {
        const std::size_t stages = matcher.stages().size();
        admission_ = std::make_unique<Admission>(stages + 1, any_after_matching(stages_) ? stages + 1 : stages,
                                                 static_cast<std::size_t>(config.slots), workers.workers());
    }
    capture_stage_ = std::make_unique<CaptureStage>(config.policy, source, *free_slots_, *queues_[0], rectifications_,
                                                    std::move(raw_tap), config.wanted, config.budget, *traced_[0].track,
                                                    traced_[0].name);
}

Pipeline::~Pipeline() {
    stop();
}

void Pipeline::start() {
    if (!threads_.empty()) {
        throw std::logic_error("a pipeline starts once");
    }
    threads_.reserve(heartbeats_.size());
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
    for (Heartbeat& heartbeat : heartbeats_) {
        heartbeat.beat();  // the constructor may have run long ago
    }
    open_gate(Gate::open);
}

void Pipeline::stop() {
    stopping_.store(true, std::memory_order_relaxed);
    source_.interrupt();
    join();
}

bool Pipeline::wait_until_ended(std::chrono::milliseconds timeout) {
    std::unique_lock lock(mutex_);
    return ended_changed_.wait_for(lock, timeout, [this] { return ended_; });
}

PipelineStatus Pipeline::status() const {
    PipelineStatus status;
    {
        // Read first: the counters of a source that has ended are then complete.
        const std::lock_guard lock(mutex_);
        status.ended = ended_;
        status.error = failure_ ? base::failure_text(failure_) : std::string();
    }
    const CaptureStage::Counters& counters = capture_stage_->counters();
    // Read against the flow of frames: so no status has more frames that have ended than captured ones.
    status.published = published_.load(std::memory_order_acquire);
    status.dropped = abandoned_.load(std::memory_order_acquire) + counters.dropped.load(std::memory_order_acquire);
    status.damaged = counters.damaged.load(std::memory_order_acquire);
    status.unwanted = counters.unwanted.load(std::memory_order_acquire);
    status.over_budget = counters.over_budget.load(std::memory_order_acquire);
    status.captured = counters.captured.load(std::memory_order_relaxed);
    status.lost = counters.lost.load(std::memory_order_relaxed);
    status.rate = rate_.per_second(steady_clock::now());
    status.noise = noise_levels_ ? noise_levels_->newest() : std::nullopt;
    for (std::size_t i = 0; i < times_.size(); ++i) {
        const std::size_t extra = i - step_names_.size();
        status.steps.push_back({i < step_names_.size() ? step_names_[i]
                                : extra == 0           ? "publish"
                                                       : "total",
                                times_[i].summary(), times_[i].totals()});
    }
    return status;
}

const std::vector<std::string>& Pipeline::steps() const {
    return step_names_;
}

std::string Pipeline::stuck_stage(std::chrono::milliseconds limit) const {
    if (threads_.empty()) {
        return {};
    }
    for (std::size_t i = 0; i < heartbeats_.size(); ++i) {
        if (!finished_[i].load(std::memory_order_relaxed) && heartbeats_[i].age() > limit) {
            return std::string(thread_name(i));
        }
    }
    return {};
}

void Pipeline::start_thread(std::function<void()> loop) {
    threads_.push_back(base::start_thread([this, loop = std::move(loop)] {
        gate_.wait(Gate::closed);
        if (gate_.load() == Gate::open) {
            loop();
        }
    }));
}

void Pipeline::open_gate(Gate gate) {
    gate_.store(gate);
    gate_.notify_all();
}

void Pipeline::join() {
    for (std::thread& thread : threads_) {
        if (thread.joinable()) {
            thread.join();
        }
    }
}

/// Finds the steps that a frame passes, in order, and the added stages among them.
void Pipeline::add_steps(const PipelineConfig& config) {
    stages_ = config.stages;
    if (any_after_matching(stages_) && (config.depth || config.depth_error)) {
        depth_stage_ = std::make_unique<DepthStage>(matcher_.config());
        stages_.push_back(depth_stage_.get());
    }
    if (adapts_to_noise(matcher_.config().options)) {
        noise_levels_ = std::make_unique<NoiseLevels>();
        stages_.push_back(noise_levels_.get());
    }
    step_names_ = {"capture", "wait-start"};
    for (const StageInfo& stage : matcher_.stages()) {
        first_step_.push_back(step_names_.size());
        step_names_.insert(step_names_.end(), stage.steps.begin(), stage.steps.end());
        if (first_step_.size() == 1) {
            add(StagePlace::before_matching, before_matching_);
        }
    }
    add(StagePlace::after_matching, before_sink_);
    add(StagePlace::record, before_sink_);
    add(StagePlace::served, before_sink_);
    step_names_.emplace_back("wait-between");
}

void Pipeline::add(StagePlace place, std::vector<Added>& to) {
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        if (stages_[i]->place() == place) {
            to.push_back({stages_[i], step_names_.size(), i});
            step_names_.emplace_back(stages_[i]->name());
        }
    }
}

void Pipeline::check(const PipelineConfig& config, const calibration::Rectification& rectification) const {
    if (config.slots < 2 || config.slots > 32) {
        throw std::invalid_argument("pipeline: slots = " + std::to_string(config.slots) + ": allowed is 2 to 32");
    }
    const MatcherConfig& matcher = matcher_.config();
    if (matcher.width != rectification.width || matcher.height != rectification.height) {
        throw std::logic_error("matcher and rectification differ in size");
    }
}

std::string_view Pipeline::thread_name(std::size_t thread) const {
    const std::size_t stages = matcher_.stages().size();
    return thread == 0 ? "capture" : thread <= stages ? to_string(matcher_.stages()[thread - 1].kind) : "publish";
}

/// Ends the pipeline after a failure: frames in flight pass through without work. Called in a catch block. Keeps the
/// exception, not its text, for which there may be no memory.
void Pipeline::fail() noexcept {
    keep_failure();
    failed_.store(true, std::memory_order_relaxed);
    stopping_.store(true, std::memory_order_relaxed);
    source_.interrupt();
}

void Pipeline::keep_failure() noexcept {
    const std::lock_guard lock(mutex_);
    if (!failure_) {
        failure_ = std::current_exception();
    }
}

void Pipeline::capture_loop() {
    name_this_thread(thread_name(0));
    try {
        capture_stage_->run(heartbeats_[0], times_[0], stopping_);
    } catch (...) {
        keep_failure();
    }
    queues_[0]->reserve(heartbeats_[0]);
    finished_[0].store(true, std::memory_order_relaxed);
    queues_[0]->put(nullptr);
}

void Pipeline::stage_loop(std::size_t stage) {
    name_this_thread(thread_name(stage + 1));
    Heartbeat& heartbeat = heartbeats_[stage + 1];
    StageQueue& next = *queues_[stage + 1];
    FrameSlot* slot = nullptr;
    do {
        // Room first, frame second: while the stage waits for room, capture may still replace the frame by a newer one.
        {
            const TraceSpan span(*traced_[stage + 1].track, TraceKind::wait_room, traced_[stage + 1].name);
            next.reserve(heartbeat);
            if (stage == 0 && admission_) {
                admission_->wait(heartbeat);
            }
        }
        slot = take(stage + 1);
        if (slot != nullptr) {
            if (stage == 0) {
                slot->step_times[wait_start] = steady_clock::now() - slot->captured - slot->step_times[0];
                times_[wait_start].record(slot->step_times[wait_start]);
            }
            if (stage == 0 && noise_levels_) {
                const bool anew = (slot->raw.flags & capture::frame_flag_discontinuity) != 0;
                slot->view.noise_level =
                    std::max(matcher_.config().options.noise_level, noise_levels_->next(anew, heartbeat, failed_));
            }
            begins(stage);
            work(stage, *slot);
            ends(stage);
        } else {
            finished_[stage + 1].store(true, std::memory_order_relaxed);
        }
        put(next, slot);
    } while (slot != nullptr);
}

void Pipeline::begins(std::size_t stage) {
    if (admission_) {
        admission_->begins(stage, steady_clock::now());
    }
}

void Pipeline::ends(std::size_t stage) {
    if (admission_) {
        admission_->ends(stage, steady_clock::now());
    }
}

/// Waits for the next slot of the queue in front of a thread.
FrameSlot* Pipeline::take(std::size_t thread) {
    const Traced& traced = traced_[thread];
    FrameSlot* slot = nullptr;
    {
        const TraceSpan span(*traced.track, TraceKind::wait_frame, traced.name);
        slot = queues_[thread - 1]->take(heartbeats_[thread]);
    }
    if (slot != nullptr && slot->queued_ns != 0 && traced.track->on()) {
        traced.track->add({slot->queued_ns, TraceSpan::now_ns(), slot->raw.sequence, traced.name, TraceKind::queued});
    }
    return slot;
}

void Pipeline::put(StageQueue& queue, FrameSlot* slot) {
    if (slot != nullptr) {
        slot->queued_ns = workers_.tracer().on() ? TraceSpan::now_ns() : 0;
    }
    queue.put(slot);
}

/// Records the steps of a stage one after the other: a matcher measures them so.
void Pipeline::trace_steps(std::size_t stage, const FrameSlot& slot, const Period& work) {
    std::int64_t begin = work.begin_ns;
    for (std::size_t i = 0; i < matcher_.stages()[stage].steps.size(); ++i) {
        const std::size_t step = first_step_[stage] + i;
        const std::int64_t end = std::min<std::int64_t>(begin + slot.step_times[step].count(), work.end_ns);
        traced_[stage + 1].track->add({begin, end, slot.raw.sequence, traced_steps_[step], TraceKind::step});
        begin = end;
    }
}

void Pipeline::work(std::size_t stage, FrameSlot& slot) {
    const std::size_t first = first_step_[stage];
    const std::span<std::chrono::nanoseconds> times(&slot.step_times[first], matcher_.stages()[stage].steps.size());
    std::optional<Period> traced_work;
    if (!failed_.load(std::memory_order_relaxed)) {
        try {
            const Traced& traced = traced_[stage + 1];
            std::optional<TraceSpan> waiting;
            waiting.emplace(*traced.track, TraceKind::wait_slot, traced.name, slot.raw.sequence);
            const WorkerPool::ComputeSlot compute_slot(workers_);
            waiting.reset();
            begins(stage);
            trace_work = {slot.raw.sequence, traced.name};
            const TraceSpan span(*traced.track, TraceKind::work, traced.name, slot.raw.sequence);
            matcher_.run(static_cast<int>(stage), depth_stage_ ? without_depth(slot.view) : slot.view, workers_, times);
            if (stage == 0 && slot.raw_eyes.left) {
                copy_luma(slot.raw.image, slot.raw_eyes);
            }
            if (span.on()) {
                traced_work = {span.begin_ns(), TraceSpan::now_ns()};
            }
        } catch (...) {
            fail();
        }
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
        times_[first + i].record(times[i]);
    }
    if (traced_work) {
        trace_steps(stage, slot, *traced_work);  // after they were counted: no trace has more than the status
    }
    if (stage == 0) {
        source_.give_back(slot.raw);
        slot.view.raw.data = nullptr;
        run_added(before_matching_, stage + 1, slot);
    }
}

void Pipeline::publish_loop() {
    const std::size_t thread = heartbeats_.size() - 1;
    name_this_thread(thread_name(thread));
    while (FrameSlot* slot = take(thread)) {
        begins(thread - 1);
        if (!run_added(before_sink_, thread, *slot) || !publish(*slot)) {
            abandoned_.fetch_add(1, std::memory_order_release);
        }
        ends(thread - 1);
        free_slots_->put_finished(slot);
    }
    finished_[thread].store(true, std::memory_order_relaxed);
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
    }
    ended_changed_.notify_all();
}

bool Pipeline::run_added(const std::vector<Added>& stages, std::size_t thread, FrameSlot& slot) {
    for (const Added& added : stages) {
        if (failed_.load(std::memory_order_relaxed)) {
            return false;
        }
        try {
            run_added(added, traced_[thread], slot);
        } catch (...) {
            fail();
        }
    }
    return !failed_.load(std::memory_order_relaxed);
}

void Pipeline::run_added(const Added& added, const Traced& traced, FrameSlot& slot) {
    std::optional<WorkerPool::ComputeSlot> compute_slot;
    if (added.stage->place() != StagePlace::record) {  // a record is small work, for which no frame is to wait
        const TraceSpan waiting(*traced.track, TraceKind::wait_slot, traced.name, slot.raw.sequence);
        compute_slot.emplace(workers_);
    }
    trace_work = {slot.raw.sequence, traced_steps_[added.step]};
    const TraceSpan span(*traced.track, TraceKind::work, traced_steps_[added.step], slot.raw.sequence);
    const auto start = steady_clock::now();
    const calibration::Rectification& used = *slot.rectification;
    added.stage->run({.view = slot.view,
                      .memory = slot.stage_memory[added.memory],
                      .sequence = slot.raw.sequence,
                      .monotonic_ns = slot.raw.monotonic_ns,
                      .discontinuity = (slot.raw.flags & capture::frame_flag_discontinuity) != 0,
                      .f = used.f,
                      .cx = used.cx,
                      .cy = used.cy,
                      .up = slot.up},
                     workers_);
    slot.step_times[added.step] = steady_clock::now() - start;
    times_[added.step].record(slot.step_times[added.step]);
}

bool Pipeline::publish(const FrameSlot& slot) {
    const TraceSpan span(*traced_.back().track, TraceKind::work, traced_.back().name, slot.raw.sequence);
    const auto start = steady_clock::now();
    const auto worked = std::accumulate(slot.step_times.begin(), slot.step_times.end() - 1, steady_clock::duration());
    times_[step_names_.size() - 1].record(std::max(start - slot.captured - worked, steady_clock::duration()));
    // Counted first: a client that has received a frame reads a status that counts it.
    published_.fetch_add(1, std::memory_order_release);
    rate_.tick(start);
    try {
        sink_(slot);
    } catch (...) {
        published_.fetch_sub(1, std::memory_order_relaxed);
        fail();
        return false;
    }
    const auto end = steady_clock::now();
    times_[step_names_.size()].record(end - start);
    times_[step_names_.size() + 1].record(end - slot.captured);
    return true;
}

}  // namespace disparityd::pipeline

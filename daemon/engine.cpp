// SPDX-License-Identifier: Apache-2.0
#include "daemon/engine.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "base/memory_room.h"
#include "base/message_text.h"
#include "base/words.h"
#include "calibration/depth_range.h"
#include "calibration/online/correction_file.h"
#include "capture/camera/camera_controls.h"
#include "capture/source_condition.h"
#include "daemon/configured_products.h"
#include "daemon/configured_source.h"
#include "daemon/core_share.h"
#include "daemon/log.h"
#include "daemon/requests/camera_message.h"
#include "daemon/sensor_message.h"
#include "daemon/totals.h"
#include "kernels/large_buffer.h"
#include "products/frame_info.h"
#include "products/product_planes.h"
#include "proto/text.h"

namespace disparityd::daemon {
namespace {

using std::chrono::steady_clock;

/// After so long without a frame the state is `waiting`.
constexpr std::chrono::seconds silence_limit{2};

MatcherConfig matcher_config(const Config& config, const calibration::Rectification& rectification) {
    return {rectification.width, rectification.height, config.match.options};
}

std::uint32_t to_u32(int value) {
    return static_cast<std::uint32_t>(value);
}

/// Chooses where corrections come from: the background for live sources, the recording or fixed frames for replays.
std::unique_ptr<pipeline::RectificationSchedule> make_schedule(const Config& config,
                                                               const capture::SourceInfo& source) {
    using Follow = pipeline::CorrectedRectification::Follow;
    const calibration::RectifiedGeometry& geometry = config.rectify.geometry;
    const Config::SelfCalibration& wanted = config.self_calibration;
    if (wanted.enabled && wanted.replays && !source.live && source.calibration && !source.calibration->rectified) {
        return std::make_unique<pipeline::CalibratingSchedule>(source, geometry, config.match.options.range,
                                                               pipeline::CalibratingSchedule::Plan{});
    }
    const bool recorded = wanted.enabled && !source.live;
    return std::make_unique<pipeline::CorrectedRectification>(source, geometry,
                                                              recorded ? Follow::recorded : Follow::applied);
}

StreamLayout make_layout(const Config& config, const calibration::Rectification& rectification,
                         const std::vector<ConfiguredStage>& stages) {
    StreamLayout layout;
    layout.geometry = products::geometry_of(rectification, config.match.options.range);
    layout.products = configured_products(config);
    for (const ConfiguredStage& added : stages) {
        layout.record_bytes[static_cast<std::size_t>(added.product)] =
            static_cast<std::uint32_t>(added.stage->bytes_per_frame());
    }
    return layout;
}

std::optional<calibration::DepthRange> depth_range_of(const proto::FrameInfo& geometry, const MatchOptions& options) {
    return calibration::DepthRange::of(geometry.f, geometry.baseline_mm, geometry.disparity_offset, options);
}

/// Returns one sigma of a disparity in 1/256 px where the depth error is served.
std::optional<int> subpixel_error(const Config& config) {
    constexpr int steps_of_px = 256;
    return config.match.depth_error
               ? std::optional(static_cast<int>(std::lround(steps_of_px * config.match.subpixel_error_px)))
               : std::nullopt;
}

/// Returns whether frames that nobody wants are not matched. Of a replay every frame is published.
bool on_demand(const Config& config, bool live) {
    return config.pipeline.on_demand && live && newest_wins(config, live);
}

/// Planes of a frame have one size.
void check_raw(const Config& config, const capture::SourceInfo& source, const calibration::Rectification& rectified) {
    if (config.rectify.raw && (source.eye_width != rectified.width || source.height != rectified.height)) {
        throw std::invalid_argument("rectify.raw: found true with rectified images of " +
                                    base::size_text(rectified.width, rectified.height) + " from a source of " +
                                    base::size_text(source.eye_width, source.height) +
                                    ", allowed where both are equal: leave out rectify.width, height and region");
    }
}

}  // namespace

Engine::Engine(const Config& config, const CarryOver& carry_over, std::function<void(int, int)> progress)
    : config_(config),
      source_(open_configured_source(config, carry_over, std::move(progress), [this] { return wanted_(); })),
      rectifications_(make_schedule(config, source_->info())),
      corrected_(dynamic_cast<pipeline::CorrectedRectification*>(rectifications_.get())),
      calibrating_(dynamic_cast<const pipeline::CalibratingSchedule*>(rectifications_.get())),
      backend_(backend(config.match.backend).name),
      core_locks_(!config.pipeline.cores),
      workers_(configured_workers(config),
               config.pipeline.pin_workers ? pipeline::Pinning::where_allowed : pipeline::Pinning::never, &core_locks_),
      level_(config.scan.enabled ? std::optional(config.scan.options.ground) : std::nullopt, source_->info().live),
      stages_(make_stages(config, rectifications_->factory().width, rectifications_->factory().height, level_.given())),
      layout_(make_layout(config, rectifications_->factory(), stages_)),
      load_(rectifications_->factory().width, rectifications_->factory().height, config.match.options.range.count,
            config.pipeline.cores.value_or(0)),
      geometry_(layout_.geometry),
      to_rectified_{rectifications_->factory().left_rotation, rectifications_->factory().right_rotation} {
    check_raw(config_, source(), rectifications_->factory());
    const std::size_t held = large_memory_held();  // by the engine in use, which goes when this one has begun
    matcher_ = make_matcher(config.match.backend, matcher_config(config, rectifications_->factory()));
    pipeline::PipelineConfig made = pipeline_config();
    if (on_demand(config_, source().live)) {
        made.wanted = [this] { return wants_frame(); };
    }
    if (config_.pipeline.cores) {
        made.budget = &budget_.emplace(*config_.pipeline.cores);
    }
    pipeline_ = std::make_unique<pipeline::Pipeline>(
        made, *source_, *matcher_, workers_, *rectifications_,
        [this](const pipeline::FrameSlot& slot) { publish(slot); },
        [this](const capture::RawFrame& frame) {
            note_activity();
            raw_(frame);
        });
    const std::size_t now_held = large_memory_held();
    const MemoryBounds later = serving_memory(config_, layout_, source());
    base::check_memory_room(now_held - std::min(now_held, held) + later.frames, base::memory_room());
    fault_in_large_memory();
}

/// What the configuration says of the pipeline, but for what may keep frames from beginning.
pipeline::PipelineConfig Engine::pipeline_config() const {
    pipeline::PipelineConfig made{
        .policy = newest_wins(config_, source().live) ? pipeline::Policy::live : pipeline::Policy::replay,
        .slots = config_.pipeline.slots,
        .depth = config_.match.depth,
        .left_colour = config_.rectify.colour,
        .right_colour = config_.rectify.colour && config_.rectify.right,
        .raw = config_.rectify.raw,
        .depth_error = subpixel_error(config_)};
    for (const ConfiguredStage& added : stages_) {
        made.stages.push_back(added.stage.get());
    }
    return made;
}

MemoryBounds Engine::memory() const {
    MemoryBounds bounds = serving_memory(config_, layout_, source());
    bounds.engine = base::resident_memory() + base::memory_reserve;
    return bounds;
}

Engine::~Engine() {
    stop();
}

void Engine::start(Sink sink, pipeline::Pipeline::RawTap raw, std::function<bool()> wanted, std::uint64_t first_index) {
    make_self_calibrator();
    make_measured();
    sink_ = std::move(sink);
    raw_ = std::move(raw);
    wanted_ = std::move(wanted);
    next_index_ = first_index;
    note_activity();
    workers_.claim_cores();
    pipeline_->start();
    started_ = true;
}

void Engine::stop() {
    if (!started_) {
        return;
    }
    stopped_ = true;
    pipeline_->stop();
    workers_.give_cores_back();  // the next engine wants them
    if (source().live) {
        // A camera closes its device in the first call after the interruption: the next engine may open it.
        capture::RawFrame none;
        source_->next(none, steady_clock::now());
    }
}

void Engine::make_measured() {
    measured_ = std::make_unique<MeasuredWatch>(static_cast<int>(layout_.geometry.width),
                                                static_cast<int>(layout_.geometry.height), config_.match.options.range,
                                                source().calibration);
}

void Engine::make_self_calibrator() {
    const capture::SourceInfo& info = source();
    const Config::SelfCalibration& wanted = config_.self_calibration;
    if (!wanted.enabled || !info.live || !info.calibration || info.calibration->rectified) {
        return;
    }
    const std::string folder = resolved_correction_directory(config_);
    self_calibrator_ = std::make_unique<SelfCalibrator>(
        info, *corrected_, config_.match.options.range,
        SelfCalibrator::Settings{std::chrono::seconds(wanted.interval_s),
                                 folder.empty() ? ""
                                                : calibration::correction_path(folder, info.serial, info.eye_width,
                                                                               info.height, *info.calibration)});
}

void Engine::note_activity() {
    last_activity_ns_.store(steady_clock::now().time_since_epoch().count(), std::memory_order_relaxed);
}

/// Capture thread. The self-calibration gets the frames that are due, so that its correction is right for who comes.
bool Engine::wants_frame() {
    const bool wanted = wanted_();
    idle_.store(!wanted, std::memory_order_relaxed);
    return wanted || (self_calibrator_ && self_calibrator_->wants());
}

void Engine::publish(const pipeline::FrameSlot& slot) {
    note_activity();
    PublishedFrame frame;
    frame.published = steady_clock::now();
    // A camera stamps its frames by our clock; the times of a recording are from another day. An offset that moves the
    // stamps on makes no frame younger.
    const std::chrono::microseconds moved_on(std::max(source().time_offset_us, 0));
    frame.captured = source().live
                         ? steady_clock::time_point(std::chrono::nanoseconds(slot.raw.monotonic_ns) - moved_on)
                         : slot.captured;
    frame.taken = slot.captured;
    note_rectification(slot);
    frame.info = geometry_;
    frame.info.publish_index = next_index_++;
    products::put_frame(frame.info, slot,
                        {.synthetic = source().synthetic,
                         .interpolated = config_.match.options.post.interpolate,
                         .first = first_frame_});
    frame.info.age_ns = (frame.published - frame.captured).count();
    std::uint32_t flags = frame.info.flags;
    first_frame_ = false;
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        flags |= stages_[i].flags != nullptr ? stages_[i].flags(slot.stage_memory[i]) : 0U;
    }
    const Plane<const std::uint8_t> scan = record_plane(slot, v1::SCAN);
    trust_.note(flags);
    trust_.note_scan(scan);
    level_.note(scan, frame.published);
    frame.info.flags = flags;
    for (std::size_t i = 0; i < layout_.products.size(); ++i) {
        const v1::Product product = layout_.products[i];
        frame.planes[i] = is_record(product) ? record_plane(slot, product)
                                             : products::product_plane(slot.view, slot.raw_eyes, product);
    }
    sink_(frame);
    if (self_calibrator_) {
        self_calibrator_->offer(slot);
    }
    measured_->offer(slot);
}

/// Returns what the stage of that product has left of a frame; an empty plane where none makes it.
Plane<const std::uint8_t> Engine::record_plane(const pipeline::FrameSlot& slot, v1::Product product) const {
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        if (stages_[i].product == product) {
            const std::span<const std::byte> record = slot.stage_memory[i];
            const int size = static_cast<int>(record.size());
            return {reinterpret_cast<const std::uint8_t*>(record.data()), size, 1, size};
        }
    }
    return {};
}

/// Called by the publish thread. Only it writes geometry_, so it reads it without the lock.
void Engine::note_rectification(const pipeline::FrameSlot& slot) {
    const calibration::Rectification& used = *slot.rectification;
    if (used.calibration_id != geometry_.calibration_id) {
        const std::lock_guard lock(mutex_);
        products::put_geometry(geometry_, used);
        to_rectified_ = {used.left_rotation, used.right_rotation};
        correction_ = slot.raw.correction;
    }
}

const char* to_string(Engine::State state) {
    switch (state) {
        case Engine::State::waiting: return "waiting";
        case Engine::State::running: return "running";
        case Engine::State::idle: return "idle";
        case Engine::State::ended: return "ended";
    }
    return "";
}

Engine::Condition Engine::condition_of(const pipeline::PipelineStatus& status) const {
    if (!status.error.empty()) {
        return {State::ended, "the source failed: " + status.error, true};
    }
    if (status.ended) {
        return {State::ended,
                fmt::format("the source has ended after {}; reload to play it again",
                            base::counted(status.published, "frame")),
                false};
    }
    if (const auto source = source_->condition(); !source.delivering) {
        return {State::waiting, source.detail, false};
    }
    const auto silence = steady_clock::now().time_since_epoch() -
                         std::chrono::nanoseconds(last_activity_ns_.load(std::memory_order_relaxed));
    const bool in_flight =
        status.captured > status.published + status.dropped + status.damaged + status.unwanted + status.over_budget;
    if (!in_flight && silence > silence_limit) {
        return {State::waiting,
                fmt::format("no frame from the source for {:.0f} s", std::chrono::duration<double>(silence).count()),
                false};
    }
    if (idle_.load(std::memory_order_relaxed)) {
        return {State::idle, "nobody wants frames, so none is matched ([pipeline] on_demand)", false};
    }
    return {State::running, {}, false};
}

Engine::Condition Engine::condition() const {
    return started_ ? condition_of(pipeline_->status()) : Condition{State::waiting, "not started", false};
}

void Engine::fill(v1::Status& status) const {
    status.set_source(proto::to_valid_utf8(source().name));
    status.set_synthetic(source().synthetic);
    status.set_method(std::string(disparityd::to_string(config_.match.options.method)));
    const std::string_view substitute = matcher_->substitute();
    status.set_backend(substitute.empty() ? backend_ : std::string(substitute));
    status.set_workers(to_u32(workers_.workers()));
    for (const v1::Product product : layout_.products) {
        status.add_products(product);
    }
    for (const std::string& notice : notices()) {
        status.add_notices(proto::to_valid_utf8(notice));
    }
    {
        const std::lock_guard lock(mutex_);
        *status.mutable_geometry() = to_message(geometry_);
        const auto& calibration = source().calibration;
        // The focal length of the right eye is corrected, too.
        if (auto raw = calibration ? raw_cameras(corrected(*calibration, correction_), to_rectified_) : std::nullopt) {
            *status.mutable_raw_cameras() = std::move(*raw);
        }
        if (calibration && calibration->inertial.is_known()) {
            *status.mutable_inertial_calibration() =
                to_message(calibration->inertial, to_rectified_.left, source().time_offset_us);
        }
    }
    constexpr double far_m = 10;
    if (const auto range = depth_range_of(layout_.geometry, config_.match.options);
        range && std::isfinite(range->nearest_m())) {
        status.set_near_limit_mm(1000 * range->nearest_m());
        const double step_m = range->error_m(far_m, range->step_px());
        status.set_far_step_mm(std::isfinite(step_m) ? 1000 * step_m : 0);
    }
    fill_self_calibration(status);
    if (!started_) {
        return;
    }
    if (const auto found = measured_->finding()) {
        status.mutable_measured()->set_ratio(found->share);
        status.mutable_measured()->set_likely_cause(found->cause);
        status.mutable_measured()->set_near_ratio(found->near);
    }
    if (const auto level = level_.status(steady_clock::now())) {
        *status.mutable_level() = *level;
    }
    if (const auto found = trust_.finding(steady_clock::now())) {
        status.mutable_trust()->set_ratio(found->ratio);
        status.mutable_trust()->set_alarm(found->alarm);
        for (const std::string_view doubt : found->doubts) {
            status.mutable_trust()->add_doubts(std::string(doubt));
        }
    }
    const pipeline::PipelineStatus now = pipeline_->status();
    if (now.noise) {
        status.mutable_measured()->set_noise(now.noise->sigma256 / 256.0);
        status.mutable_measured()->set_noise_level(static_cast<std::uint32_t>(now.noise->level));
    }
    const Condition condition = condition_of(now);
    status.set_state(to_string(condition.state));
    if (const auto scan = trust_.scan_status(); scan && condition.state == State::running) {
        *status.mutable_scan() = *scan;  // an old scan is none
    }
    const std::string trouble = matcher_->trouble();
    status.set_detail(
        proto::to_valid_utf8(condition.detail + (condition.detail.empty() || trouble.empty() ? "" : "; ") + trouble));
    // The meter looks back some seconds: it would still tell of a source that has ended.
    status.set_rate(condition.state == State::ended ? 0 : now.rate);
    status.set_captured(now.captured);
    status.set_published(now.published);
    status.set_dropped(now.dropped);
    status.set_lost(now.lost);
    status.set_damaged(now.damaged);
    status.set_unwanted(now.unwanted);
    status.set_over_budget(now.over_budget);
    if (budget_) {
        status.mutable_budget()->set_cores(budget_->cores());
        status.mutable_budget()->set_used(budget_->used());
    }
    const capture::SourceCondition source = source_->condition();
    if (source.sensors) {
        *status.mutable_sensors() = to_message(*source.sensors);
    }
    if (const auto& camera = source.camera) {
        *status.mutable_camera() = to_message(*camera);
        // The source counts the damaged frames that it does not pass on.
        status.set_damaged(now.damaged + camera->damaged + camera->too_short);
    }
    for (const auto& step : now.steps) {
        v1::StepTime& time = *status.add_steps();
        time.set_name(step.name);
        time.set_count(step.time.count);
        time.set_mean_us(step.time.mean);
        time.set_p50_us(step.time.p50);
        time.set_p90_us(step.time.p90);
        time.set_p99_us(step.time.p99);
        time.set_max_us(step.time.max);
    }
    v1::Totals& totals = *status.mutable_totals();
    totals.set_captured(status.captured());
    totals.set_published(status.published());
    totals.set_dropped(status.dropped());
    totals.set_lost(status.lost());
    totals.set_damaged(status.damaged());
    totals.set_unwanted(status.unwanted());
    totals.set_over_budget(status.over_budget());
    put_steps(totals, now.steps);
}

void Engine::fill_self_calibration(v1::Status& status) const {
    if (self_calibrator_) {
        self_calibrator_->fill(*status.mutable_self_calibration());
    } else if (calibrating_ != nullptr) {
        put_correction(*status.mutable_self_calibration(), calibrating_->corrected().state());
        status.mutable_self_calibration()->set_estimating(true);
        status.mutable_self_calibration()->set_detail("estimated at fixed frames of the replay");
    } else if (corrected_ != nullptr && corrected_->state().correction.any()) {
        put_correction(*status.mutable_self_calibration(), corrected_->state());
        status.mutable_self_calibration()->set_detail("as recorded");
    }
}

std::vector<std::string> Engine::notices() const {
    std::vector<std::string> notices = source_->condition().notices;
    if (source().synthetic) {
        notices.emplace_back(synthetic_notice);
    }
    if (std::string note = on_demand_note(); !note.empty()) {
        notices.push_back(std::move(note));
    }
    const auto placement = workers_.placement();
    if (config_.pipeline.pin_workers && !placement.pinned) {
        notices.push_back("workers are " + placement.text);
    }
    for (const ConfiguredStage& added : stages_) {
        if (std::string notice = added.stage->notice(); !notice.empty()) {
            notices.push_back(std::move(notice));
        }
    }
    const std::lock_guard lock(mutex_);
    if (!memory_notice_.empty()) {
        notices.push_back(memory_notice_);
    }
    if (!load_notice_.empty()) {
        notices.push_back(load_notice_);
    }
    return notices;
}

std::string Engine::on_demand_note() const {
    return config_.pipeline.on_demand && !on_demand(config_, source().live)
               ? "[pipeline] on_demand has no effect: every frame of a replay, or with [source] policy \"replay\", is "
                 "matched"
               : "";
}

bool Engine::source_changed() const {
    return source_->condition().reopen;
}

std::string Engine::camera_port() const {
    const auto camera = source_->condition().camera;
    return camera ? camera->port : "";
}

std::vector<capture::CameraControl> Engine::control_camera(const std::vector<capture::CameraSetting>& settings) {
    return source_->set_camera_controls(settings);
}

v1::LevelStatus Engine::take_level(const v1::GiveLevel& message, std::uint64_t client) {
    const auto now = steady_clock::now();
    level_.take(message, client, now);
    return level_.status(now).value_or(v1::LevelStatus());
}

std::string Engine::workers() const {
    const int count = workers_.workers();
    return fmt::format("{}{}, {}", base::counted(static_cast<std::uint64_t>(count), "worker"),
                       budget_ ? fmt::format(" with a budget of {} cores", budget_->cores()) : "",
                       workers_.placement().text);
}

std::string Engine::core_share() const {
    return core_share_note(config_, workers_.workers(), newest_wins(config_, source().live));
}

std::string Engine::distances() const {
    if (const auto range = depth_range_of(layout_.geometry, config_.match.options)) {
        return range->text();
    }
    const bool may_come = source().live && !source_->condition().delivering;  // with the camera
    return may_come ? "" : calibration::unknown_depth_range;
}

std::string Engine::stuck_stage(std::chrono::milliseconds limit) const {
    return started_ ? pipeline_->stuck_stage(limit) : std::string();
}

}  // namespace disparityd::daemon

// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/frame_chain.h"

#include <chrono>
#include <utility>

#include "base/memory_room.h"
#include "kernels/large_buffer.h"
#include "kernels/stage_notes.h"
#include "tools/command_line/interrupt.h"
#include "tools/ctl/distance_limit_arguments.h"

namespace disparityd::tools {

FrameChain::FrameChain(const ProcessArguments& arguments, const MatchOptions& options,
                       const std::optional<ScanOptions>& scan, capture::FrameSource& source,
                       pipeline::PipelineConfig config, pipeline::WorkerPool& workers)
    : arguments_(arguments),
      options_(options),
      scan_options_(scan),
      source_(source),
      config_(std::move(config)),
      workers_(workers) {
    make_schedule(source.info());
    matcher_ = make_matcher(arguments.backend, {rectification().width, rectification().height, options_});
    add_stages();
}

/// Chooses what rectifies each frame: the corrections that --self-calibrate estimates, those of the recording, or the
/// calibration alone.
void FrameChain::make_schedule(const capture::SourceInfo& info) {
    const calibration::RectifiedGeometry geometry = geometry_of(arguments_);
    if (arguments_.self_calibrate) {
        auto estimating = std::make_unique<pipeline::CalibratingSchedule>(info, geometry, options_.range,
                                                                          pipeline::CalibratingSchedule::Plan{});
        calibrating_ = estimating.get();
        schedule_ = std::move(estimating);
        return;
    }
    const auto follow = arguments_.no_self_calibration ? pipeline::CorrectedRectification::Follow::applied
                                                       : pipeline::CorrectedRectification::Follow::recorded;
    schedule_ = std::make_unique<pipeline::CorrectedRectification>(info, geometry, follow);
}

/// What makes no record is last: records are found by their place in the list.
void FrameChain::add_stages() {
    const int width = rectification().width;
    const int height = rectification().height;
    const ImageMask mask = mask_of(arguments_, rectification());
    const auto notes = scan_options_ ? std::make_shared<StageNotes>() : nullptr;
    config_.stages.clear();
    if (scan_options_) {
        scan_.emplace(width, height, options_.range, *scan_options_, nullptr, mask, notes);
        config_.stages.push_back(&*scan_);
    }
    if (!arguments_.no_trust) {
        trust_.emplace(width, height, trust::TrustOptions{}, mask.pixels(), notes);
        config_.stages.push_back(&*trust_);
    }
    if (!mask.empty()) {
        mask_.emplace(mask, options_.range);
        config_.stages.push_back(&*mask_);
    }
    if (arguments_.temporal) {
        temporal_.emplace(width, height);
        config_.stages.push_back(&*temporal_);
    }
    if (const pipeline::DistanceLimits limits = arguments_.distances.limits(); limits.any()) {
        limits_.emplace(
            limits, options_.range,
            pipeline::DistanceLimitNames{DistanceLimitArguments::min_option, DistanceLimitArguments::max_option});
        config_.stages.push_back(&*limits_);
    }
}

pipeline::Pipeline& FrameChain::connect(pipeline::Pipeline::Sink sink, pipeline::Pipeline::RawTap raw_tap) {
    pipeline_.emplace(config_, source_, *matcher_, workers_, *schedule_, std::move(sink), std::move(raw_tap));
    base::check_memory_room(large_memory_held(), base::memory_room());
    return *pipeline_;
}

std::string FrameChain::names_of_dependent() const {
    std::string names;
    const auto add = [&names](std::string_view name) { names.append(names.empty() ? "" : ", ").append(name); };
    for (const AddedStage* stage : config_.stages) {
        if (stage->depends_on_earlier_frames()) {
            add(stage->name());
        }
    }
    if (options_.adaptive_noise) {
        add("adaptive-noise");
    }
    if (arguments_.self_calibrate) {
        add("self-calibrate");
    }
    return names;
}

trust::Verdict FrameChain::verdict_of(const pipeline::FrameSlot& slot) const {
    return trust_ ? trust::verdict_of(slot.stage_memory[scan_ ? 1 : 0]) : trust::Verdict{};
}

std::uint32_t FrameChain::flags_of(const pipeline::FrameSlot& slot) const {
    return trust_ ? trust::flags_of(slot.stage_memory[scan_ ? 1 : 0]) : 0;
}

std::span<const std::byte> FrameChain::scan_bytes_of(const pipeline::FrameSlot& slot) const {
    return scan_ ? std::span<const std::byte>(slot.stage_memory.front()) : std::span<const std::byte>();
}

std::vector<std::string> FrameChain::notes() const {
    std::vector<std::string> notes;
    for (std::string note : {matcher_->trouble(), limits_ ? limits_->notice() : std::string()}) {
        if (!note.empty()) {
            notes.push_back(std::move(note));
        }
    }
    return notes;
}

void run_to_end(pipeline::Pipeline& pipeline, const std::function<void(const pipeline::PipelineStatus&)>& show) {
    pipeline.start();
    while (!pipeline.wait_until_ended(std::chrono::milliseconds(50)) && !interrupted()) {
        show(pipeline.status());
    }
    pipeline.stop();
}

}  // namespace disparityd::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/matcher.h"
#include "obstacles/mask_stage.h"
#include "obstacles/scan_stage.h"
#include "pipeline/calibrating_schedule.h"
#include "pipeline/distance_limits.h"
#include "pipeline/pipeline.h"
#include "pipeline/rectification_schedule.h"
#include "pipeline/temporal_stage.h"
#include "tools/ctl/processing/process_arguments.h"
#include "trust/trust_stage.h"

namespace disparityd::tools {

/// What the frames of a source go through by the options of the command line: rectification, matcher, added stages, and
/// the pipeline that runs them. One thread makes it and runs the pipeline.
class FrameChain {
public:
    /// Source, workers and arguments outlive it. `config` says what is made beside disparity and confidence; its stages
    /// are filled in here. Throws std::invalid_argument when the user must change something, std::runtime_error when
    /// the system refuses.
    FrameChain(const ProcessArguments& arguments, const MatchOptions& options, const std::optional<ScanOptions>& scan,
               capture::FrameSource& source, pipeline::PipelineConfig config, pipeline::WorkerPool& workers);
    FrameChain(const FrameChain&) = delete;
    FrameChain& operator=(const FrameChain&) = delete;

    /// Makes the pipeline, once. Throws as its constructor, and base::check_memory_room() does.
    pipeline::Pipeline& connect(pipeline::Pipeline::Sink sink, pipeline::Pipeline::RawTap raw_tap = {});

    /// Returns the names of what makes a frame depend on those before; empty: nothing does.
    std::string names_of_dependent() const;

    const Matcher& matcher() const { return *matcher_; }
    const calibration::Rectification& rectification() const { return schedule_->factory(); }
    const pipeline::CalibratingSchedule* calibrating() const { return calibrating_; }  ///< null: nothing is estimated

    /// What the stages have left of a frame. scan_bytes_of() is empty where no scan is made.
    trust::Verdict verdict_of(const pipeline::FrameSlot& slot) const;  ///< all 0 where nothing judges
    std::uint32_t flags_of(const pipeline::FrameSlot& slot) const;     ///< the same as bits of the frame's flags
    std::span<const std::byte> scan_bytes_of(const pipeline::FrameSlot& slot) const;

    /// Returns notes for the user about what the run has shown: trouble of the back end, limits without effect.
    std::vector<std::string> notes() const;

private:
    void make_schedule(const capture::SourceInfo& info);
    void add_stages();

    const ProcessArguments& arguments_;
    const MatchOptions options_;
    const std::optional<ScanOptions> scan_options_;
    capture::FrameSource& source_;
    pipeline::PipelineConfig config_;
    pipeline::WorkerPool& workers_;
    std::unique_ptr<pipeline::RectificationSchedule> schedule_;
    const pipeline::CalibratingSchedule* calibrating_ = nullptr;  ///< the same where it estimates
    std::unique_ptr<Matcher> matcher_;
    std::optional<ScanStage> scan_;
    std::optional<trust::TrustStage> trust_;
    std::optional<MaskStage> mask_;
    std::optional<pipeline::TemporalStage> temporal_;
    std::optional<pipeline::DistanceLimitStage> limits_;
    std::optional<pipeline::Pipeline> pipeline_;  ///< the last: its threads use all others
};

/// Runs a pipeline to its end, or to the end of the frames in flight after Ctrl-C. `show` is called some twenty times a
/// second with what it has done.
void run_to_end(pipeline::Pipeline& pipeline, const std::function<void(const pipeline::PipelineStatus&)>& show);

}  // namespace disparityd::tools

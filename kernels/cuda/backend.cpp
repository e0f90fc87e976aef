// SPDX-License-Identifier: Apache-2.0
#include "kernels/cuda/backend.h"

#include <stdexcept>

#include "kernels/cuda/device.h"
#include "kernels/cuda/match_stage.h"
#include "kernels/cuda/rectify_stage.h"
#include "kernels/frame_stages.h"
#include "kernels/near_guard.h"
#include "kernels/stage_table.h"
#include "kernels/step_clock.h"

namespace disparityd::cuda {

namespace {

class CudaMatcher final : public Matcher {
public:
    explicit CudaMatcher(const MatcherConfig& config)
        : config_(config),
          stages_{{{StageKind::rectify, rectify_steps}, MatchStage::info(config.options.method)}},
          rectify_(config.width, config.height),
          match_(config) {}

    const MatcherConfig& config() const override { return config_; }
    // What travels from stage to stage are the planes of the rectified pair.
    std::size_t scratch_bytes() const override { return 0; }
    std::span<const StageInfo> stages() const override { return stages_; }
    bool computes_on_workers() const override { return false; }

    void run(int stage, const FrameView& frame, Parallel& workers,
             std::span<std::chrono::nanoseconds> step_times) override {
        if (stage == 0) {
            StepClock clock(step_times);
            rectify_.run(frame, workers);
            clock.next();
        } else {
            match_.run(frame, workers, step_times);
        }
    }

private:
    MatcherConfig config_;
    std::array<StageInfo, 2> stages_;
    RectifyStage rectify_;
    MatchStage match_;
};

}  // namespace

std::string unavailable_because() {
    return device_problem();
}

bool available() {
    return device_problem().empty();
}

std::unique_ptr<Matcher> create(const MatcherConfig& config) {
    checked(config);
    const std::string problem = device_problem();
    if (!problem.empty()) {
        throw std::runtime_error("back end cuda: " + problem);
    }
    // Shrinking runs on the processor, which has the pair: the rectified frames are in its memory for all who want
    // them.
    return with_near_guard(config, fastest_frame_steps(),
                           [](const MatcherConfig& made) { return std::make_unique<CudaMatcher>(made); });
}

}  // namespace disparityd::cuda

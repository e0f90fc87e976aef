// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "kernels/added_stage.h"
#include "kernels/frame_stages.h"
#include "kernels/parallel_rows.h"
#include "kernels/steps.h"

namespace disparityd::pipeline {

/// Computes depth and depth error, step 13 of docs/algorithm.md, from the disparities that stages after matching leave:
/// in place of the matcher, with its bytes.
class DepthStage final : public AddedStage {
public:
    explicit DepthStage(const MatcherConfig& config) : range_(config.options.range), height_(config.height) {}

    std::string_view name() const override { return "depth"; }
    StagePlace place() const override { return StagePlace::after_matching; }
    bool depends_on_earlier_frames() const override { return false; }
    void run(const StageFrame& frame, Parallel& workers) override {
        parallel_rows(height_, workers,
                      [&](Rows rows) { write_depth(fastest_frame_steps(), range_, frame.view, rows); });
    }

private:
    DisparityRange range_;
    int height_;
};

}  // namespace disparityd::pipeline

// SPDX-License-Identifier: Apache-2.0
#include "pipeline/temporal_stage.h"

#include <algorithm>
#include <cstddef>

#include "kernels/parallel_rows.h"

namespace disparityd::pipeline {
namespace {

constexpr std::int64_t longest_gap_ns = 300'000'000;

/// A mean has more bits than a disparity, in 1/16 px: rounding would stop it before it is there.
constexpr int mean_bits = 2;
/// A pixel that was not measured. Means are -16448 .. 32752: none of them agrees with it, nor with what 16 bits make of
/// the difference.
constexpr std::int16_t unmeasured = -24000;
constexpr int agreement = 64;   // 1 px
constexpr int most_moved = 16;  // 1/4 px
constexpr int eighths_before = 5;

/// 16 bits, so that a vector holds many. Sums that do not fit are those of disparities that do not agree.
constexpr std::int16_t word(int value) {
    return static_cast<std::int16_t>(value);
}

/// Returns the mean for a disparity in 1/64 px.
std::int16_t next_mean(std::int16_t now, std::int16_t before) {
    const std::int16_t away = word(before - now);
    const std::int16_t share = word(word(away * eighths_before + 4) >> 3);
    const std::int16_t moved = std::clamp(share, word(-most_moved), word(most_moved));
    const bool agrees = std::max(away, word(-away)) <= agreement;
    return word(now + (agrees ? moved : word(0)));
}

/// Branches would keep compilers from taking many pixels at a time.
void average_row(std::int16_t* disparity, const std::uint8_t* confidence, std::int16_t* means, int width) {
    for (int x = 0; x < width; ++x) {
        const std::int16_t mean = next_mean(word(disparity[x] << mean_bits), means[x]);
        const std::int16_t rounded = word(word(mean + 2) >> mean_bits);
        const bool measured = confidence[x] > 0;
        means[x] = measured ? mean : unmeasured;
        disparity[x] = measured ? rounded : disparity[x];
    }
}

}  // namespace

TemporalStage::TemporalStage(int width, int height)
    : means_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), unmeasured) {}

void TemporalStage::run(const StageFrame& frame, Parallel& workers) {
    const std::int64_t gap_ns = frame.monotonic_ns - before_ns_;
    if (frame.discontinuity || gap_ns <= 0 || gap_ns > longest_gap_ns) {
        std::fill(means_.begin(), means_.end(), unmeasured);
    }
    before_ns_ = frame.monotonic_ns;
    parallel_rows(frame.view.disparity.height, workers, [&](Rows rows) { average(frame.view, rows); });
}

void TemporalStage::average(const FrameView& frame, Rows rows) {
    const int width = frame.disparity.width;
    for (int y = rows.first; y < rows.last; ++y) {
        average_row(frame.disparity.row(y), frame.confidence.row(y),
                    means_.data() + static_cast<std::ptrdiff_t>(y) * width, width);
    }
}

}  // namespace disparityd::pipeline

// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/fair_opencv.h"

#include <algorithm>
#include <cstddef>

#include "kernels/reference/steps.h"

namespace disparityd::eval {
namespace {

struct Padding {
    int left = 0;
    int right = 0;
};

/// Columns of the left image whose candidates reach beyond the right image.
Padding padding_for(DisparityRange range) {
    return {std::max(range.first + range.count, 0), std::max(-range.first, 0)};
}

/// A rectified pair matched in every column.
MatcherResult match_padded(OpencvMethod method, DisparityRange range, const cv::Mat& left, const cv::Mat& right,
                           int threads, int repeat) {
    const Padding padding = padding_for(range);
    cv::Mat padded_left, padded_right;
    cv::copyMakeBorder(left, padded_left, 0, 0, padding.left, padding.right, cv::BORDER_REPLICATE);
    cv::copyMakeBorder(right, padded_right, 0, 0, padding.left, padding.right, cv::BORDER_REPLICATE);
    const MatcherResult padded = run_opencv(method, range, padded_left, padded_right, threads, repeat);
    MatcherResult result{left.cols, left.rows, range, {}, padded.ms};
    for (int y = 0; y < left.rows; ++y) {
        const std::int16_t* row = padded.map().d16.row(y) + padding.left;
        result.d16.insert(result.d16.end(), row, row + left.cols);
    }
    return result;
}

/// Whole-pixel winners of the right image; range.first - 1 where there is none.
std::vector<std::int16_t> right_winners(OpencvMethod method, DisparityRange range, const cv::Mat& left,
                                        const cv::Mat& right, int threads) {
    cv::Mat mirrored_left, mirrored_right;
    cv::flip(left, mirrored_left, 1);
    cv::flip(right, mirrored_right, 1);
    std::vector<std::int16_t> winners = match_padded(method, range, mirrored_right, mirrored_left, threads, 1).d16;
    for (auto row = winners.begin(); row != winners.end(); row += left.cols) {
        std::reverse(row, row + left.cols);
    }
    std::transform(winners.begin(), winners.end(), winners.begin(), [range](std::int16_t d16) {
        return static_cast<std::int16_t>(d16 == invalid_disparity(range) ? range.first - 1 : (d16 + 8) >> 4);
    });
    return winners;
}

}  // namespace

MatcherResult run_opencv_fairly(OpencvMethod method, DisparityRange range, const cv::Mat& left, const cv::Mat& right,
                                int threads, int repeat) {
    MatcherResult matched = match_padded(method, range, left, right, threads, repeat);
    const std::vector<std::int16_t> seen_right = right_winners(method, range, left, right, threads);
    const int width = left.cols;
    const int height = left.rows;
    MatcherResult result = matched;
    const Plane<std::int16_t> disparity{result.d16.data(), width, height, width};
    constexpr int median_size = 3;
    reference::median(matched.map().d16, invalid_disparity(range), median_size, disparity, {0, height});
    std::vector<std::byte> scratch(reference::interpolate_scratch(width, height));
    reference::interpolate(disparity, {seen_right.data(), width, height, width}, range, scratch);
    return result;
}

}  // namespace disparityd::eval

// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/opencv_matcher.h"

#include <algorithm>
#include <chrono>
#include <cstddef>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "kernels/matcher.h"
#include "kernels/reference/steps.h"
#include "tools/eval/means.h"

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

using std::chrono::steady_clock;

cv::Ptr<cv::StereoMatcher> create(OpencvMethod method, DisparityRange range) {
    if (method == OpencvMethod::bm) {
        constexpr int block = 9;
        const auto bm = cv::StereoBM::create(range.count, block);
        bm->setPreFilterCap(31);
        bm->setTextureThreshold(10);
        bm->setUniquenessRatio(15);
        return bm;
    }
    constexpr int block = 3;
    const int mode = method == OpencvMethod::sgbm_hh ? cv::StereoSGBM::MODE_HH : cv::StereoSGBM::MODE_SGBM_3WAY;
    const auto sgbm = cv::StereoSGBM::create(range.first, range.count, block, 8 * block * block, 32 * block * block);
    sgbm->setPreFilterCap(63);
    sgbm->setUniquenessRatio(10);
    sgbm->setMode(mode);
    return sgbm;
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

const std::vector<OpencvMethod>& opencv_methods() {
    static const std::vector<OpencvMethod> all{OpencvMethod::bm, OpencvMethod::sgbm_hh, OpencvMethod::sgbm_3way};
    return all;
}

std::string name(OpencvMethod method) {
    switch (method) {
        case OpencvMethod::bm: return "StereoBM";
        case OpencvMethod::sgbm_hh: return "StereoSGBM HH";
        case OpencvMethod::sgbm_3way: return "StereoSGBM 3WAY";
    }
    return {};
}

cv::Mat grey(const cv::Mat& image) {
    cv::Mat result = image;
    if (image.channels() == 3) {
        cv::cvtColor(image, result, cv::COLOR_BGR2GRAY);
    }
    return result;
}

cv::Ptr<cv::StereoMatcher> create_opencv(OpencvMethod method, DisparityRange range) {
    const auto matcher = create(method, range);
    matcher->setMinDisparity(range.first);
    matcher->setSpeckleWindowSize(100);
    matcher->setSpeckleRange(32);
    matcher->setDisp12MaxDiff(1);
    return matcher;
}

MatcherResult run_opencv(OpencvMethod method, DisparityRange range, const cv::Mat& left, const cv::Mat& right,
                         int threads, int repeat) {
    cv::setNumThreads(threads);
    const auto matcher = create_opencv(method, range);
    const cv::Mat left_grey = grey(left), right_grey = grey(right);
    cv::Mat disparity;
    std::vector<double> times;
    for (int i = 0; i < repeat; ++i) {
        const auto start = steady_clock::now();
        matcher->compute(left_grey, right_grey, disparity);
        times.push_back(std::chrono::duration<double, std::milli>(steady_clock::now() - start).count());
    }
    MatcherResult result{left.cols, left.rows, range, {}, median(times)};
    result.d16.assign(disparity.begin<std::int16_t>(), disparity.end<std::int16_t>());
    // OpenCV gives everything below the range as rejected.
    const int lowest = range.first * 16;
    std::replace_if(
        result.d16.begin(), result.d16.end(), [lowest](std::int16_t d16) { return d16 < lowest; },
        invalid_disparity(range));
    return result;
}

}  // namespace disparityd::eval

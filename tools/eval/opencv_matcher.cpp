// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/opencv_matcher.h"

#include <algorithm>
#include <chrono>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "kernels/matcher.h"
#include "tools/eval/median.h"

namespace disparityd::eval {
namespace {

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

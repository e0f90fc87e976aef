// SPDX-License-Identifier: Apache-2.0
//
// A camera that has aged, measured by a matcher that is not ours.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/online/self_calibration.h"
#include "kernels/matcher.h"
#include "tests/calibration/online/rectified_pair.h"
#include "tests/data_folder.h"

namespace disparityd::calibration {
namespace {

namespace fs = std::filesystem;

fs::path zed_folder() {
    return disparityd::test::data_folder() / "zed";
}

cv::Mat as_matrix(const test::Grey& image) {
    return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
}

/// What SIFT sees of a rectified pair, outliers beyond 5 px of the median row difference left out.
struct Measured {
    double offset = 0;  ///< median of left y - right y
    double error = 0;   ///< median of its absolute value
    struct Point {
        cv::Point2f left;
        double disparity;
    };
    std::vector<Point> points;
};

Measured measure(const cv::Mat& left, const cv::Mat& right) {
    const auto sift = cv::SIFT::create(4000);
    std::vector<cv::KeyPoint> left_points;
    std::vector<cv::KeyPoint> right_points;
    cv::Mat left_words;
    cv::Mat right_words;
    sift->detectAndCompute(left, {}, left_points, left_words);
    sift->detectAndCompute(right, {}, right_points, right_words);
    std::vector<std::vector<cv::DMatch>> nearest;
    cv::BFMatcher(cv::NORM_L2).knnMatch(left_words, right_words, nearest, 2);
    std::vector<double> rows;
    std::vector<Measured::Point> points;
    for (const auto& match : nearest) {
        if (match.size() == 2 && match[0].distance < 0.7F * match[1].distance) {
            const cv::Point2f at = left_points[static_cast<std::size_t>(match[0].queryIdx)].pt;
            const cv::Point2f difference = at - right_points[static_cast<std::size_t>(match[0].trainIdx)].pt;
            rows.push_back(difference.y);
            points.push_back({at, difference.x});
        }
    }
    const double centre = median(rows);
    Measured measured;
    std::vector<double> kept;
    std::vector<double> sizes;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (std::abs(rows[i] - centre) <= 5) {
            kept.push_back(rows[i]);
            sizes.push_back(std::abs(rows[i]));
            measured.points.push_back(points[i]);
        }
    }
    measured.offset = median(kept);
    measured.error = median(sizes);
    return measured;
}

/// How the disparities of points that both have seen differ: the median, and of how many.
std::pair<double, std::size_t> moved(const Measured& before, const Measured& after) {
    std::vector<double> differences;
    for (const Measured::Point& now : after.points) {
        for (const Measured::Point& once : before.points) {
            if (cv::norm(now.left - once.left) < 1.5 && std::abs(now.disparity - once.disparity) < 5) {
                differences.push_back(now.disparity - once.disparity);
                break;
            }
        }
    }
    return {median(differences), differences.size()};
}

/// How much SGM finds, and how much of it the right image confirms to a pixel.
struct Matched {
    double density = 0;     ///< part of the pixels with a disparity
    double consistent = 0;  ///< part of the pixels where left and right agree
};

struct DisparityImage {
    std::vector<std::int16_t> values;
    std::int16_t invalid = 0;
};

DisparityImage disparities(const test::Grey& left, const test::Grey& right, bool checked) {
    MatchOptions options = default_options(Method::sgm, {0, 128});
    options.post.left_right_check = checked;
    const auto matcher = make_matcher("cpu", {left.width, left.height, options});
    const std::size_t pixels = left.pixels.size();
    DisparityImage result{std::vector<std::int16_t>(pixels), invalid_disparity(options.range)};
    std::vector<std::uint8_t> confidence(pixels);
    const auto scratch = std::make_unique<std::byte[]>(matcher->scratch_bytes() + 64);
    void* aligned = scratch.get();
    std::size_t space = matcher->scratch_bytes() + 64;
    std::align(64, matcher->scratch_bytes(), aligned, space);
    FrameView view;
    test::Grey left_copy = left;
    test::Grey right_copy = right;
    view.left = left_copy.plane();
    view.right = right_copy.plane();
    view.disparity = {result.values.data(), left.width, left.height, left.width};
    view.confidence = {confidence.data(), left.width, left.height, left.width};
    view.scratch = {static_cast<std::byte*>(aligned), matcher->scratch_bytes()};
    Serial serial;
    match_pair(*matcher, view, serial);
    return result;
}

test::Grey mirrored(const test::Grey& image) {
    test::Grey result = image;
    for (int y = 0; y < image.height; ++y) {
        std::reverse(result.pixels.begin() + y * image.width, result.pixels.begin() + (y + 1) * image.width);
    }
    return result;
}

Matched match_densely(const test::Grey& left, const test::Grey& right, const DisparityImage& checked) {
    const DisparityImage plain = disparities(left, right, false);
    const DisparityImage from_right = disparities(mirrored(right), mirrored(left), false);
    const auto pixels = static_cast<double>(left.pixels.size());
    std::size_t found = 0;
    std::size_t agree = 0;
    for (int y = 0; y < left.height; ++y) {
        for (int x = 0; x < left.width; ++x) {
            const std::ptrdiff_t row = std::ptrdiff_t{y} * left.width;
            found += checked.values[static_cast<std::size_t>(row + x)] != checked.invalid ? 1 : 0;
            const int d16 = plain.values[static_cast<std::size_t>(row + x)];
            const int there = x - (d16 + 8) / 16;
            if (d16 != plain.invalid && there >= 0) {
                const int back = from_right.values[static_cast<std::size_t>(row + left.width - 1 - there)];
                agree += back != from_right.invalid && std::abs(back - d16) <= 16 ? 1 : 0;
            }
        }
    }
    return {static_cast<double>(found) / pixels, static_cast<double>(agree) / pixels};
}

class ZedPair : public testing::Test {
protected:
    void SetUp() override {
        const fs::path pair = zed_folder() / "indoor_zed_sn21531_hd720_15";
        if (!fs::exists(pair / "left_raw.png")) {
            GTEST_SKIP() << "no pair at " << pair << "; DISPARITYD_DATA names the folder";
        }
        left_ = cv::imread((pair / "left_raw.png").string(), cv::IMREAD_GRAYSCALE);
        right_ = cv::imread((pair / "right_raw.png").string(), cv::IMREAD_GRAYSCALE);
        sdk_left_ = cv::imread((pair / "left_rect.png").string(), cv::IMREAD_GRAYSCALE);
        sdk_right_ = cv::imread((pair / "right_rect.png").string(), cv::IMREAD_GRAYSCALE);
        cv::hconcat(left_, right_, side_by_side_);
        factory_ = read_calibration((zed_folder() / "SN21531_derived.conf").string(), left_.cols, left_.rows);
    }

    RawImage raw() const {
        return {side_by_side_.data, PixelFormat::grey8, left_.cols, left_.rows,
                static_cast<std::ptrdiff_t>(side_by_side_.step[0])};
    }

    cv::Mat left_, right_, sdk_left_, sdk_right_, side_by_side_;
    StereoCalibration factory_;
};

TEST_F(ZedPair, SelfCalibrationRemovesTheVerticalErrorAndLeavesTheDepth) {
    const test::Pair before = test::rectified(raw(), factory_);
    SelfCalibration estimate(factory_);
    estimate.add(before.left.plane(), before.right.plane(), before.used, {}, {0, 128});
    const SelfCalibrationResult result = estimate.solve();
    ASSERT_TRUE(result.accepted) << result.reason;

    const test::Pair after = test::rectified(raw(), corrected(factory_, result.correction));
    const Measured sdk = measure(sdk_left_, sdk_right_);
    const Measured by_factory = measure(as_matrix(before.left), as_matrix(before.right));
    const Measured corrected = measure(as_matrix(after.left), as_matrix(after.right));
    EXPECT_LT(by_factory.offset, -1);
    EXPECT_LT(std::abs(corrected.offset), 0.1);
    EXPECT_LE(corrected.error, sdk.error + 0.05);
    const auto [by_sift, points] = moved(by_factory, corrected);
    EXPECT_GT(points, 50U);
    EXPECT_LT(std::abs(by_sift), 0.1);

    const DisparityImage was = disparities(before.left, before.right, true);
    const DisparityImage is = disparities(after.left, after.right, true);
    std::vector<double> differences;
    for (std::size_t i = 0; i < is.values.size(); ++i) {
        if (was.values[i] != was.invalid && is.values[i] != is.invalid) {
            differences.push_back((is.values[i] - was.values[i]) / 16.0);
        }
    }
    EXPECT_LT(std::abs(median(differences)), 0.1);
    const Matched dense_before = match_densely(before.left, before.right, was);
    const Matched dense_after = match_densely(after.left, after.right, is);
    std::printf(
        "vertical offset (median of its size), SIFT: factory %.2f (%.2f), corrected %.2f (%.2f), SDK %.2f (%.2f) px\n",
        by_factory.offset, by_factory.error, corrected.offset, corrected.error, sdk.offset, sdk.error);
    std::printf("disparity moves by %.3f px (SIFT, %zu points), %.3f px (SGM, %zu pixels)\n", by_sift, points,
                median(differences), differences.size());
    std::printf("SGM: density %.1f %% -> %.1f %%, consistent from left to right %.1f %% -> %.1f %%\n",
                100 * dense_before.density, 100 * dense_after.density, 100 * dense_before.consistent,
                100 * dense_after.consistent);
    EXPECT_GT(dense_after.density, dense_before.density);
    EXPECT_GT(dense_after.consistent, dense_before.consistent);
}

}  // namespace
}  // namespace disparityd::calibration

// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/made_causes.h"

#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "calibration/rectification.h"
#include "capture/frame_source.h"
#include "kernels/large_buffer.h"
#include "kernels/matcher.h"
#include "kernels/parallel.h"

namespace disparityd::test {
namespace {

Plane<std::uint8_t> plane_of(cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

void rectify(const RawImage& raw, RenderedPair& pair, cv::Size size) {
    const auto rectification = calibration::make_rectification(pair.calibration, size.width, size.height, {});
    const Rectifier rectifier = rectification.rectifier();
    const auto matcher = make_matcher("cpu", {size.width, size.height, default_options(Method::sad, {0, 16})});
    const LargeBuffer scratch(matcher->scratch_bytes());
    pair.left.create(size, CV_8UC1);
    pair.right.create(size, CV_8UC1);
    FrameView view;
    view.raw = raw;
    view.rectifier = &rectifier;
    view.left = plane_of(pair.left);
    view.right = plane_of(pair.right);
    view.scratch = {scratch.data(), scratch.size()};
    std::vector<std::chrono::nanoseconds> times(matcher->stages()[0].steps.size());
    Serial workers;
    matcher->run(0, view, workers, times);
}

/// Whole numbers of a seed, the same on every machine.
class Draw {
public:
    explicit Draw(unsigned seed) : random_(seed) {}
    int of(int first, int last) {
        return first + static_cast<int>(random_() % static_cast<unsigned>(last - first + 1));
    }
    cv::RNG noise() { return cv::RNG(random_()); }

private:
    std::mt19937 random_;
};

void add_noise(cv::Mat& image, double sigma, Draw& draw) {
    cv::Mat noise(image.size(), CV_32F), sum;
    cv::RNG random = draw.noise();
    random.fill(noise, cv::RNG::NORMAL, 0, sigma);
    image.convertTo(sum, CV_32F);
    sum += noise;
    sum.convertTo(image, CV_8U);
}

}  // namespace

RenderedPair rendered_pair(unsigned seed, cv::Size size,
                           const std::function<void(calibration::StereoCalibration&)>& change) {
    capture::SourceOptions options;
    options.uri = "scene:vga?frames=1&seed=" + std::to_string(seed) + "&width=" + std::to_string(size.width) +
                  "&height=" + std::to_string(size.height);
    options.pace = capture::Pace::fastest;
    const auto source = capture::open_source(options);
    capture::RawFrame frame;
    if (source->next(frame, std::chrono::steady_clock::now() + std::chrono::minutes(1)) !=
        capture::FrameSource::Next::frame) {
        throw std::runtime_error("no frame was rendered");
    }
    RenderedPair pair;
    pair.calibration = source->info().calibration;
    if (change) {
        change(*pair.calibration);
    }
    rectify(frame.image, pair, size);
    source->give_back(frame);
    return pair;
}

RenderedPair good_pair(unsigned seed) {
    Draw draw(seed);
    RenderedPair pair = rendered_pair(seed, made_size);
    const double gain = draw.of(30, 110) / 100.0, sigma = draw.of(0, 30) / 10.0;
    for (cv::Mat* image : {&pair.left, &pair.right}) {
        image->convertTo(*image, CV_8U, gain);
        add_noise(*image, sigma, draw);
    }
    return pair;
}

RenderedPair exchanged_pair(unsigned seed) {
    RenderedPair pair = good_pair(seed);
    std::swap(pair.left, pair.right);
    return pair;
}

namespace {

RenderedPair moved_right_image(unsigned seed, double columns, double rows, double degrees) {
    RenderedPair pair = good_pair(seed);
    cv::Mat turn = cv::getRotationMatrix2D({168, 94}, degrees, 1);
    turn.at<double>(0, 2) += columns;
    turn.at<double>(1, 2) += rows;
    cv::Mat moved;
    cv::warpAffine(pair.right, moved, turn, made_size, cv::INTER_LINEAR, cv::BORDER_REFLECT);
    pair.right = moved;
    return pair;
}

}  // namespace

RenderedPair near_pair(unsigned seed) {
    Draw draw(seed);
    return moved_right_image(seed, -draw.of(34, 90), 0, 0);
}

RenderedPair unaligned_pair(unsigned seed) {
    Draw draw(seed);
    const int sign = draw.of(0, 1) == 0 ? 1 : -1;
    return seed % 3 == 0 ? moved_right_image(seed, 0, 0, sign * draw.of(30, 50) / 10.0)
                         : moved_right_image(seed, 0, sign * draw.of(3, 12), 0);
}

RenderedPair plain_pair(unsigned seed) {
    Draw draw(seed);
    RenderedPair pair;
    pair.left.create(made_size, CV_8UC1);
    pair.left.setTo(draw.of(0, 2) == 0 ? 0 : draw.of(0, 255));
    const int kind = static_cast<int>(seed % 5);
    if (kind == 1 || kind == 2) {
        for (int y = 0; y < made_size.height; ++y) {
            for (int x = 0; x < made_size.width; ++x) {
                const double u = x / (made_size.width / 2.0) - 1, v = y / (made_size.height / 2.0) - 1;
                pair.left.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(
                    kind == 1 ? 255.0 * x / made_size.width : 200 - 60 * (u * u + v * v));
            }
        }
    }
    if (kind == 3) {
        pair = rendered_pair(seed, made_size);
        cv::GaussianBlur(pair.left, pair.left, {}, 14);
        cv::GaussianBlur(pair.right, pair.right, {}, 14);
    } else if (kind == 4) {
        pair.right = rendered_pair(seed, made_size).right;
    } else {
        pair.right = pair.left.clone();
    }
    const double sigma = draw.of(0, 30) / 10.0;
    add_noise(pair.left, sigma, draw);
    add_noise(pair.right, sigma, draw);
    return pair;
}

RenderedPair other_resolution_pair(unsigned seed) {
    Draw draw(seed);
    const double ratios[] = {0.5, 0.58, 0.667, 1.15, 1.5, 1.725, 1.9};
    const double ratio = ratios[draw.of(0, 6)];
    return rendered_pair(seed, made_size, [ratio](calibration::StereoCalibration& calibration) {
        for (calibration::CameraModel* eye : {&calibration.left, &calibration.right}) {
            const double focal = ratio == 1.15 ? 1 : ratio;
            eye->fx *= focal;
            eye->fy *= focal;
            eye->cx *= ratio;
            eye->cy *= ratio;
        }
    });
}

}  // namespace disparityd::test

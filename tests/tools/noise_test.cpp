// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/noise.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gmock/gmock.h>

namespace disparityd::eval {
namespace {

using testing::ElementsAre;

/// What noise added to each pixel of a grey image of this value.
std::vector<int> added(int value, double sigma, std::uint32_t seed, int width, int height) {
    const cv::Mat image(height, width, CV_8UC1, cv::Scalar(value));
    const cv::Mat noisy = with_noise(image, sigma, seed);
    std::vector<int> difference;
    for (auto pixel = noisy.begin<std::uint8_t>(); pixel != noisy.end<std::uint8_t>(); ++pixel) {
        difference.push_back(*pixel - value);
    }
    return difference;
}

struct Moments {
    double mean = 0;
    double sigma = 0;
};

Moments moments(const std::vector<int>& values) {
    double sum = 0, squares = 0;
    for (const int value : values) {
        sum += value;
        squares += static_cast<double>(value) * value;
    }
    const auto count = static_cast<double>(values.size());
    return {sum / count, std::sqrt(squares / count - sum / count * (sum / count))};
}

double correlation(const std::vector<int>& one, const std::vector<int>& other) {
    double sum = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        sum += static_cast<double>(one[i]) * other[i];
    }
    return sum / static_cast<double>(one.size()) / moments(one).sigma / moments(other).sigma;
}

TEST(NoiseTest, SeedIsTheHashOfSceneAndEye) {
    EXPECT_EQ(noise_seed("cones", "left"), 1758757133U);
    EXPECT_EQ(noise_seed("cones", "right"), 2799316934U);
    EXPECT_NE(noise_seed("teddy", "left"), noise_seed("cones", "left"));
}

TEST(NoiseTest, SameValuesOnEveryMachine) {
    // From an implementation of the documented generator in another language.
    EXPECT_THAT(added(128, 3, noise_seed("cones", "left"), 12, 1), ElementsAre(2, 4, 1, 0, 0, 2, 4, 8, -2, -1, -3, 4));
    EXPECT_THAT(added(128, 3, noise_seed("cones", "right"), 12, 1),
                ElementsAre(4, -2, 0, 1, -3, 1, -9, -3, 6, 2, 0, 0));
}

TEST(NoiseTest, SharedNoiseHasTheSigmaAskedForAndNeighboursAreAlike) {
    const cv::Mat image(300, 300, CV_8UC1, cv::Scalar(128));
    const cv::Mat noisy = with_noise(image, 6, 7, NoiseKind::shared);
    std::vector<int> here, right, far_right;
    for (int y = 0; y < 300; ++y) {
        for (int x = 0; x < 297; ++x) {
            here.push_back(noisy.at<std::uint8_t>(y, x) - 128);
            right.push_back(noisy.at<std::uint8_t>(y, x + 1) - 128);
            far_right.push_back(noisy.at<std::uint8_t>(y, x + 3) - 128);
        }
    }
    EXPECT_NEAR(moments(here).sigma, 6, 0.15);
    EXPECT_NEAR(correlation(here, right), 2.0 / 3, 0.03);
    EXPECT_NEAR(correlation(here, far_right), 0, 0.03);
}

TEST(NoiseTest, MeanAndSigmaAreThoseAskedFor) {
    for (const double sigma : {0.75, 3.0, 6.0, 20.0}) {
        const std::vector<int> values = added(128, sigma, 7, 400, 400);
        const Moments found = moments(values);
        // Rounding to whole grey levels adds a variance of 1/12.
        EXPECT_NEAR(found.sigma, std::sqrt(sigma * sigma + 1.0 / 12), 0.01 * sigma) << sigma;
        EXPECT_NEAR(found.mean, 0, 0.01 * sigma) << "5 sigma of the mean would be 0.0125 sigma";
    }
}

TEST(NoiseTest, ShapeIsThatOfAGaussian) {
    const std::vector<int> values = added(128, 10, 7, 400, 400);
    const auto share_within = [&values](int most) {
        std::size_t count = 0;
        for (const int value : values) {
            count += std::abs(value) <= most ? 1U : 0U;
        }
        return static_cast<double>(count) / static_cast<double>(values.size());
    };
    EXPECT_NEAR(share_within(10), std::erf(1.05 / std::sqrt(2)), 0.006);
    EXPECT_NEAR(share_within(20), std::erf(2.05 / std::sqrt(2)), 0.004);
    EXPECT_NEAR(share_within(30), std::erf(3.05 / std::sqrt(2)), 0.002);
}

TEST(NoiseTest, EyesAndNeighboursAreIndependent) {
    const std::vector<int> left = added(128, 6, noise_seed("cones", "left"), 200, 200);
    const std::vector<int> right = added(128, 6, noise_seed("cones", "right"), 200, 200);
    EXPECT_NEAR(correlation(left, right), 0, 0.025);
    EXPECT_NEAR(correlation({left.begin(), left.end() - 1}, {left.begin() + 1, left.end()}), 0, 0.025);
}

TEST(NoiseTest, SumsAreClamped) {
    const cv::Mat black = with_noise(cv::Mat(100, 100, CV_8UC1, cv::Scalar(0)), 64, 3);
    const cv::Mat white = with_noise(cv::Mat(100, 100, CV_8UC1, cv::Scalar(255)), 64, 3);
    EXPECT_NEAR(cv::countNonZero(black == 0), 5000, 300) << "what would be negative is 0, and does not wrap";
    EXPECT_NEAR(cv::countNonZero(white == 255), 5000, 300);
}

TEST(NoiseTest, NoneOfSigma0) {
    EXPECT_THAT(added(77, 0, 5, 50, 50), testing::Each(0));
}

TEST(NoiseTest, ChannelsOfAPixelGetTheSame) {
    const cv::Mat image(40, 40, CV_8UC3, cv::Scalar(100, 110, 120));
    const cv::Mat noisy = with_noise(image, 3, 11);
    const std::vector<int> grey = added(100, 3, 11, 40, 40);
    std::size_t i = 0;
    for (auto pixel = noisy.begin<cv::Vec3b>(); pixel != noisy.end<cv::Vec3b>(); ++pixel, ++i) {
        EXPECT_EQ(*pixel, cv::Vec3b(static_cast<std::uint8_t>(100 + grey[i]), static_cast<std::uint8_t>(110 + grey[i]),
                                    static_cast<std::uint8_t>(120 + grey[i])));
    }
    EXPECT_EQ(cv::countNonZero(image.reshape(1) != cv::Mat(40, 40, CV_8UC3, cv::Scalar(100, 110, 120)).reshape(1)), 0)
        << "the image given stays as it is";
}

TEST(NoiseTest, SceneGetsItInBothEyes) {
    Scene scene;
    scene.name = "cones";
    scene.left = cv::Mat(8, 8, CV_8UC1, cv::Scalar(90));
    scene.right = scene.left.clone();
    add_noise(scene, 5);
    const auto differs = [](const cv::Mat& one, const cv::Mat& other) { return cv::countNonZero(one != other) > 0; };
    const cv::Mat plain(8, 8, CV_8UC1, cv::Scalar(90));
    EXPECT_FALSE(differs(scene.left, with_noise(plain, 5, noise_seed("cones", "left"))));
    EXPECT_FALSE(differs(scene.right, with_noise(plain, 5, noise_seed("cones", "right"))));
    EXPECT_TRUE(differs(scene.left, scene.right));
}

}  // namespace
}  // namespace disparityd::eval

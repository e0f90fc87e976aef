// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

#include "tools/eval/scene.h"

namespace disparityd::eval {

/// Returns the seed of an image's noise: the 32-bit FNV-1a hash of "SCENE/EYE", such as "cones/left".
std::uint32_t noise_seed(const std::string& scene, const std::string& eye);

enum class NoiseKind : unsigned char {
    independent,
    shared,  ///< between neighbours, as a camera's own filter leaves it
};

/// Returns the image (8 bit, grey or BGR) with Gaussian noise of `sigma` grey levels, 0 .. 64: one rounded value for
/// each pixel, the same in all channels so that the grey image has this sigma too; the sum is clamped to 0 .. 255.
///
/// The same seed gives the same bytes everywhere, so the standard library's distributions are not used: a pixel, row by
/// row, takes six numbers of std::mt19937(seed). Their twelve halves of 16 bits are summed and their mean subtracted,
/// which is a Gaussian value of sigma 65536 within 6 sigma. It is multiplied by `sigma` in integers of 1/65536. Shared
/// noise draws for two more rows and columns; a pixel has the sum of 3 x 3 values over 3, which has the same sigma.
cv::Mat with_noise(const cv::Mat& image, double sigma, std::uint32_t seed, NoiseKind kind = NoiseKind::independent);

/// Adds noise to both images of a scene, each with a seed of its own.
void add_noise(Scene& scene, double sigma, NoiseKind kind = NoiseKind::independent);

}  // namespace disparityd::eval

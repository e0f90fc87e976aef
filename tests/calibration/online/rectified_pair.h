// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calibration/calibration_correction.h"
#include "calibration/rectification.h"
#include "kernels/raw_image.h"

namespace disparityd::calibration::test {

/// A grey image of the test's own.
struct Grey {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> pixels;

    Plane<std::uint8_t> plane() { return {pixels.data(), width, height, width}; }
    Plane<const std::uint8_t> plane() const { return {pixels.data(), width, height, width}; }
};

struct Pair {
    Rectification used;
    Grey left;
    Grey right;
};

/// A raw frame, rectified by the reference.
Pair rectified(const RawImage& raw, const StereoCalibration& calibration, const RectifiedGeometry& geometry = {});

/// Frames of the rendered scene, one after the other as a camera sees them (YUYV, side by side).
class SceneFrames {
public:
    explicit SceneFrames(const std::string& uri);

    RawImage frame(int index) const;

private:
    int width_ = 0;
    int height_ = 0;
    std::vector<std::vector<std::uint8_t>> frames_;
};

/// Degrees to billionths of a radian.
std::int32_t nrad(double degrees);

}  // namespace disparityd::calibration::test

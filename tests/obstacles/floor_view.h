// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "obstacles/scan_geometry.h"

namespace disparityd::test {

/// Options for a camera that is mounted so.
inline ScanOptions options_of(const Mounting& mounting) {
    ScanOptions options;
    options.camera_height_m = mounting.height_m;
    options.pitch_deg = mounting.pitch_deg;
    options.roll_deg = mounting.roll_deg;
    return options;
}

/// The disparities of a level plane below a camera, and of what stands upright on it.
class FloorView {
public:
    static constexpr int width = 320;
    static constexpr int height = 240;

    static scan::Camera camera() {
        return {width, height, f, (width - 1) / 2.0, (height - 1) / 2.0, {std::lround(16 * f * baseline_mm), 0}};
    }

    explicit FloorView(const Mounting& mounting)
        : mounting_(mounting),
          rays_(scan::make_rays(camera(), options_of(mounting))),
          disparity_(width * height, -16),
          confidence_(width * height, 0) {}

    /// A floor `above_m` above the one on which the camera stands, between these distances ahead.
    FloorView& floor(double above_m = 0, double from_m = 0, double to_m = 15) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double z = (above_m - mounting_.height_m) / rays_.up(x, y);
                const double ahead = z * rays_.ahead(x, y);
                if (z > 0 && ahead >= from_m && ahead <= to_m) {
                    put(x, y, z);
                }
            }
        }
        return *this;
    }
    FloorView& wall(double ahead_m) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                put(x, y, ahead_m / rays_.ahead(x, y));
            }
        }
        return *this;
    }
    /// Moves each disparity by a random number of sixteenths, and one of twenty anywhere.
    FloorView& noise(unsigned seed) {
        std::mt19937 random(seed);
        for (std::size_t i = 0; i < disparity_.size(); ++i) {
            if (confidence_[i] != 0) {
                const auto change = static_cast<int>(random() % 9) - 4;
                disparity_[i] = static_cast<std::int16_t>(random() % 20 == 0 ? static_cast<int>(random() % 1000)
                                                                             : disparity_[i] + change);
            }
        }
        return *this;
    }
    scan::Pixels pixels() const {
        return {{disparity_.data(), width, height, width}, {confidence_.data(), width, height, width}};
    }

    /// The same as a stage gets them.
    FrameView frame() {
        FrameView frame;
        frame.disparity = {disparity_.data(), width, height, width};
        frame.confidence = {confidence_.data(), width, height, width};
        frame.depth_scale = camera().scale;
        return frame;
    }

private:
    static constexpr double f = 200;
    static constexpr double baseline_mm = 120;

    /// What is nearer stays.
    void put(int x, int y, double z_m) {
        const auto i = static_cast<std::size_t>(y * width + x);
        const auto d16 = static_cast<std::int16_t>(std::lround(16 * f * baseline_mm / (1000 * z_m)));
        if (z_m > 0 && d16 > disparity_[i]) {
            disparity_[i] = d16;
            confidence_[i] = 250;
        }
    }

    Mounting mounting_;
    scan::Rays rays_;
    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
};

}  // namespace disparityd::test

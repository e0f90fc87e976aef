// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/matcher.h"

namespace disparityd::test {

/// Both eyes of a textured wall and its disparity, without noise.
class TexturedPair {
public:
    static constexpr int width = 320;
    static constexpr int height = 192;
    static constexpr int disparity = 8;

    explicit TexturedPair(int moved = 0)
        : left(size), right(size), disparities(size, disparity * 16), confidence(size, 250) {
        draw(left, moved, 0);
        draw(right, moved + disparity, 0);
    }

    /// Draws the right eye `rows` lower.
    void lower_right_eye(double rows, int moved = 0) { draw(right, moved + disparity, rows); }

    /// Blurs a part of an eye with a square window, which is smaller at the edge.
    static void blur(std::vector<std::uint8_t>& eye, int x0, int y0, int x1, int y1, int reach = 4) {
        const std::vector<std::uint8_t> sharp = eye;
        for (int y = y0; y < y1; ++y) {
            for (int x = x0; x < x1; ++x) {
                int sum = 0;
                int count = 0;
                for (int v = std::max(y - reach, 0); v <= std::min(y + reach, height - 1); ++v) {
                    for (int u = std::max(x - reach, 0); u <= std::min(x + reach, width - 1); ++u) {
                        sum += sharp[at(u, v)];
                        ++count;
                    }
                }
                eye[at(x, y)] = static_cast<std::uint8_t>(sum / count);
            }
        }
    }

    FrameView view() {
        FrameView view;
        view.left = {left.data(), width, height, width};
        view.right = {right.data(), width, height, width};
        view.disparity = {disparities.data(), width, height, width};
        view.confidence = {confidence.data(), width, height, width};
        return view;
    }

    static std::size_t at(int x, int y) { return static_cast<std::size_t>(y * width + x); }

private:
    static constexpr std::size_t size = std::size_t{width} * height;

    /// 0 .. 255 at each point of a grid.
    static double grid(int x, int y) {
        std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b1U + static_cast<std::uint32_t>(y) * 0x85ebca77U;
        h = (h ^ (h >> 16U)) * 0x7feb352dU;
        return (h ^ (h >> 15U)) >> 8U & 0xffU;
    }

    /// The grid's values every 3 px, joined by straight lines.
    static void draw(std::vector<std::uint8_t>& eye, int to_left, double lower) {
        constexpr double spacing = 3;
        for (int y = 0; y < height; ++y) {
            const double v = (y - lower + 300) / spacing;
            const int j = static_cast<int>(v);
            for (int x = 0; x < width; ++x) {
                const double u = (x + to_left + 300) / spacing;
                const int i = static_cast<int>(u);
                const double above = grid(i, j) + (u - i) * (grid(i + 1, j) - grid(i, j));
                const double below = grid(i, j + 1) + (u - i) * (grid(i + 1, j + 1) - grid(i, j + 1));
                eye[at(x, y)] = static_cast<std::uint8_t>(std::lround(above + (v - j) * (below - above)));
            }
        }
    }

public:
    std::vector<std::uint8_t> left;
    std::vector<std::uint8_t> right;
    std::vector<std::int16_t> disparities;
    std::vector<std::uint8_t> confidence;
};

}  // namespace disparityd::test

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <random>
#include <thread>
#include <vector>

#include "kernels/matcher.h"
#include "kernels/near_plane.h"
#include "kernels/reference/steps.h"
#include "tests/kernels/print_parameters.h"

namespace disparityd::test {

/// An owned 2-D array, filled row by row.
template <typename T>
class Image {
public:
    Image(int width, int height, T value = {})
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), value) {}
    Image(int width, int height, std::vector<T> pixels) : width_(width), height_(height), pixels_(std::move(pixels)) {}

    T& at(int x, int y) {
        return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
    }
    T at(int x, int y) const { return const_cast<Image&>(*this).at(x, y); }
    Plane<T> plane() { return {pixels_.data(), width_, height_, width_}; }
    Plane<const T> plane() const { return {pixels_.data(), width_, height_, width_}; }
    int width() const { return width_; }
    int height() const { return height_; }
    Rows rows() const { return {0, height_}; }
    std::vector<T>& pixels() { return pixels_; }
    const std::vector<T>& pixels() const { return pixels_; }

private:
    int width_;
    int height_;
    std::vector<T> pixels_;
};

using Random = std::mt19937;

inline int pick(Random& random, int least, int most) {
    // Not std::uniform_int_distribution: it differs between standard libraries.
    return least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
}

inline Image<std::uint8_t> noise(Random& random, int width, int height, int least = 0, int most = 255) {
    Image<std::uint8_t> image(width, height);
    for (std::uint8_t& pixel : image.pixels()) {
        pixel = static_cast<std::uint8_t>(pick(random, least, most));
    }
    return image;
}

/// The right image of a flat scene at disparity d: right (x - d, y) = left (x, y), noise where the left image ends.
inline Image<std::uint8_t> shifted(Random& random, const Image<std::uint8_t>& left, int d) {
    Image<std::uint8_t> right = noise(random, left.width(), left.height());
    for (int y = 0; y < left.height(); ++y) {
        for (int x = std::max(0, d); x < std::min(left.width(), left.width() + d); ++x) {
            right.at(x - d, y) = left.at(x, y);
        }
    }
    return right;
}

/// Workers that take tasks in a shuffled order, each in a thread of its own.
class ShuffledWorkers final : public Parallel {
public:
    ShuffledWorkers(int count, unsigned seed) : count_(count), random_(seed) {}
    int workers() const override { return count_; }
    void for_each(int count, FunctionRef<void(int)> task) override {
        std::vector<int> order(static_cast<std::size_t>(count));
        std::iota(order.begin(), order.end(), 0);
        std::shuffle(order.begin(), order.end(), random_);
        std::vector<std::thread> threads;
        for (int worker = 0; worker < count_; ++worker) {
            threads.emplace_back([&, worker] {
                for (std::size_t i = static_cast<std::size_t>(worker); i < order.size();
                     i += static_cast<std::size_t>(count_)) {
                    task(order[i]);
                }
            });
        }
        for (std::thread& thread : threads) {
            thread.join();
        }
    }

private:
    int count_;
    Random random_;
};

/// A matched pair with everything that a matcher writes.
class Frame {
public:
    Frame(const Matcher& matcher, Image<std::uint8_t> left_image, Image<std::uint8_t> right_image)
        : left(std::move(left_image)),
          right(std::move(right_image)),
          disparity(left.width(), left.height(), 1234),
          confidence(left.width(), left.height(), 77),
          depth(left.width(), left.height(), 4321),
          depth_error(left.width(), left.height(), 5432),
          near(near_blocks(left.width()), near_blocks(left.height()), 3210),
          scratch_(matcher.scratch_bytes() + 64, std::byte{0xa5}) {
        view.left = left.plane();
        view.right = right.plane();
        view.disparity = disparity.plane();
        view.confidence = confidence.plane();
        view.depth = depth.plane();
        view.depth_scale = {1600000, 3};
        view.depth_error = depth_error.plane();
        view.subpixel_error = 64;
        view.near = near.plane();
        void* start = scratch_.data();
        std::size_t space = scratch_.size();
        view.scratch = {static_cast<std::byte*>(std::align(64, matcher.scratch_bytes(), start, space)),
                        matcher.scratch_bytes()};
    }

    Image<std::uint8_t> left, right;
    Image<std::int16_t> disparity;
    Image<std::uint8_t> confidence;
    Image<std::uint16_t> depth, depth_error;
    Image<std::int16_t> near;
    FrameView view;

private:
    std::vector<std::byte> scratch_;
};

}  // namespace disparityd::test

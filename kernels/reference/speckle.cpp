// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>

#include "kernels/reference/steps.h"
#include "kernels/texture.h"

namespace disparityd::reference {

namespace {

std::size_t pixel_count(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

// Grows one region after the other, breadth first; every pixel enters the queue once.
class Regions {
public:
    Regions(Plane<std::int16_t> disparity, const RegionTest& test, std::span<std::byte> scratch)
        : disparity_(disparity),
          test_(test),
          invalid_(test.invalid),
          queue_(reinterpret_cast<std::uint32_t*>(scratch.data())),
          visited_(reinterpret_cast<std::uint8_t*>(queue_ + pixel_count(disparity.width, disparity.height))) {
        std::fill_n(visited_, pixel_count(disparity.width, disparity.height), std::uint8_t{0});
    }

    /// Rejects the region that (x, y) belongs to if it was not visited yet and does not pass the test.
    void visit(int x, int y) {
        const std::int16_t value = disparity_.at(x, y);
        if (value == invalid_ || visited_[index(x, y)] != 0) {
            return;
        }
        size_ = 0;
        int votes = 0;
        push(x, y);
        for (std::size_t i = 0; i < size_; ++i) {
            const int from_x = static_cast<int>(queue_[i] % static_cast<std::uint32_t>(disparity_.width));
            const int from_y = static_cast<int>(queue_[i] / static_cast<std::uint32_t>(disparity_.width));
            const std::int16_t from = disparity_.at(from_x, from_y);
            votes += test_.min_texture > 0 ? vote(from_x, from_y) : 0;
            join(from, from_x - 1, from_y);
            join(from, from_x + 1, from_y);
            join(from, from_x, from_y - 1);
            join(from, from_x, from_y + 1);
        }
        for (std::size_t i = 0; !passes(votes) && i < size_; ++i) {
            const auto width = static_cast<std::uint32_t>(disparity_.width);
            disparity_.at(static_cast<int>(queue_[i] % width), static_cast<int>(queue_[i] / width)) = invalid_;
        }
    }

private:
    bool passes(int votes) const {
        const int pixels = static_cast<int>(size_);
        return pixels >= test_.min_size && (test_.min_texture == 0 || has_texture(votes, pixels, test_.min_texture));
    }

    int vote(int x, int y) const {
        const int match = x - ((disparity_.at(x, y) + 15) >> 4);
        const int ramp = column(test_.left, x + texture_reach, y) - column(test_.left, x - texture_reach, y);
        return texture_vote(gradient(test_.left, x, y), ramp, right_gradient(match, y), right_gradient(match + 1, y));
    }

    // Of the last pixel beyond the image's sides.
    int right_gradient(int x, int y) const { return gradient(test_.right, std::clamp(x, 0, test_.right.width - 1), y); }

    // Of step 3, before it is clamped.
    static int gradient(Plane<const std::uint8_t> image, int x, int y) {
        return column(image, x + 1, y) - column(image, x - 1, y);
    }

    static int column(Plane<const std::uint8_t> image, int x, int y) {
        const int inside = std::clamp(x, 0, image.width - 1);
        return image.at(inside, std::max(y - 1, 0)) + 2 * image.at(inside, y) +
               image.at(inside, std::min(y + 1, image.height - 1));
    }

    std::uint32_t index(int x, int y) const {
        return static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(disparity_.width) +
               static_cast<std::uint32_t>(x);
    }

    void push(int x, int y) {
        visited_[index(x, y)] = 1;
        queue_[size_++] = index(x, y);
    }

    void join(std::int16_t from, int x, int y) {
        if (x < 0 || x >= disparity_.width || y < 0 || y >= disparity_.height || visited_[index(x, y)] != 0) {
            return;
        }
        const std::int16_t value = disparity_.at(x, y);
        if (value != invalid_ && std::abs(value - from) <= test_.max_step) {
            push(x, y);
        }
    }

    Plane<std::int16_t> disparity_;
    const RegionTest& test_;
    std::int16_t invalid_;
    std::uint32_t* queue_;
    std::uint8_t* visited_;
    std::size_t size_ = 0;
};

}  // namespace

std::size_t speckle_scratch(int width, int height) {
    return pixel_count(width, height) * (sizeof(std::uint32_t) + sizeof(std::uint8_t));
}

void speckle(Plane<std::int16_t> disparity, const RegionTest& test, std::span<std::byte> scratch) {
    Regions regions(disparity, test, scratch);
    for (int y = 0; y < disparity.height; ++y) {
        for (int x = 0; x < disparity.width; ++x) {
            regions.visit(x, y);
        }
    }
}

}  // namespace disparityd::reference

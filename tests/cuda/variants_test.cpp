// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "kernels/cuda/memory.h"
#include "tests/cuda/census_variants.h"
#include "tests/cuda/device_under_test.h"
#include "tests/cuda/minima.h"
#include "tests/kernels/support.h"

// What tools/gpu-check times beside the kernels computes the same as they do.
namespace disparityd::test {
namespace {

using CudaVariants = CudaDevice;
using Bytes = Image<std::uint8_t>;
using Words = std::vector<std::uint64_t>;

/// Two images on the device and room for their census words.
class CensusOnDevice {
public:
    CensusOnDevice(const Bytes& left, const Bytes& right) : width_(left.width()), height_(left.height()) {
        std::memcpy(images_[0].host<void>(), left.pixels().data(), pixels_);
        std::memcpy(images_[1].host<void>(), right.pixels().data(), pixels_);
        images_[0].to_device(stream);
        images_[1].to_device(stream);
    }

    cuda::View<const std::uint8_t> image(std::size_t eye) const {
        return {images_[eye].device<const std::uint8_t>(), width_, height_, width_};
    }
    std::uint64_t* words(std::size_t eye) const { return words_[eye].device<std::uint64_t>(); }
    Words found(std::size_t eye) const {
        words_[eye].to_host(stream);
        stream.wait("the census");
        return {words_[eye].host<std::uint64_t>(), words_[eye].host<std::uint64_t>() + pixels_};
    }

private:
    int width_;
    int height_;
    std::size_t pixels_ = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    std::array<cuda::PinnedBuffer, 2> images_ = {{{pixels_, "an image"}, {pixels_, "an image"}}};
    std::array<cuda::PinnedBuffer, 2> words_ = {{{8 * pixels_, "the words"}, {8 * pixels_, "the words"}}};

public:
    cuda::Stream stream;
};

Words expected_of(const Bytes& image) {
    Image<std::uint64_t> words(image.width(), image.height());
    reference::census(image.plane(), words.plane(), image.rows());
    return words.pixels();
}

TEST_F(CudaVariants, CensusIsTheSameFromEveryMemory) {
    Random random(70);
    int n = 0;
    for (const auto& [columns, rows] : {std::pair{1, 1}, {37, 11}, {33, 40}}) {
        const Variation variation(++n);
        const Bytes left = noise(random, columns, rows, 0, 3);
        const Bytes right = noise(random, columns, rows);
        const std::array<Words, 2> expected = {expected_of(left), expected_of(right)};

        const CensusOnDevice shared(left, right);
        cuda::census(cuda::Cost::census_9x7, shared.image(0), shared.image(1), shared.words(0), shared.words(1),
                     shared.stream.get());
        const CensusOnDevice global(left, right);
        census_from_global_memory(global.image(0), global.image(1), global.words(0), global.words(1),
                                  global.stream.get());
        const CensusOnDevice textured(left, right);
        const Texture left_texture(columns, rows);
        const Texture right_texture(columns, rows);
        left_texture.take(textured.image(0), textured.stream.get());
        right_texture.take(textured.image(1), textured.stream.get());
        census_from_textures(left_texture, right_texture, columns, rows, textured.words(0), textured.words(1),
                             textured.stream.get());
        for (const std::size_t eye : {0U, 1U}) {
            EXPECT_EQ(shared.found(eye), expected[eye]);
            EXPECT_EQ(global.found(eye), expected[eye]);
            EXPECT_EQ(textured.found(eye), expected[eye]);
        }
    }
}

std::vector<cuda::GradientWord> gradient_words_of(const Bytes& image) {
    Image<std::uint64_t> words(image.width(), image.height());
    reference::census_gradient(image.plane(), words.plane(), image.rows());
    std::vector<cuda::GradientWord> result;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            cuda::GradientWord& word = result.emplace_back();
            for (int i = 0; i < 3; ++i) {
                const std::uint64_t from = words.at(x, std::clamp(y + i - 1, 0, image.height() - 1));
                word.census[i] = static_cast<std::uint32_t>(from);
                word.gradients |= static_cast<std::uint32_t>(from >> 32 << 8 * i);
            }
        }
    }
    return result;
}

// Not a variant, but its words are looked at nowhere else.
TEST_F(CudaVariants, CensusAndGradientEqualTheReferenceOnThreeRows) {
    Random random(71);
    int n = 0;
    for (const auto& [columns, rows] : {std::pair{1, 1}, {1, 33}, {37, 2}, {33, 40}, {3, 65}}) {
        const Variation variation(++n);
        const Bytes left = noise(random, columns, rows, 0, 3);
        const Bytes right = noise(random, columns, rows);
        const std::size_t pixels = left.pixels().size();
        const std::array<cuda::PinnedBuffer, 2> words = {{{16 * pixels, "the words"}, {16 * pixels, "the words"}}};
        const CensusOnDevice images(left, right);
        cuda::census(cuda::Cost::census_7x5_gradient, images.image(0), images.image(1),
                     words[0].device<std::uint64_t>(), words[1].device<std::uint64_t>(), images.stream.get());
        words[0].to_host(images.stream);
        words[1].to_host(images.stream);
        images.stream.wait("the census");
        EXPECT_EQ(std::memcmp(words[0].host<void>(), gradient_words_of(left).data(), 16 * pixels), 0);
        EXPECT_EQ(std::memcmp(words[1].host<void>(), gradient_words_of(right).data(), 16 * pixels), 0);
    }
}

TEST_F(CudaVariants, EveryWayToTakeAMinimumGivesTheSame) {
    constexpr int rounds = 3;
    const auto found = [](Minimum way) {
        const cuda::Stream stream;
        const cuda::PinnedBuffer out(minima_threads * sizeof(std::uint32_t), "minima");
        take_minima(way, 1, rounds, 0x12341678, out.device<std::uint32_t>(), stream.get());
        out.to_host(stream);
        stream.wait("minima");
        return std::vector<std::uint32_t>(out.host<std::uint32_t>(), out.host<std::uint32_t>() + minima_threads);
    };
    const auto of_half = [](int shift, unsigned thread, unsigned chain) {
        constexpr unsigned small = 0x3fff3fff;
        unsigned other = 0x12341678;
        unsigned least = ((thread + chain) * 0x9e3779b9U & small) >> shift & 0xffff;
        for (int round = 0; round < rounds; ++round) {
            least = std::min(least, other >> shift & 0xffff);
            other = (other + 0x12341678) & small;
        }
        return least << shift;
    };
    std::vector<std::uint32_t> expected(minima_threads);
    for (unsigned thread = 0; thread < minima_threads; ++thread) {
        for (unsigned chain = 0; chain < minima_chains; ++chain) {
            expected[thread] = expected[thread] * 31 + (of_half(0, thread, chain) | of_half(16, thread, chain));
        }
    }
    EXPECT_EQ(found(Minimum::as_integers), expected);
    EXPECT_EQ(found(Minimum::as_f16), expected);
    EXPECT_EQ(found(Minimum::of_sum), expected);
}

}  // namespace
}  // namespace disparityd::test

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <vector>

#include "kernels/cuda/memory.h"
#include "kernels/cuda/steps.h"
#include "tests/cuda/device_under_test.h"
#include "tests/kernels/post/post_inputs.h"

// The steps after matching, one by one, on what the CPU's kernels are tested with.
namespace disparityd::test {
namespace {

using CudaPost = CudaDevice;
using Disparities = Image<std::int16_t>;

/// An image on the device.
template <typename T>
class OnDevice {
public:
    explicit OnDevice(const Image<T>& image)
        : width_(image.width()), height_(image.height()), memory_(image.pixels().size() * sizeof(T), "an image") {
        std::memcpy(memory_.host<void>(), image.pixels().data(), memory_.size());
    }
    T* at(const cuda::Stream& stream) const {
        memory_.to_device(stream);
        return memory_.device<T>();
    }
    std::vector<T> found(const cuda::Stream& stream) const {
        memory_.to_host(stream);
        stream.wait("the test");
        const T* first = memory_.host<T>();
        return {first, first + static_cast<std::ptrdiff_t>(width_) * height_};
    }

private:
    int width_;
    int height_;
    cuda::PinnedBuffer memory_;
};

cuda::Range on_device(DisparityRange range) {
    return {range.first, range.count};
}

TEST_F(CudaPost, LeftRightAndMedianEqualTheReference) {
    Random random(90);
    for (int round = 0; round < 60 / one_round_of; ++round) {
        const Variation variation(round);
        const Size size(random);
        const DisparityRange range = any_range(random);
        Disparities left = winners(random, size, range);
        for (std::int16_t& winner : left.pixels()) {  // every pixel of the left image has one
            winner = static_cast<std::int16_t>(std::clamp<int>(winner, range.first, range.first + range.count - 1));
        }
        const Disparities right = winners(random, size, range);
        Disparities checked = disparities(random, size, range);
        const int side = std::array{0, 3, 5}[static_cast<std::size_t>(pick(random, 0, 2))];
        const bool check_left_right = pick(random, 0, 3) > 0;

        const cuda::Stream stream;
        const OnDevice<std::int16_t> in(checked), left_winner(left), right_winner(right);
        const OnDevice<std::int16_t> out(Disparities(size.width, size.height, 77));
        cuda::left_right_median({size.width, size.height, on_device(range), in.at(stream), left_winner.at(stream),
                                 right_winner.at(stream), check_left_right, side, out.at(stream)},
                                stream.get());

        if (check_left_right) {
            reference::left_right(std::as_const(left).plane(), right.plane(), range, checked.plane(), checked.rows());
        }
        Disparities expected = checked;
        if (side > 0) {
            reference::median(std::as_const(checked).plane(), invalid_disparity(range), side, expected.plane(),
                              checked.rows());
        }
        ASSERT_EQ(out.found(stream), expected.pixels()) << "round " << round << ", side " << side;
    }
}

std::vector<std::int16_t> without_speckles(const Disparities& image, const RegionTest& test, const TexturedPair& pair) {
    const cuda::Stream stream;
    const OnDevice<std::int16_t> disparity(image);
    const Image<std::uint32_t> empty(image.width(), image.height(), 0x77777777);
    const OnDevice<std::uint32_t> labels(empty), sizes(empty);
    const OnDevice<int> votes(Image<int>(image.width(), image.height(), 0x77777777));
    const OnDevice<std::uint8_t> left(pair.left), right(pair.right);
    const int width = image.width();
    const int height = image.height();
    cuda::speckle({width,
                   height,
                   test.invalid,
                   test.min_size,
                   test.max_step,
                   disparity.at(stream),
                   labels.at(stream),
                   sizes.at(stream),
                   test.min_texture,
                   {left.at(stream), width, height, width},
                   {right.at(stream), width, height, width},
                   votes.at(stream)},
                  stream.get());
    return disparity.found(stream);
}

void expect_same_speckles(const Disparities& image, std::int16_t invalid, int min_size, int max_step,
                          int min_texture = 0) {
    Random random(17);
    Size size(random);
    size.width = image.width();
    size.height = image.height();
    const TexturedPair pair(random, size);
    const RegionTest test{invalid, min_size, max_step, min_texture, pair.left.plane(), pair.right.plane()};
    Disparities expected = image;
    std::vector<std::byte> memory(reference::speckle_scratch(image.width(), image.height()));
    reference::speckle(expected.plane(), test, memory);
    ASSERT_EQ(without_speckles(image, test, pair), expected.pixels())
        << image.width() << "x" << image.height() << ", size " << min_size << ", step " << max_step << ", texture "
        << min_texture;
}

TEST_F(CudaPost, SpeckleEqualsTheReference) {
    Random random(91);
    for (int round = 0; round < 40 / one_round_of; ++round) {
        const Variation variation(round);
        const Size size(random);
        const DisparityRange range = any_range(random);
        expect_same_speckles(disparities(random, size, range), invalid_disparity(range),
                             pick(random, 1, pick(random, 0, 1) == 0 ? 8 : 400), pick(random, 0, 60),
                             pick(random, 0, 1) * pick(random, 1, 30));
    }
}

TEST_F(CudaPost, SpeckleEqualsTheReferenceOnCombsSpiralsAndChessboards) {
    constexpr std::int16_t invalid = -16;
    constexpr int side = 67;
    int n = 0;
    for (const Shape shape : speckle_shapes) {
        for (const int min_size : {2, 500, side * side, side * side + 1}) {
            if (++n % one_round_of == 0) {
                const Variation variation(n);
                expect_same_speckles(slope_in(shape, side, invalid), invalid, min_size, 1);
            }
        }
    }
}

struct Finished {
    std::vector<std::int16_t> disparity;
    std::vector<std::uint8_t> confidence;
    std::vector<std::uint16_t> depth;
    bool operator==(const Finished&) const = default;
};

struct ToFinish {
    Disparities filtered, right_winner;
    Image<std::uint8_t> confidence;
    DisparityRange range;
    bool interpolate;
    DepthScale scale;
    bool calibrated;
};

Finished finished(const ToFinish& from) {
    const int width = from.filtered.width();
    const int height = from.filtered.height();
    const cuda::Stream stream;
    const OnDevice<std::int16_t> filtered(from.filtered), right(from.right_winner);
    const OnDevice<std::uint8_t> measured(from.confidence);
    const OnDevice<std::int16_t> disparity(Disparities(width, height, 77));
    const OnDevice<std::uint8_t> confidence(Image<std::uint8_t>(width, height, 77));
    const OnDevice<std::uint16_t> depth(Image<std::uint16_t>(width, height, 77));
    const OnDevice<std::uint32_t> count(Image<std::uint32_t>(1, 1, 77));
    std::uint32_t* const counted = count.at(stream);  // puts it there: once
    cuda::count_measured({width, height, invalid_disparity(from.range), filtered.at(stream), counted}, stream.get());
    cuda::interpolate_depth({width,
                             height,
                             on_device(from.range),
                             from.interpolate ? counted : nullptr,
                             filtered.at(stream),
                             right.at(stream),
                             measured.at(stream),
                             {from.scale.k, from.scale.offset16},
                             cuda::ConfidenceJob(from.calibrated),
                             disparity.at(stream),
                             confidence.at(stream),
                             depth.at(stream)},
                            stream.get());
    return {disparity.found(stream), confidence.found(stream), depth.found(stream)};
}

/// Step 11 fills from one measured pixel of 20 on.
bool enough_is_measured(const ToFinish& from) {
    const std::vector<std::int16_t> pixels = from.filtered.pixels();
    const auto rejected = std::count(pixels.begin(), pixels.end(), invalid_disparity(from.range));
    return 20 * (static_cast<std::ptrdiff_t>(pixels.size()) - rejected) >= static_cast<std::ptrdiff_t>(pixels.size());
}

Finished expected_of(const ToFinish& from) {
    const std::int16_t invalid = invalid_disparity(from.range);
    Disparities disparity = from.filtered;
    Image<std::uint8_t> confidence = from.confidence;
    Image<std::uint16_t> depth(disparity.width(), disparity.height());
    reference::finish_confidence(std::as_const(disparity).plane(), invalid, from.calibrated, confidence.plane(),
                                 disparity.rows());
    if (from.interpolate && enough_is_measured(from)) {
        std::vector<std::byte> memory(reference::interpolate_scratch(disparity.width(), disparity.height()));
        reference::interpolate(disparity.plane(), from.right_winner.plane(), from.range, memory);
    }
    reference::depth(std::as_const(disparity).plane(), invalid, from.scale, depth.plane(), disparity.rows());
    return {disparity.pixels(), confidence.pixels(), depth.pixels()};
}

TEST_F(CudaPost, InterpolationConfidenceAndDepthEqualTheReference) {
    Random random(92);
    for (int round = 0; round < 60 / one_round_of; ++round) {
        const Variation variation(round);
        const Size size(random);
        const DisparityRange range = any_range(random);
        const int percent = pick(random, 0, 100);
        Disparities start = disparities(random, size, range);
        for (std::int16_t& value : start.pixels()) {
            value = pick(random, 1, 100) <= percent ? invalid_disparity(range) : value;
        }
        const ToFinish all{start,
                           winners(random, size, range),
                           noise(random, size.width, size.height),
                           range,
                           round % 4 != 0,
                           any_scale(random),
                           round % 2 == 0};
        ASSERT_TRUE(finished(all) == expected_of(all)) << "round " << round << ", " << percent << " % rejected, k "
                                                       << all.scale.k << ", offset " << all.scale.offset16;
    }
}

TEST_F(CudaPost, GuidedMedianAndItsDepthEqualTheReference) {
    Random random(94);
    for (int round = 0; round < 60 / one_round_of; ++round) {
        const Variation variation(round);
        const Size size(random);
        const DisparityRange range = any_range(random);
        const DepthScale scale = any_scale(random);
        const int side = pick(random, 0, 1) == 0 ? 5 : 7;
        const Disparities start = disparities(random, size, range);
        const Image<std::uint8_t> image = noise(random, size.width, size.height, 0, pick(random, 0, 255));

        const cuda::Stream stream;
        const OnDevice<std::int16_t> filled(start), out(Disparities(size.width, size.height, 77));
        const OnDevice<std::uint8_t> guide(image);
        const OnDevice<std::uint16_t> depth(Image<std::uint16_t>(size.width, size.height, 77));
        cuda::guided_median({size.width,
                             size.height,
                             on_device(range),
                             side,
                             filled.at(stream),
                             {guide.at(stream), size.width, size.height, size.width},
                             {scale.k, scale.offset16},
                             out.at(stream),
                             depth.at(stream)},
                            stream.get());

        const std::int16_t invalid = invalid_disparity(range);
        Disparities expected(size.width, size.height);
        reference::guided_median(start.plane(), image.plane(), invalid, side, expected.plane(), expected.rows());
        Image<std::uint16_t> expected_depth(size.width, size.height);
        reference::depth(std::as_const(expected).plane(), invalid, scale, expected_depth.plane(), expected.rows());
        ASSERT_EQ(out.found(stream), expected.pixels()) << "round " << round << ", size " << side;
        ASSERT_EQ(depth.found(stream), expected_depth.pixels()) << "round " << round << ", size " << side;
    }
}

void expect_errors_of_the_reference(const Disparities& disparity, const Image<std::uint8_t>& confidence,
                                    const DepthErrorScale& scale) {
    const int width = disparity.width();
    const int height = disparity.height();
    const cuda::Stream stream;
    const OnDevice<std::int16_t> in(disparity);
    const OnDevice<std::uint8_t> measured(confidence);
    const OnDevice<std::uint16_t> error(Image<std::uint16_t>(width, height, 77));
    cuda::depth_error({width, height, in.at(stream), measured.at(stream), scale, error.at(stream)}, stream.get());
    Image<std::uint16_t> expected(width, height);
    reference::depth_error(disparity.plane(), confidence.plane(), scale, expected.plane(), {0, height});
    ASSERT_EQ(error.found(stream), expected.pixels())
        << width << 'x' << height << ", numerator " << scale.numerator << ", offset " << scale.offset16;
}

TEST_F(CudaPost, DepthErrorEqualsTheReference) {
    Random random(95);
    for (int round = 0; round < 60 / one_round_of; ++round) {
        const Variation variation(round);
        const Size size(random);
        expect_errors_of_the_reference(disparities(random, size, any_range(random)),
                                       noise(random, size.width, size.height, 0, round % 2 == 0 ? 1 : 255),
                                       any_error_scale(random));
        ASSERT_FALSE(HasFatalFailure()) << "round " << round;
    }
    const Disparities all = every_disparity();
    for (int round = 0; round < (all_rounds ? 12 : 1); ++round) {
        expect_errors_of_the_reference(all, Image<std::uint8_t>(all.width(), all.height(), 9),
                                       error_scale_at_an_edge(random, round));
        ASSERT_FALSE(HasFatalFailure()) << "round " << round;
    }
}

TEST_F(CudaPost, DepthEqualsTheReferenceForEveryDisparityAtTheEdges) {
    Random random(93);
    const Disparities all = every_disparity();
    const Disparities right(all.width(), all.height());
    for (int round = 0; round < (all_rounds ? 12 : 1); ++round) {
        const ToFinish from{all,     right, Image<std::uint8_t>(all.width(), all.height(), 9),
                            {0, 16}, false, scale_at_an_edge(random, round),
                            false};
        ASSERT_TRUE(finished(from) == expected_of(from)) << "k " << from.scale.k << ", offset " << from.scale.offset16;
    }
}

}  // namespace
}  // namespace disparityd::test

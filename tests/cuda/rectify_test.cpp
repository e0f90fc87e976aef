// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>

#include "tests/cuda/device_under_test.h"
#include "tests/kernels/rectify/rectify_inputs.h"

namespace disparityd::test {
namespace {

using CudaRectify = CudaDevice;

struct FrameSize {
    int width, height;
};

constexpr int width = 37;
constexpr int height = 21;
constexpr int eye_width = 44;
constexpr int raw_height = 26;

struct Rectified {
    Image<std::uint8_t> left, right, colour, right_colour;
};

Rectified rectified(Matcher& matcher, FrameSize size, const RawImage& raw, const Rectifier& rectifier, bool colour) {
    Rectified out{{size.width, size.height, 1},
                  {size.width, size.height, 2},
                  {3 * size.width, size.height, 3},
                  {3 * size.width, size.height, 4}};
    FrameView view;
    view.raw = raw;
    view.rectifier = &rectifier;
    view.left = out.left.plane();
    view.right = out.right.plane();
    view.left_colour = colour ? out.colour.plane() : Plane<std::uint8_t>{};
    view.right_colour = colour ? out.right_colour.plane() : Plane<std::uint8_t>{};
    Serial serial;
    std::chrono::nanoseconds time{};
    matcher.run(0, view, serial, {&time, 1});
    return out;
}
Rectified rectified(Matcher& matcher, const RawImage& raw, const Rectifier& rectifier, bool colour) {
    return rectified(matcher, {width, height}, raw, rectifier, colour);
}

std::unique_ptr<Matcher> matcher_of(std::string_view name, FrameSize size = {width, height}) {
    return backend(name).create({size.width, size.height, default_options(Method::sad, {0, 16})});
}

void expect_equal(const Rectified& found, const Rectified& expected) {
    EXPECT_EQ(found.left.pixels(), expected.left.pixels());
    EXPECT_EQ(found.right.pixels(), expected.right.pixels());
    EXPECT_EQ(found.colour.pixels(), expected.colour.pixels());
    EXPECT_EQ(found.right_colour.pixels(), expected.right_colour.pixels());
}

void expect_equal_to_reference(FrameSize size, const RawImage& raw, const Rectifier& rectifier) {
    expect_equal(rectified(*matcher_of("cuda", size), size, raw, rectifier, true),
                 rectified(*matcher_of("reference", size), size, raw, rectifier, true));
}

TEST_F(CudaRectify, EqualsTheReferenceForEveryFormat) {
    Random random(60);
    const auto reference = matcher_of("reference");
    const auto cuda = matcher_of("cuda");
    for (const PixelFormat format : pixel_formats) {
        const int row_bytes = 2 * eye_width * bytes_per_pixel(format);
        const auto bytes = noise(random, row_bytes + 13, raw_height);
        const RawImage raw{bytes.plane().data, format, eye_width, raw_height, row_bytes + 13};
        const Map left(random, width, height, raw);
        const Map right(random, width, height, raw);
        for (const bool colour : {false, true}) {
            const Rectifier mapped{true, left.view(), right.view(), 0, 0};
            expect_equal(rectified(*cuda, raw, mapped, colour), rectified(*reference, raw, mapped, colour));
            const Rectifier cropped{false, {}, {}, eye_width - width, raw_height - height};
            expect_equal(rectified(*cuda, raw, cropped, colour), rectified(*reference, raw, cropped, colour));
        }
    }
}

TEST_F(CudaRectify, EqualsTheReferenceOnAnyMap) {
    Random random(62);
    for (int round = 0; round < 60 / one_round_of; ++round) {
        const Variation variation(round);
        const PixelFormat format = pixel_formats[round % 3];
        const Source source(random, format, 2 * pick(random, 1, pick(random, 0, 3) == 0 ? 12 : 100),
                            pick(random, 1, pick(random, 0, 2) == 0 ? 5 : 60));
        const FrameSize size{pick(random, 1, pick(random, 0, 3) == 0 ? 30 : 150), pick(random, 1, 40)};
        const Map left(random, size.width, size.height, source.raw);
        const Map right(random, size.width, size.height, source.raw);
        expect_equal_to_reference(size, source.raw, {true, left.view(), right.view(), 0, 0});
        ASSERT_FALSE(HasFailure()) << "round " << round;
    }
}

TEST_F(CudaRectify, EqualsTheReferenceOnEveryFractionBetweenExtremes) {
    Random random(63);
    const Source source = extremes(random, 80, 64);
    const Map map = every_fraction(random, 64, 60, source.raw);
    expect_equal_to_reference({64, 60}, source.raw, {true, map.view(), map.view(), 0, 0});
}

TEST_F(CudaRectify, EqualsTheReferenceOnEveryColour) {
    for (int luma = 0; luma < 256; luma += all_rounds ? 51 : 200) {
        const std::vector<std::uint8_t> bytes = every_colour(luma);
        expect_equal_to_reference({512, 256}, {bytes.data(), PixelFormat::yuyv, 512, 256, 2048}, {});
        ASSERT_FALSE(HasFailure()) << "luma " << luma;
    }
}

TEST_F(CudaRectify, MapsAreTakenAgainWhenTheirIdChanges) {
    Random random(61);
    const auto reference = matcher_of("reference");
    const auto cuda = matcher_of("cuda");
    const auto bytes = noise(random, 2 * eye_width, raw_height);
    const RawImage raw{bytes.plane().data, PixelFormat::grey8, eye_width, raw_height, 2 * eye_width};
    for (const std::uint64_t id : std::initializer_list<std::uint64_t>{1, 2, 0, 0, 1}) {
        const Map left(random, width, height, raw);
        const Map right(random, width, height, raw);
        Rectifier rectifier{true, left.view(), right.view(), 0, 0};
        rectifier.id = id;
        expect_equal(rectified(*cuda, raw, rectifier, true), rectified(*reference, raw, rectifier, true));
        expect_equal(rectified(*cuda, raw, rectifier, true), rectified(*reference, raw, rectifier, true));
    }
}

TEST_F(CudaRectify, ARegionOutsideTheFrameIsRefused) {
    const auto cuda = matcher_of("cuda");
    const Image<std::uint8_t> bytes(2 * eye_width, raw_height);
    const RawImage raw{bytes.plane().data, PixelFormat::grey8, eye_width, raw_height, 2 * eye_width};
    EXPECT_THROW(rectified(*cuda, raw, {false, {}, {}, eye_width - width + 1, 0}, false), std::invalid_argument);
    EXPECT_THROW(rectified(*cuda, raw, {false, {}, {}, 0, -1}, false), std::invalid_argument);
}

}  // namespace
}  // namespace disparityd::test

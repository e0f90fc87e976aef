// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>

#include "tests/cuda/device_under_test.h"
#include "tests/kernels/support.h"

namespace disparityd::test {
namespace {

using CudaRectify = CudaDevice;

constexpr int width = 37;
constexpr int height = 21;
constexpr int eye_width = 44;
constexpr int raw_height = 26;

// Maps that also point outside the source, at its last row and column, and far away.
struct Maps {
    explicit Maps(Random& random) : xy(2 * width, height), fraction(width, height) {
        for (std::int16_t& value : xy.pixels()) {
            value = static_cast<std::int16_t>(pick(random, 0, 9) == 0 ? pick(random, -32768, 32767)
                                                                      : pick(random, -2, eye_width + 1));
        }
        for (std::uint16_t& value : fraction.pixels()) {
            value = static_cast<std::uint16_t>(pick(random, 0, 1023));
        }
    }
    RectifyMap view() const { return {xy.plane(), fraction.plane()}; }

    Image<std::int16_t> xy;
    Image<std::uint16_t> fraction;
};

struct Rectified {
    Image<std::uint8_t> left{width, height, 1};
    Image<std::uint8_t> right{width, height, 2};
    Image<std::uint8_t> colour{3 * width, height, 3};
};

Rectified rectified(Matcher& matcher, const RawImage& raw, const Rectifier& rectifier, bool colour) {
    Rectified out;
    FrameView view;
    view.raw = raw;
    view.rectifier = &rectifier;
    view.left = out.left.plane();
    view.right = out.right.plane();
    view.left_colour = colour ? out.colour.plane() : Plane<std::uint8_t>{};
    Serial serial;
    std::chrono::nanoseconds time{};
    matcher.run(0, view, serial, {&time, 1});
    return out;
}

std::unique_ptr<Matcher> matcher_of(std::string_view name) {
    return backend(name).create({width, height, default_options(Method::sad, {0, 16})});
}

void expect_equal(const Rectified& found, const Rectified& expected) {
    EXPECT_EQ(found.left.pixels(), expected.left.pixels());
    EXPECT_EQ(found.right.pixels(), expected.right.pixels());
    EXPECT_EQ(found.colour.pixels(), expected.colour.pixels());
}

TEST_F(CudaRectify, EqualsTheReferenceForEveryFormat) {
    Random random(60);
    const Maps left(random);
    const Maps right(random);
    const auto reference = matcher_of("reference");
    const auto cuda = matcher_of("cuda");
    for (const PixelFormat format : {PixelFormat::grey8, PixelFormat::yuyv, PixelFormat::bgr24}) {
        const int row_bytes = 2 * eye_width * bytes_per_pixel(format);
        const auto bytes = noise(random, row_bytes + 13, raw_height);
        const RawImage raw{bytes.plane().data, format, eye_width, raw_height, row_bytes + 13};
        for (const bool colour : {false, true}) {
            const Rectifier mapped{true, left.view(), right.view(), 0, 0};
            expect_equal(rectified(*cuda, raw, mapped, colour), rectified(*reference, raw, mapped, colour));
            const Rectifier cropped{false, {}, {}, eye_width - width, raw_height - height};
            expect_equal(rectified(*cuda, raw, cropped, colour), rectified(*reference, raw, cropped, colour));
        }
    }
}

TEST_F(CudaRectify, MapsAreTakenAgainWhenTheirIdChanges) {
    Random random(61);
    const auto reference = matcher_of("reference");
    const auto cuda = matcher_of("cuda");
    const auto bytes = noise(random, 2 * eye_width, raw_height);
    const RawImage raw{bytes.plane().data, PixelFormat::grey8, eye_width, raw_height, 2 * eye_width};
    for (const std::uint64_t id : std::initializer_list<std::uint64_t>{1, 2, 0, 0, 1}) {
        const Maps left(random);
        const Maps right(random);
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

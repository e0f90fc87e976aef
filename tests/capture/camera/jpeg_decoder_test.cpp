// SPDX-License-Identifier: Apache-2.0
#include "capture/jpeg_decoder.h"

#include <algorithm>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include "tests/capture/camera/made_jpeg.h"

namespace disparityd::capture {
namespace {

using test::Bytes;
using test::made_jpeg;
using test::planes_of;
using test::yuyv_of;
using ::testing::HasSubstr;
using ::testing::IsNull;
using ::testing::NotNull;

constexpr int jpeg_width = 96;
constexpr int jpeg_height = 40;
constexpr EyeLayout side_by_side{jpeg_width / 2, jpeg_height, false, false};

Bytes frame_of(const EyeLayout& layout) {
    return Bytes(static_cast<std::size_t>(4 * layout.eye_width * layout.eye_height));
}

/// The text of the decoder's problem; empty when there is none.
std::string problem_of(const Bytes& jpeg) {
    JpegDecoder decoder(side_by_side);
    Bytes frame = frame_of(side_by_side);
    const char* problem = decoder.decode(jpeg, frame.data());
    return problem == nullptr ? "" : problem;
}

/// Where the marker begins: 0xff, then `code`.
std::size_t find_marker(const Bytes& jpeg, std::uint8_t code, std::size_t from = 2) {
    const Bytes marker{0xff, code};
    const auto found =
        std::search(jpeg.begin() + static_cast<std::ptrdiff_t>(from), jpeg.end(), marker.begin(), marker.end());
    return static_cast<std::size_t>(found - jpeg.begin());
}

TEST(JpegDecoder, GivesTheValuesThatTurboJpegGives) {
    // Sizes that end inside a unit of the JPEG, too; an eye's jpeg_width is even.
    for (const auto& [wide, high] : {std::pair{96, 40}, {64, 16}, {100, 37}, {4, 1}, {260, 50}}) {
        for (const int sampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_GRAY, TJSAMP_440, TJSAMP_411}) {
            const Bytes jpeg = made_jpeg(wide, high, sampling, 7);
            const EyeLayout layout{wide / 2, high, false, false};
            JpegDecoder decoder(layout);
            Bytes frame = frame_of(layout);
            ASSERT_THAT(decoder.decode(jpeg, frame.data()), IsNull()) << wide << ' ' << sampling;
            EXPECT_EQ(frame, yuyv_of(planes_of(jpeg, wide, high), wide, high))
                << wide << 'x' << high << ' ' << sampling;
        }
    }
}

/// libjpeg-turbo has code for each instruction set, and code without vectors, which JSIMD_FORCENONE=1 chooses.
TEST(JpegDecoder, GivesTheSameBytesOnEveryMachine) {
    std::uint64_t hash = 14695981039346656037U;
    for (const int sampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420}) {
        JpegDecoder decoder(side_by_side);
        Bytes frame = frame_of(side_by_side);
        ASSERT_THAT(decoder.decode(made_jpeg(jpeg_width, jpeg_height, sampling, 11), frame.data()), IsNull());
        for (const std::uint8_t byte : frame) {
            hash = (hash ^ byte) * 1099511628211U;
        }
    }
    EXPECT_EQ(hash, 3139204798500704505U);
}

TEST(JpegDecoder, PutsTheEyesWhereTheyBelong) {
    const Bytes jpeg = made_jpeg(jpeg_width, jpeg_height, TJSAMP_422, 3);
    const Bytes sent = yuyv_of(planes_of(jpeg, jpeg_width, jpeg_height), jpeg_width, jpeg_height);
    for (const bool top_bottom : {false, true}) {
        for (const bool right_first : {false, true}) {
            const EyeLayout layout{top_bottom ? jpeg_width : jpeg_width / 2, top_bottom ? jpeg_height / 2 : jpeg_height,
                                   top_bottom, right_first};
            JpegDecoder decoder(layout);
            Bytes frame = frame_of(layout);
            ASSERT_THAT(decoder.decode(jpeg, frame.data()), IsNull());
            const auto row_bytes = static_cast<std::size_t>(2 * jpeg_width);
            const auto eye_bytes = static_cast<std::size_t>(2 * layout.eye_width);
            for (std::size_t y = 0; y < static_cast<std::size_t>(layout.eye_height); ++y) {
                for (const std::size_t eye : {0U, 1U}) {
                    const std::size_t half = right_first ? 1 - eye : eye;
                    const std::size_t from = top_bottom
                                                 ? (y + half * static_cast<std::size_t>(layout.eye_height)) * row_bytes
                                                 : y * row_bytes + half * eye_bytes;
                    ASSERT_TRUE(std::equal(sent.data() + from, sent.data() + from + eye_bytes,
                                           frame.data() + (2 * y + eye) * eye_bytes))
                        << top_bottom << right_first << " row " << y << " eye " << eye;
                }
            }
        }
    }
}

TEST(JpegDecoder, TakesFramesWithoutHuffmanTables) {
    const Bytes whole = made_jpeg(jpeg_width, jpeg_height, TJSAMP_422, 5);
    Bytes bare = whole;
    for (std::size_t at = find_marker(bare, 0xc4); at < bare.size(); at = find_marker(bare, 0xc4)) {
        const std::size_t size = 2U + (std::size_t{bare[at + 2]} << 8U) + bare[at + 3];
        bare.erase(bare.begin() + static_cast<std::ptrdiff_t>(at),
                   bare.begin() + static_cast<std::ptrdiff_t>(at + size));
    }
    ASSERT_LT(bare.size(), whole.size());
    JpegDecoder decoder(side_by_side);
    Bytes frame = frame_of(side_by_side);
    ASSERT_THAT(decoder.decode(bare, frame.data()), IsNull());
    EXPECT_EQ(frame, yuyv_of(planes_of(whole, jpeg_width, jpeg_height), jpeg_width, jpeg_height));
}

TEST(JpegDecoder, RefusesAJpegThatWasCutOffAnywhere) {
    const Bytes whole = made_jpeg(jpeg_width, jpeg_height, TJSAMP_422, 1);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        EXPECT_NE(problem_of(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))), "") << size;
    }
    EXPECT_EQ(problem_of(whole), "");
}

TEST(JpegDecoder, FillingUpIsNoDamage) {
    const Bytes whole = made_jpeg(jpeg_width, jpeg_height, TJSAMP_422, 1);
    Bytes behind = whole;
    behind.resize(behind.size() + 1000, 0xab);
    EXPECT_EQ(problem_of(behind), "");
    for (const std::size_t padding : {1U, 2U, 3U, 64U}) {
        Bytes filled = whole;
        filled.insert(filled.end() - 2, padding, 0);
        EXPECT_EQ(problem_of(filled).empty(), padding < 4) << padding << problem_of(filled);
    }
}

TEST(JpegDecoder, RefusesWhatNoCameraSends) {
    EXPECT_THAT(problem_of(made_jpeg(jpeg_width, jpeg_height + 8, TJSAMP_422, 1)),
                HasSubstr("has 96x48 pixels, expected 96x40"));
    EXPECT_THAT(problem_of(made_jpeg(jpeg_width, jpeg_height, TJSAMP_422, 1, TJFLAG_PROGRESSIVE)),
                HasSubstr("progressive"));
    Bytes odd = made_jpeg(jpeg_width, jpeg_height, TJSAMP_422, 1);
    // The luma's sampling becomes that of the chroma, and the other way round.
    const std::size_t frame_header = find_marker(odd, 0xc0);
    odd[frame_header + 11] = 0x11;
    odd[frame_header + 14] = 0x21;
    EXPECT_THAT(problem_of(odd), HasSubstr("in a way that no camera does"));
}

/// A JPEG has no checksum: damage that leaves a JPEG behind cannot be seen. What TurboJPEG warns of, we refuse; what it
/// takes, we give the same pixels of.
TEST(JpegDecoder, DamageIsRefusedAndHurtsNoLaterFrame) {
    std::mt19937 random(43);
    JpegDecoder decoder(side_by_side);
    Bytes frame = frame_of(side_by_side);
    int refused = 0;
    for (unsigned i = 0; i < 300; ++i) {
        const Bytes whole = made_jpeg(jpeg_width, jpeg_height, i % 2 == 0 ? TJSAMP_422 : TJSAMP_420, i);
        Bytes damaged = whole;
        const std::size_t at = random() % damaged.size();
        const std::size_t length = std::min<std::size_t>(damaged.size() - at, 1 + random() % 64);
        for (std::size_t k = at; k < at + length; ++k) {
            damaged[k] = static_cast<std::uint8_t>(i % 3 == 0 ? 0 : random());
        }
        if (i % 5 == 4) {
            damaged.resize(at);
        }
        const char* problem = decoder.decode(damaged, frame.data());
        const test::Planes planes = planes_of(damaged, jpeg_width, jpeg_height);
        if (problem == nullptr) {
            EXPECT_TRUE(planes.clean) << i;
            EXPECT_EQ(frame, yuyv_of(planes, jpeg_width, jpeg_height)) << i;
        }
        refused += problem != nullptr ? 1 : 0;
        ASSERT_THAT(decoder.decode(whole, frame.data()), IsNull()) << i;
        ASSERT_EQ(frame, yuyv_of(planes_of(whole, jpeg_width, jpeg_height), jpeg_width, jpeg_height)) << i;
    }
    EXPECT_GT(refused, 200);
    RecordProperty("refused", refused);
}

}  // namespace
}  // namespace disparityd::capture

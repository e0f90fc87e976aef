// SPDX-License-Identifier: Apache-2.0
#include "trust/row_offsets.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/trust/textured_pair.h"

namespace disparityd::trust {
namespace {

using test::TexturedPair;

RowOffsets offsets_of(TexturedPair& pair) {
    RowOffsets offsets;
    for (std::uint32_t turn = 0; turn < 4; ++turn) {
        offsets.add(pair.view(), turn);
    }
    return offsets;
}

TEST(RowOffsets, EachBandTellsHowMuchLowerTheRightEyeIs) {
    for (const double rows : {-2.25, -0.5, 0.0, 0.5, 1.0, 2.25}) {
        TexturedPair pair;
        pair.lower_right_eye(rows);
        const RowOffsets offsets = offsets_of(pair);
        for (int band = 0; band < RowOffsets::bands; ++band) {
            ASSERT_TRUE(offsets.median(band)) << rows << " rows, band " << band;
            EXPECT_NEAR(*offsets.median(band), rows * RowOffsets::unit, 2) << rows << " rows, band " << band;
        }
    }
}

// A patch beyond the reach has its least cost at the end, which says nothing.
TEST(RowOffsets, OffsetsBeyondTheReachAreNotCounted) {
    TexturedPair pair;
    pair.lower_right_eye(20);
    const RowOffsets offsets = offsets_of(pair);
    int known = 0;
    for (int band = 0; band < RowOffsets::bands; ++band) {
        known += offsets.median(band) ? 1 : 0;
    }
    EXPECT_EQ(known, 0);
}

TEST(RowOffsets, PixelsThatWereNotMeasuredAreNotCounted) {
    TexturedPair pair;
    std::fill(pair.confidence.begin(), pair.confidence.end(), std::uint8_t{0});
    EXPECT_FALSE(offsets_of(pair).median(4));
}

TEST(RowOffsets, AFlatImageHasNone) {
    TexturedPair pair;
    std::fill(pair.left.begin(), pair.left.end(), std::uint8_t{90});
    std::fill(pair.right.begin(), pair.right.end(), std::uint8_t{90});
    EXPECT_FALSE(offsets_of(pair).median(4));
}

// The windows around these lie outside of the right image.
TEST(RowOffsets, DisparitiesOfAnySizeAreTaken) {
    TexturedPair pair;
    for (const int disparity : {-32768, -4096, 4096, 32767}) {
        std::fill(pair.disparities.begin(), pair.disparities.end(), static_cast<std::int16_t>(disparity));
        EXPECT_FALSE(offsets_of(pair).median(4)) << disparity;
    }
}

}  // namespace
}  // namespace disparityd::trust

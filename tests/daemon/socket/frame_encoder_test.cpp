// SPDX-License-Identifier: Apache-2.0
//
// What goes over a socket for each selection, byte by byte, and which of it is copied.
#include "daemon/socket/frames/frame_encoder.h"

#include <gtest/gtest.h>
#include <zstd.h>

#include "daemon/socket/frames/frame_ring.h"
#include "daemon/socket/frames/outgoing_message.h"
#include "tests/daemon/socket/pattern_frames.h"

namespace disparityd::test {
namespace {

constexpr std::uint32_t width = 64;
constexpr std::uint32_t height = 48;
const std::vector<v1::Product> all = all_products();

std::vector<std::uint8_t> joined(const daemon::Payload& payload) {
    std::vector<std::uint8_t> bytes;
    for (const auto& part : payload.parts()) {
        bytes.insert(bytes.end(), part.begin(), part.end());
    }
    return bytes;
}

class FrameEncoderTest : public testing::Test {
protected:
    daemon::FrameHandle frame() { return pool_.copy(feed_.next(), ~0U); }

    /// Each plane cut out row by row into memory of its own, and compressed from there.
    static std::vector<std::uint8_t> cut(std::uint64_t n, const daemon::Selection& selection) {
        daemon::Selection::Region region = selection.region;
        if (region.width == 0) {
            region = {0, 0, width, height};
        }
        std::vector<std::uint8_t> bytes;
        for (const v1::Product product : selection.products) {
            const auto plane = PatternFrames::expected(n, product, region.x, region.y, region.width, region.height);
            if (selection.encoding == v1::RAW) {
                bytes.insert(bytes.end(), plane.begin(), plane.end());
                continue;
            }
            std::vector<std::uint8_t> packed(ZSTD_compressBound(plane.size()));
            packed.resize(ZSTD_compress(packed.data(), packed.size(), plane.data(), plane.size(), 1));
            bytes.insert(bytes.end(), packed.begin(), packed.end());
        }
        return bytes;
    }

    PatternFrames feed_{width, height, all};
    daemon::FramePool pool_{feed_.layout(), 2};
    daemon::FrameEncoder encoder_;
};

TEST_F(FrameEncoderTest, EverySelectionHasTheBytesOfPlanesThatAreCutOut) {
    const std::vector<daemon::Selection::Region> regions{
        {}, {0, 0, width, height}, {0, 7, width, 20}, {0, height - 1, width, 1}, {10, 20, 33, 7}, {63, 47, 1, 1}};
    std::uint64_t n = 0;
    for (const auto& products : {all, {v1::LEFT_COLOUR, v1::DISPARITY}, {v1::LEFT}}) {
        for (const auto& region : regions) {
            for (const v1::Encoding encoding : {v1::RAW, v1::ZSTD}) {
                const daemon::Selection selection{products, region, encoding};
                const auto encoded = encoder_.encode(frame(), selection);
                const auto bytes = joined(encoded.bytes);
                EXPECT_EQ(bytes, cut(n, selection)) << "frame " << n;
                EXPECT_EQ(bytes.size(), encoded.bytes.size());
                ++n;
                ASSERT_EQ(encoded.planes.size(), products.size());
                std::size_t described = 0;
                for (std::size_t i = 0; i < products.size(); ++i) {
                    const v1::PlaneInfo& plane = encoded.planes[i];
                    EXPECT_EQ(plane.product(), products[i]);
                    const bool record = daemon::is_record(products[i]);
                    const auto shape = daemon::product_shape(feed_.layout(), products[i]);
                    EXPECT_EQ(plane.width(), record || region.width == 0 ? shape.width : region.width);
                    EXPECT_EQ(plane.height(), record || region.width == 0 ? shape.height : region.height);
                    EXPECT_EQ(plane.bytes_per_pixel(), shape.bytes_per_pixel);
                    EXPECT_EQ(plane.encoding(), encoding);
                    described += plane.payload_bytes();
                }
                EXPECT_EQ(described, bytes.size());
            }
        }
    }
}

TEST_F(FrameEncoderTest, WholeRowsOfARawFrameAreNotCopied) {
    const daemon::FrameHandle held = frame();
    for (const daemon::Selection::Region& region :
         {daemon::Selection::Region{}, daemon::Selection::Region{0, 5, width, 9}}) {
        const auto encoded = encoder_.encode(held, {all, region, v1::RAW});
        EXPECT_EQ(encoded.bytes.own_bytes(), 0U);
        ASSERT_EQ(encoded.bytes.parts().size(), all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            const auto& plane = held->planes.at(static_cast<std::size_t>(all[i]));
            const std::size_t skipped = daemon::is_record(all[i]) ? 0 : region.y;
            EXPECT_EQ(encoded.bytes.parts()[i].data(),
                      plane.data() + skipped * width * proto::product_facts(all[i]).bytes_per_pixel);
        }
    }
    const auto narrow = encoder_.encode(held, {{v1::LEFT}, {1, 0, width - 1, height}, v1::RAW});
    EXPECT_EQ(narrow.bytes.own_bytes(), (width - 1) * height);
    EXPECT_EQ(held.use_count(), 1) << "what was cut out needs the frame no more";
}

TEST_F(FrameEncoderTest, ACopyKeepsTheBytesAndFreesTheFrame) {
    daemon::FramePool one(feed_.layout(), 1);
    auto encoded = encoder_.encode(one.copy(feed_.next(), ~0U), {all, {}, v1::RAW});
    EXPECT_EQ(one.copy(feed_.next(), ~0U), nullptr);
    encoded.bytes.keep_copy();
    EXPECT_EQ(encoded.bytes.own_bytes(), encoded.bytes.size());
    EXPECT_NE(one.copy(feed_.next(), ~0U), nullptr) << "its memory holds another frame now";
    EXPECT_EQ(joined(encoded.bytes), cut(0, {all, {}, v1::RAW}));
}

TEST_F(FrameEncoderTest, AFrameThatLeavesTheRingIsCopiedForThoseWhoStillNeedIt) {
    daemon::FramePool two(feed_.layout(), 2);
    daemon::FrameRing ring(1);
    const daemon::Selection selection{all, {}, v1::RAW};
    ring.put(two.copy(feed_.next(), ~0U));
    const auto slow = ring.encoded(ring.next(0), selection);
    EXPECT_EQ(ring.encoded(ring.next(0), selection), slow) << "who want the same share it";
    EXPECT_EQ(slow->bytes.own_bytes(), 0U);
    for (std::uint64_t n = 1; n < 6; ++n) {
        auto copy = two.copy(feed_.next(), ~0U);
        ASSERT_NE(copy, nullptr) << "the pool has no memory for frame " << n;
        ring.put(std::move(copy));
        EXPECT_EQ(joined(ring.encoded(ring.next(n), selection)->bytes), cut(n, selection));
    }
    EXPECT_EQ(slow->bytes.own_bytes(), slow->bytes.size());
    EXPECT_EQ(joined(slow->bytes), cut(0, selection));
    const auto last = ring.encoded(ring.next(5), selection);
    ring.clear();
    EXPECT_EQ(last->bytes.own_bytes(), last->bytes.size());
    EXPECT_EQ(joined(last->bytes), cut(5, selection));
}

// The copy may come between any two writes.
TEST_F(FrameEncoderTest, AMessageGoesOnWhereItStoppedWhenItsPlanesAreCopied) {
    const std::vector<std::uint8_t> head{1, 2, 3, 4, 5};
    const daemon::Selection selection{{v1::LEFT, v1::DISPARITY}, {0, 0, width, 2}, v1::RAW};
    std::vector<std::uint8_t> expected = head;
    const auto planes = cut(0, selection);
    expected.insert(expected.end(), planes.begin(), planes.end());
    const daemon::FrameHandle held = frame();
    for (std::size_t stop = 0; stop <= expected.size(); ++stop) {
        const auto encoded = std::make_shared<daemon::EncodedPlanes>(encoder_.encode(held, selection));
        daemon::OutgoingMessage message;
        message.start(encoded) = head;
        ASSERT_EQ(message.size(), expected.size());
        std::vector<std::uint8_t> sent;
        const auto send = [&](std::size_t most) {
            const std::size_t before = sent.size();
            for (const auto& buffer : message.rest()) {
                const auto* data = static_cast<const std::uint8_t*>(buffer.data());
                sent.insert(sent.end(), data, data + std::min(buffer.size(), most - (sent.size() - before)));
            }
            message.sent(sent.size() - before);
        };
        send(stop);
        EXPECT_EQ(message.is_done(), stop == expected.size());
        encoded->bytes.keep_copy();
        send(expected.size());
        EXPECT_TRUE(message.is_done());
        EXPECT_EQ(sent, expected) << "copied after " << stop << " bytes";
    }
}

}  // namespace
}  // namespace disparityd::test

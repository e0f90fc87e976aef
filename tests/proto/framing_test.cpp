// SPDX-License-Identifier: Apache-2.0
#include "proto/framing.h"

#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;

namespace {

template <class Call>
std::string refusal(Call&& call) {
    try {
        call();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Framing, LengthIsLittleEndianAndCountsTheEnvelope) {
    v1::Envelope envelope;
    envelope.mutable_record_start()->set_path(std::string(300, 'x'));
    std::vector<std::uint8_t> bytes(7, 0xee);
    proto::encode(envelope, bytes);
    ASSERT_EQ(bytes.size(), 4 + envelope.ByteSizeLong());
    EXPECT_EQ(bytes[0], envelope.ByteSizeLong() & 0xff);
    EXPECT_EQ(bytes[1], envelope.ByteSizeLong() >> 8);
    EXPECT_EQ(bytes[2], 0);
    EXPECT_EQ(bytes[3], 0);
    EXPECT_EQ(proto::decode_length(std::span<const std::uint8_t, 4>(bytes.data(), 4)), envelope.ByteSizeLong());
    v1::Envelope again;
    proto::decode(std::span(bytes).subspan(4), again);
    EXPECT_EQ(again.record_start().path(), std::string(300, 'x'));
}

TEST(Framing, HugeLengthIsRefused) {
    const std::uint8_t four_gib[4] = {0xff, 0xff, 0xff, 0xff};
    EXPECT_THAT(refusal([&] { proto::decode_length(four_gib); }),
                testing::HasSubstr("4294967295 bytes announced, allowed 1048576"));
    const std::uint8_t limit[4] = {0, 0, 0x10, 0};
    EXPECT_EQ(proto::decode_length(limit), proto::max_envelope_bytes);
    EXPECT_NE(refusal([&] { proto::decode_length(limit, 1000); }), "accepted");
}

TEST(Framing, TooLongAnEnvelopeIsNotSent) {
    v1::Envelope envelope;
    envelope.mutable_error()->set_message(std::string(proto::max_envelope_bytes, 'x'));
    std::vector<std::uint8_t> bytes;
    EXPECT_NE(refusal([&] { proto::encode(envelope, bytes); }), "accepted");
}

TEST(Framing, GarbageIsNoEnvelope) {
    const std::vector<std::uint8_t> garbage{0xff, 0xff, 0xff, 0x01};
    v1::Envelope envelope;
    EXPECT_THAT(refusal([&] { proto::decode(garbage, envelope); }), testing::HasSubstr("4 bytes"));
}

TEST(Framing, UnknownFieldsAreIgnored) {
    // Field 1000, a varint: of a version to come.
    const std::vector<std::uint8_t> bytes{0xc0, 0x3e, 0x05, 0x08, 0x07};
    v1::Envelope envelope;
    proto::decode(bytes, envelope);
    EXPECT_EQ(envelope.payload_bytes(), 7U);
    EXPECT_EQ(envelope.body_case(), v1::Envelope::BODY_NOT_SET);
}

TEST(Framing, PlaneSizesHaveLimits) {
    v1::PlaneInfo plane;
    plane.set_width(16384);
    plane.set_height(16384);
    plane.set_bytes_per_pixel(8);
    EXPECT_EQ(proto::raw_plane_bytes(plane), 16384ULL * 16384 * 8);
    plane.set_width(16385);
    EXPECT_THAT(refusal([&] { proto::raw_plane_bytes(plane); }), testing::HasSubstr("width 16385, allowed 1..16384"));
    plane.set_width(1);
    plane.set_height(0);
    EXPECT_NE(refusal([&] { proto::raw_plane_bytes(plane); }), "accepted");
    plane.set_height(1);
    plane.set_bytes_per_pixel(9);
    EXPECT_NE(refusal([&] { proto::raw_plane_bytes(plane); }), "accepted");
}

}  // namespace

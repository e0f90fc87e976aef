// SPDX-License-Identifier: Apache-2.0
//
// Every field of a frame passes through each converter. The messages are those of disparity.proto, generated with
// reflection, which the daemon's own lack: a field that a converter forgets is found without being named here.
#include <array>
#include <bit>
#include <set>
#include <string>

#include <disparity_client.h>
#include <disparity_client.hpp>
#include <google/protobuf/message.h>
#include <gtest/gtest.h>

#include "proto/frame_message.h"

namespace {

namespace proto = disparityd::proto;
namespace v1 = disparityd::v1;
using google::protobuf::FieldDescriptor;

/// Fields of v1::Frame that belong to one client, not to the frame: the session fills them in.
const std::set<std::string> of_one_client{"region", "skipped", "planes", "sent_monotonic_ns"};

/// Gives every number of a message, and of the messages in it, a value of its own.
void fill_numbers(google::protobuf::Message& message, int& next) {
    const google::protobuf::Descriptor& type = *message.GetDescriptor();
    const google::protobuf::Reflection& fields = *message.GetReflection();
    for (int i = 0; i < type.field_count(); ++i) {
        const FieldDescriptor* field = type.field(i);
        if (of_one_client.contains(field->name())) {
            continue;
        }
        ASSERT_FALSE(field->is_repeated()) << field->full_name();
        ++next;
        switch (field->cpp_type()) {
            case FieldDescriptor::CPPTYPE_INT32: fields.SetInt32(&message, field, -next); break;
            case FieldDescriptor::CPPTYPE_INT64: fields.SetInt64(&message, field, -next); break;
            case FieldDescriptor::CPPTYPE_UINT32: fields.SetUInt32(&message, field, static_cast<unsigned>(next)); break;
            case FieldDescriptor::CPPTYPE_UINT64: fields.SetUInt64(&message, field, static_cast<unsigned>(next)); break;
            case FieldDescriptor::CPPTYPE_DOUBLE: fields.SetDouble(&message, field, next + 0.5); break;
            case FieldDescriptor::CPPTYPE_MESSAGE: fill_numbers(*fields.MutableMessage(&message, field), next); break;
            default: FAIL() << field->full_name() << ": a type that this test does not fill yet";
        }
    }
}

/// A frame of which every byte is another one.
proto::FrameInfo every_byte() {
    std::array<std::uint8_t, sizeof(proto::FrameInfo)> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<std::uint8_t>(i + 1);
    }
    return std::bit_cast<proto::FrameInfo>(bytes);
}

std::string bytes_of(const proto::FrameInfo& info) {
    return {reinterpret_cast<const char*>(&info), sizeof info};
}

TEST(FrameInfo, HasEveryFieldOfTheMessage) {
    v1::Frame message;
    int next = 0;
    fill_numbers(message, next);
    ASSERT_GT(next, 17);
    v1::Frame back;
    proto::fill(back, proto::to_info(message));
    EXPECT_EQ(back.DebugString(), message.DebugString());
}

TEST(FrameInfo, PassesThroughTheMessageWhole) {
    const proto::FrameInfo info = every_byte();
    v1::Frame message;
    proto::fill(message, info);
    EXPECT_EQ(bytes_of(proto::to_info(message)), bytes_of(info));
}

TEST(FrameInfo, GeometryAloneIsThatOfTheFrame) {
    v1::Frame message;
    proto::fill(message, every_byte());
    EXPECT_EQ(proto::to_message(every_byte()).DebugString(), message.geometry().DebugString());
}

TEST(FrameInfo, LeavesWhatBelongsToOneClient) {
    v1::Frame message;
    message.set_skipped(3);
    message.mutable_region()->set_x(4);
    message.add_planes();
    proto::fill(message, every_byte());
    EXPECT_EQ(message.skipped(), 3U);
    EXPECT_EQ(message.region().x(), 4U);
    EXPECT_EQ(message.planes_size(), 1);
}

template <typename Public>
std::string through() {
    Public frame{};
    proto::copy_frame_fields(frame, every_byte());
    proto::FrameInfo back{};
    proto::copy_frame_fields(back, frame);
    return bytes_of(back);
}

TEST(FrameInfo, PassesThroughTheStructuresOfClientsWhole) {
    EXPECT_EQ(through<disparity::Frame>(), bytes_of(every_byte()));
    EXPECT_EQ(through<disparity_frame_info>(), bytes_of(every_byte()));
}

}  // namespace

// SPDX-License-Identifier: Apache-2.0
//
// Schemas and messages that are wrong. other_mcap.cjs compares whole ones with another implementation.
#include "formats/ros_message.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/cdr_writer.h"
#include "tests/formats/refusal.h"

namespace disparityd::formats {
namespace {

using test::refusal;
using testing::ElementsAre;
using testing::HasSubstr;

RosMessage read(const RosSchema& schema, const std::string& cdr) {
    return {schema, {reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size()}};
}

TEST(RosMessage, FieldsHaveThePathsOfTheirMessages) {
    const RosSchema schema =
        parse_ros_schema("a_msgs/msg/Outer",
                         "Inner inner # of the same package\n"
                         "float64[2] two\n"
                         "==========\nMSG: a_msgs/Inner\nuint8[] data\nbuiltin_interfaces/Time at");
    const std::string cdr =
        CdrWriter().u8_sequence(std::vector<std::uint8_t>{5, 6}).i32(9).u32(8).f64(1.5).f64(2.5).take();
    const RosMessage message = read(schema, cdr);
    EXPECT_THAT(message.bytes("inner.data"), ElementsAre(5, 6));
    EXPECT_EQ(message.number("inner.at.sec"), 9);
    EXPECT_EQ(message.number("inner.at.nanosec"), 8);
    EXPECT_THAT(message.numbers("two"), ElementsAre(1.5, 2.5));
    EXPECT_FALSE(message.has("inner"));
    EXPECT_THAT(refusal([&] { message.text("two"); }), HasSubstr("has no field two that is a text"));
    EXPECT_THAT(refusal([&] { message.number("three"); }), HasSubstr("has no field three that is a number"));
}

TEST(RosMessage, WhatIsNoWholeNumberIsRefusedAsOne) {
    const RosSchema schema = parse_ros_schema("a/A", "float64 x");
    const auto read_integer = [&](double value) { return read(schema, CdrWriter().f64(value).take()).integer("x"); };
    EXPECT_EQ(read_integer(-4294967295.0), -4294967295);
    for (const double value : {0.5, 4294967296.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THAT(refusal([&] { read_integer(value); }), HasSubstr("a field x that is no whole number of 32 bits"));
    }
}

TEST(RosMessage, OneThatEndsTooSoonIsRefused) {
    const RosSchema schema = parse_ros_schema("a/A", "string name\nfloat64[] d\nB[] parts\n==========\nMSG: a/B\n");
    const std::string cdr = CdrWriter().text("x").length(1).f64(1).length(3).u8(0).u8(0).u8(0).take();
    EXPECT_EQ(read(schema, cdr).text("name"), "x");
    for (std::size_t size = 0; size < cdr.size(); ++size) {
        EXPECT_THAT(refusal([&] { read(schema, cdr.substr(0, size)); }), testing::Ne("accepted")) << size;
    }
    const std::string many = CdrWriter().text("x").length(0).length(0xffffffff).u8(0).take();
    EXPECT_THAT(refusal([&] { read(schema, many); }), HasSubstr("ends too soon"));
}

TEST(RosMessage, LongListsAreNotKept) {
    const RosSchema schema = parse_ros_schema("a/A", "float32[] points\nuint8 behind");
    const std::string cdr = CdrWriter().f32_sequence(std::vector<float>(5000)).u8(7).take();
    EXPECT_FALSE(read(schema, cdr).has("points"));
    EXPECT_EQ(read(schema, cdr).number("behind"), 7);
}

TEST(RosMessage, MoreFieldsThanAMessageHasAreRefused) {
    std::string parts, bytes;
    for (int i = 0; i < 201; ++i) {
        parts += "B b" + std::to_string(i) + "\n";
        bytes += "uint8 x" + std::to_string(i) + "\n";
    }
    const auto problem_of = [&](const std::string& schema) {
        const RosSchema parsed = parse_ros_schema("a/A", schema);
        return refusal([&] { read(parsed, std::string(50'000, '\0')); });
    };
    EXPECT_THAT(problem_of(parts + "==========\nMSG: a/B\n" + bytes), HasSubstr("has more than 20000 fields"));
    EXPECT_THAT(problem_of("B[2] b\n==========\nMSG: a/B\n" + bytes), testing::Eq("accepted"));
}

TEST(RosSchema, WhatIsNoneIsRefused) {
    const auto problem_of = [](const std::string& text) { return refusal([&] { parse_ros_schema("a/msg/A", text); }); };
    EXPECT_THAT(problem_of("B b"), HasSubstr("does not define the type a/B"));
    EXPECT_THAT(problem_of("uint8"), HasSubstr("the line 'uint8' in a/A, expected a type and a name"));
    EXPECT_THAT(problem_of("uint8[x] y"), HasSubstr("'uint8[x] y'"));
    EXPECT_THAT(problem_of("uint8[0] y"), HasSubstr("'uint8[0] y'"));
    EXPECT_THAT(problem_of("uint8[ y"), HasSubstr("'uint8[ y'"));
    EXPECT_THAT(problem_of("uint8 " + std::string(256, 'x')), HasSubstr("a field whose name has 256 bytes"));
    EXPECT_THAT(problem_of("uint8 " + std::string(255, 'x')), testing::Eq("accepted"));
    EXPECT_THAT(problem_of("A a"), HasSubstr("the type a/A, which has itself"));
    EXPECT_THAT(problem_of("==========\nuint8 x"), HasSubstr("expected 'MSG: package/Type'"));
    std::string deep;
    for (int i = 0; i < 100; ++i) {
        deep += "T" + std::to_string(i) + " x\n==========\nMSG: a/T" + std::to_string(i) + "\n";
    }
    EXPECT_THAT(problem_of(deep), HasSubstr("more than 16 deep"));
    std::string many;
    for (int i = 0; i < 10001; ++i) {
        many += "uint8 x\n";
    }
    EXPECT_THAT(problem_of(many), HasSubstr("more than 10000 fields"));
}

}  // namespace
}  // namespace disparityd::formats

// SPDX-License-Identifier: Apache-2.0
//
// Bytes that were worked out by hand from the rules of CDR: header 00 01 00 00, then each number at a multiple of its
// size from the end of the header.
#include <array>
#include <initializer_list>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/cdr_reader.h"
#include "formats/cdr_writer.h"
#include "tests/formats/refusal.h"

namespace disparityd::formats {
namespace {

using test::refusal;

std::string bytes(std::initializer_list<int> values) {
    std::string text;
    for (const int value : values) {
        text.push_back(static_cast<char>(value));
    }
    return text;
}

CdrReader reader_of(const std::string& message) {
    return CdrReader({reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
}

TEST(Cdr, AnEmptyMessageIsTheHeader) {
    EXPECT_EQ(CdrWriter().take(), bytes({0, 1, 0, 0}));
}

TEST(Cdr, NumbersLieAtMultiplesOfTheirSize) {
    CdrWriter cdr;
    cdr.u8(0xaa).u32(0x04030201).u8(0xbb).f64(1.0).u8(0xcc).i32(-2);
    EXPECT_EQ(cdr.take(), bytes({0,    1, 0, 0,                             // header
                                 0xaa, 0, 0, 0, 1,    2,    3,    4,        // 0, 4
                                 0xbb, 0, 0, 0, 0,    0,    0,    0,        // 8
                                 0,    0, 0, 0, 0,    0,    0xf0, 0x3f,     // 16
                                 0xcc, 0, 0, 0, 0xfe, 0xff, 0xff, 0xff}));  // 24, 28
}

TEST(Cdr, TheHeaderDoesNotCountForAlignment) {
    CdrWriter cdr;
    cdr.f64(-2.0);
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xc0}));
}

TEST(Cdr, AStringHasItsZero) {
    CdrWriter cdr;
    cdr.text("abc").text("").f32(1.0F);
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0,    0,                      // header
                                 4, 0, 0,    0,   'a', 'b', 'c', 0,  // 0
                                 1, 0, 0,    0,   0,   0,   0,   0,  // 8: length 1, the zero, three to fill
                                 0, 0, 0x80, 0x3f}));                // 16
}

TEST(Cdr, SequencesHaveALengthAndArraysHaveNone) {
    CdrWriter cdr;
    cdr.f64_sequence(std::array{1.0})
        .f64_array(std::array{2.0})
        .f32_sequence(std::array{0.5F})
        .u8_sequence(std::vector<std::uint8_t>{9, 8});
    cdr.boolean(true);
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0,                    // header
                                 1, 0, 0, 0, 0, 0, 0,    0,     // 0: length, filled up to 8
                                 0, 0, 0, 0, 0, 0, 0xf0, 0x3f,  // 8
                                 0, 0, 0, 0, 0, 0, 0,    0x40,  // 16: no length
                                 1, 0, 0, 0, 0, 0, 0,    0x3f,  // 24: length, 0.5
                                 2, 0, 0, 0, 9, 8, 1}));        // 32: length, bytes, boolean
}

TEST(Cdr, AnEmptySequenceIsItsLength) {
    CdrWriter cdr;
    cdr.f32_sequence({}).u8_sequence({});
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(Cdr, RoomIsFilledByTheCaller) {
    CdrWriter cdr;
    const std::span<std::uint8_t> room = cdr.u8_room(2);
    room[1] = 7;
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0, 2, 0, 0, 0, 0, 7}));
}

TEST(Cdr, ReaderGivesBackWhatWasWritten) {
    const std::string message = CdrWriter()
                                    .u8(7)
                                    .f64(-2.5)
                                    .text("left")
                                    .u8_sequence(std::vector<std::uint8_t>{1, 2, 3})
                                    .f64_sequence(std::array{1.0, 2.0})
                                    .i32(-9)
                                    .take();
    CdrReader cdr = reader_of(message);
    EXPECT_EQ(cdr.get<std::uint8_t>(), 7);
    EXPECT_EQ(cdr.get<double>(), -2.5);
    EXPECT_EQ(cdr.text(), "left");
    EXPECT_EQ(cdr.sequence<std::uint8_t>(), (std::vector<std::uint8_t>{1, 2, 3}));
    EXPECT_EQ(cdr.sequence<double>(), (std::vector<double>{1, 2}));
    EXPECT_EQ(cdr.get<std::int32_t>(), -9);
    EXPECT_EQ(cdr.left(), 0U);
}

TEST(Cdr, ReaderTakesTheOtherByteOrder) {
    const std::string message = bytes({0,    0, 0, 0,                    // header: big endian
                                       0,    0, 1, 2, 0,   0,   0, 0,    // 0: 258, to fill
                                       0xc0, 4, 0, 0, 0,   0,   0, 0,    // 8: -2.5
                                       0,    0, 0, 3, 'a', 'b', 0, 0,    // 16: text, to fill
                                       0,    0, 0, 2, 1,   2,   3, 4});  // 24: two numbers of 16 bits
    CdrReader cdr = reader_of(message);
    EXPECT_EQ(cdr.get<std::uint32_t>(), 258U);
    EXPECT_EQ(cdr.get<double>(), -2.5);
    EXPECT_EQ(cdr.text(), "ab");
    EXPECT_EQ(cdr.sequence<std::uint16_t>(), (std::vector<std::uint16_t>{258, 772}));
}

TEST(Cdr, ReaderRefusesWhatItCannotRead) {
    EXPECT_THAT(refusal([] { reader_of(bytes({0, 1, 0})); }), testing::HasSubstr("found 3 bytes"));
    EXPECT_THAT(refusal([] { reader_of(bytes({0, 7, 0, 0})); }), testing::HasSubstr("of the kind 7"));
    EXPECT_THAT(refusal([] {
                    reader_of(bytes({0, 1, 0, 0, 1})).get<std::uint32_t>();
                }),
                testing::HasSubstr("ends too soon"));
    EXPECT_THAT(refusal([] {
                    reader_of(bytes({0, 1, 0, 0, 255, 255, 255, 255, 0, 0, 0, 0, 1})).sequence<double>();
                }),
                testing::HasSubstr("4294967295 x 8 bytes"))
        << "nothing is allocated before the length is looked at";
    EXPECT_THAT(refusal([] {
                    reader_of(bytes({0, 1, 0, 0, 2, 0, 0, 0, 'a', 'b'})).text();
                }),
                testing::HasSubstr("does not end with 0"));
}

}  // namespace
}  // namespace disparityd::formats

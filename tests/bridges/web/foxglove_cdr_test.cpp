// SPDX-License-Identifier: Apache-2.0
//
// Bytes that were worked out by hand from the rules of CDR: header 00 01 00 00, then each number at a multiple of its
// size from the end of the header.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "bridges/web/foxglove/cdr_writer.h"
#include "bridges/web/foxglove/message_header.h"
#include "tests/bridges/web/cdr_reader.h"

namespace disparityd::foxglove {
namespace {

using test::bytes;

TEST(FoxgloveCdr, AnEmptyMessageIsTheHeader) {
    EXPECT_EQ(CdrWriter().take(), bytes({0, 1, 0, 0}));
}

TEST(FoxgloveCdr, NumbersLieAtMultiplesOfTheirSize) {
    CdrWriter cdr;
    cdr.u8(0xaa).u32(0x04030201).u8(0xbb).f64(1.0).u8(0xcc).i32(-2);
    EXPECT_EQ(cdr.take(), bytes({0,    1, 0, 0,                             // header
                                 0xaa, 0, 0, 0, 1,    2,    3,    4,        // 0, 4
                                 0xbb, 0, 0, 0, 0,    0,    0,    0,        // 8
                                 0,    0, 0, 0, 0,    0,    0xf0, 0x3f,     // 16
                                 0xcc, 0, 0, 0, 0xfe, 0xff, 0xff, 0xff}));  // 24, 28
}

TEST(FoxgloveCdr, TheHeaderDoesNotCountForAlignment) {
    CdrWriter cdr;
    cdr.f64(-2.0);
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xc0}));
}

TEST(FoxgloveCdr, AStringHasItsZero) {
    CdrWriter cdr;
    cdr.text("abc").text("").f32(1.0F);
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0,    0,                      // header
                                 4, 0, 0,    0,   'a', 'b', 'c', 0,  // 0
                                 1, 0, 0,    0,   0,   0,   0,   0,  // 8: length 1, the zero, three to fill
                                 0, 0, 0x80, 0x3f}));                // 16
}

TEST(FoxgloveCdr, SequencesHaveALengthAndArraysHaveNone) {
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

TEST(FoxgloveCdr, AnEmptySequenceIsItsLength) {
    CdrWriter cdr;
    cdr.f32_sequence({}).u8_sequence({});
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(FoxgloveCdr, RoomIsFilledByTheCaller) {
    CdrWriter cdr;
    const std::span<std::uint8_t> room = cdr.u8_room(2);
    room[1] = 7;
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0, 2, 0, 0, 0, 0, 7}));
}

TEST(FoxgloveCdr, AStampIsSecondsAndNanoseconds) {
    CdrWriter cdr;
    write_header(cdr, 258'000'000'003, "l");
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0,              // header
                                 2, 1, 0, 0, 3, 0, 0, 0,  // 258 s, 3 ns
                                 2, 0, 0, 0, 'l', 0}));
}

TEST(FoxgloveCdr, NanosecondsCountUpwardsBefore1970) {
    CdrWriter cdr;
    write_header(cdr, -1, "");
    EXPECT_EQ(cdr.take(), bytes({0, 1, 0, 0,                                      // header
                                 0xff, 0xff, 0xff, 0xff, 0xff, 0xc9, 0x9a, 0x3b,  // -1 s, 999999999 ns
                                 1, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace disparityd::foxglove

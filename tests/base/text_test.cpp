// SPDX-License-Identifier: Apache-2.0
//
// Text from outside: what messages show of it, and which files are read.
#include <filesystem>
#include <stdexcept>

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/message_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "capture/images/image_times.h"
#include "tests/temporary_folder.h"

namespace disparityd::base {
namespace {

TEST(PrintableText, IsOneLineWithoutControls) {
    EXPECT_EQ(printable("gain-left"), "gain-left");
    EXPECT_EQ(printable("a\nb\r\t\x1b[2J\x7f"), "a?b???[2J?");
    EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
    // U+009B moves cursors as ESC [ does; U+00A0 and U+00E9 do not.
    EXPECT_EQ(printable("a\xc2\x9b"
                        "2J\xc2\xa0\xc3\xa9"),
              "a??2J\xc2\xa0\xc3\xa9");
    // Right to left, a line separator, an isolate; an ellipsis and an euro sign beside them stay.
    EXPECT_EQ(printable("a\u202e"
                        "b\u2028"
                        "c\u2067"
                        "d"),
              "a???b???c???d");
    EXPECT_EQ(printable("\u2026\u20ac"), "\u2026\u20ac");
    EXPECT_EQ(printable("\xc2"), "\xc2");
}

TEST(PrintableText, IsCutBetweenCharacters) {
    EXPECT_EQ(printable("abcd", 4), "abcd");
    EXPECT_EQ(printable("abcde", 4), "abcd...");
    const std::string four = "\xf0\x9f\x93\xb7";
    for (std::size_t longest = 1; longest < 5; ++longest) {
        EXPECT_EQ(printable("a" + four, longest), "a...");
        EXPECT_EQ(printable("a" + four + "b", longest), "a...");
    }
    EXPECT_EQ(printable("a" + four, 5), "a" + four);
    // What is no UTF-8 is cut all the same.
    EXPECT_EQ(printable(std::string(9, '\x80'), 8).size(), 5U + 3U);
    EXPECT_EQ(printable("a", 0), "...");
    EXPECT_EQ(printable("", 0), "");
}

TEST(PrintableLine, LongWordsLoseTheirMiddleAlone) {
    const std::string longest(300, 'x');
    EXPECT_EQ(printable_line("a  b " + longest + " c"), "a  b " + longest + " c");
    const std::string name = "begin" + std::string(4000, '/') + "end";
    const std::string cut = printable_line("found " + name + ": no such file");
    EXPECT_EQ(cut.substr(0, 11), "found begin");
    EXPECT_EQ(cut.substr(cut.size() - 17), "end: no such file");
    EXPECT_LT(cut.size(), 320U);
    std::string eyes;
    for (int i = 0; i < 300; ++i) {
        eyes += "\u20ac";
    }
    for (const std::string& start : {std::string(), std::string("a"), std::string("ab")}) {
        const std::string text = printable_line(start + eyes);
        EXPECT_EQ((text.size() - start.size()) % 3, 0U) << "three bytes each, and the dots";
    }
}

TEST(CountedText, OneIsSingular) {
    EXPECT_EQ(counted(0, "frame"), "0 frames");
    EXPECT_EQ(counted(1, "frame"), "1 frame");
    EXPECT_EQ(counted(2, "USB reset"), "2 USB resets");
}

std::string why_refused(const std::string& path) {
    try {
        read_text_file(path, "calibration");
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "accepted";
}

TEST(TextFile, IsReadAsAWhole) {
    const disparityd::test::TemporaryFolder folder;
    for (const std::string& text : {std::string(), std::string("a\r\n\0b", 5), std::string(1U << 20U, 'x')}) {
        EXPECT_EQ(read_text_file(folder.write("text", text), "calibration"), text);
    }
}

TEST(TextFile, AByteOrderMarkIsNoPartOfTheText) {
    const disparityd::test::TemporaryFolder folder;
    const std::string mark = "\xef\xbb\xbf";
    EXPECT_EQ(read_text_file(folder.write("text", mark + "[STEREO]\n"), "calibration"), "[STEREO]\n");
    EXPECT_EQ(read_text_file(folder.write("text", mark), "calibration"), "");
    EXPECT_EQ(read_text_file(folder.write("text", "a" + mark), "calibration"), "a" + mark) << "only in front";
    EXPECT_EQ(capture::read_image_times(folder.write("times.txt", mark + "0\n0.1\n"), 2),
              (std::vector<std::int64_t>{0, 100'000'000}));
    const std::string utf16 = folder.write("text", std::string("\xff\xfe[\0", 4));
    EXPECT_EQ(why_refused(utf16), "calibration " + utf16 + ": found UTF-16 text: save it as UTF-8");
}

TEST(TextFile, EverythingElseIsRefusedWithItsReason) {
    const disparityd::test::TemporaryFolder folder;
    const auto message = [](const std::string& path, const std::string& reason) {
        return "calibration " + path + ": " + reason;
    };
    const std::string path = folder.file("x");
    EXPECT_EQ(why_refused(path), message(path, "no such file"));
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    EXPECT_EQ(why_refused(path), message(path, "not a file, but a pipe or a device"));
    EXPECT_EQ(why_refused(folder.file("")), message(folder.file(""), "not a file, but a folder"));
    EXPECT_EQ(why_refused(path + "/y"), message(path + "/y", "no such file"));
    std::filesystem::remove(path);
    EXPECT_EQ(why_refused(folder.write("x", std::string((1U << 20U) + 1, 'x'))),
              message(path, "found 1048577 bytes, allowed are 1 MiB of text"));
    const std::string long_name = folder.file(std::string(300, 'x'));
    EXPECT_EQ(why_refused(long_name), message(long_name, "cannot be read: File name too long"));
}

TEST(TextFile, WhoMayNotReadItIsTold) {
    const disparityd::test::TemporaryFolder folder;
    const std::string path = folder.write("x", "text");
    std::filesystem::permissions(path, std::filesystem::perms::none);
    std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
    const uid_t user = geteuid();
    constexpr uid_t nobody = 65534;
    if (user == 0 && seteuid(nobody) != 0) {
        GTEST_SKIP() << "root reads everything, and may not be somebody else here";
    }
    const std::string found = why_refused(path);
    ASSERT_EQ(seteuid(user), 0);
    EXPECT_EQ(found, "calibration " + path + ": cannot be read: Permission denied");
}

}  // namespace
}  // namespace disparityd::base

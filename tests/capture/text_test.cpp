// SPDX-License-Identifier: Apache-2.0
//
// Text from outside: what messages show of it, and which files are read.
#include <filesystem>
#include <stdexcept>

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "capture/message_text.h"
#include "capture/text_file.h"
#include "tests/temporary_folder.h"

namespace disparityd::capture {
namespace {

TEST(ShownText, IsOneLineWithoutControls) {
    EXPECT_EQ(shown("gain-left"), "gain-left");
    EXPECT_EQ(shown("a\nb\r\t\x1b[2J\x7f"), "a?b???[2J?");
    EXPECT_EQ(shown(std::string("a\0b", 3)), "a?b");
    // U+009B moves cursors as ESC [ does; U+00A0 and U+00E9 do not.
    EXPECT_EQ(shown("a\xc2\x9b"
                    "2J\xc2\xa0\xc3\xa9"),
              "a??2J\xc2\xa0\xc3\xa9");
    EXPECT_EQ(shown("\xc2"), "\xc2");
}

TEST(ShownText, IsCutBetweenCharacters) {
    EXPECT_EQ(shown("abcd", 4), "abcd");
    EXPECT_EQ(shown("abcde", 4), "abcd...");
    const std::string four = "\xf0\x9f\x93\xb7";
    for (std::size_t longest = 1; longest < 5; ++longest) {
        EXPECT_EQ(shown("a" + four, longest), "a...");
        EXPECT_EQ(shown("a" + four + "b", longest), "a...");
    }
    EXPECT_EQ(shown("a" + four, 5), "a" + four);
    // What is no UTF-8 is cut all the same.
    EXPECT_EQ(shown(std::string(9, '\x80'), 8).size(), 5U + 3U);
    EXPECT_EQ(shown("a", 0), "...");
    EXPECT_EQ(shown("", 0), "");
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
}  // namespace disparityd::capture

// SPDX-License-Identifier: Apache-2.0
#include "daemon/system/huge_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace disparityd {
namespace {

using testing::HasSubstr;

constexpr std::size_t megabyte = 1'000'000;

TEST(HugePages, TheChosenWord) {
    EXPECT_EQ(daemon::chosen_word("always [madvise] never\n"), "madvise");
    EXPECT_EQ(daemon::chosen_word("always madvise [never]\n"), "never");
    for (const char* text : {"", "always", "]x[", "[always"}) {
        EXPECT_EQ(daemon::chosen_word(text), "") << text;
    }
}

TEST(HugePages, OnlyMappingsThatAskAreCounted) {
    daemon::HugePages pages;
    daemon::count_huge_pages(
        "7f0000000000-7f0000800000 rw-p 00000000 00:00 0 \n"
        "Size:               8192 kB\nRss:                6144 kB\nPss:                6144 kB\n"
        "AnonHugePages:      4096 kB\nVmFlags: rd wr mr mw me ac hg sd \n"
        "7f1000000000-7f1000800000 rw-p 00000000 00:00 0 \n"
        "Rss:                8192 kB\nAnonHugePages:      8192 kB\nVmFlags: rd wr mr mw me ac sd \n"
        "7f2000000000-7f2000800000 rw-p 00000000 00:00 0 [anon: hg ]\n"
        "Rss:                2048 kB\nAnonHugePages:         0 kB\nVmFlags: rd wr mr mw me ac hg\n",
        pages);
    EXPECT_EQ(pages.wanted, 8192U * 1024);
    EXPECT_EQ(pages.got, 4096U * 1024);
}

TEST(HugePages, ANoticeOnlyWhereSomethingIsMissing) {
    EXPECT_EQ(daemon::huge_page_notice({"madvise", false, 200 * megabyte, 200 * megabyte}), "");
    EXPECT_EQ(daemon::huge_page_notice({"madvise", false, 200 * megabyte, 190 * megabyte}), "");
    EXPECT_EQ(daemon::huge_page_notice({"never", false, 0, 0}), "") << "nothing asks for them";
    EXPECT_THAT(daemon::huge_page_notice({"", false, 0, 0}), HasSubstr("this kernel has none"));
    EXPECT_THAT(daemon::huge_page_notice({"never", false, 200 * megabyte, 0}),
                HasSubstr("says never, allowed: madvise"));
    EXPECT_THAT(daemon::huge_page_notice({"madvise", true, 200 * megabyte, 0}), HasSubstr("forbidden to this process"));
    EXPECT_THAT(daemon::huge_page_notice({"always", false, 200 * megabyte, 20 * megabyte}),
                HasSubstr("for 20 of 200 MB"));
}

TEST(HugePages, ThisProcessCanBeLookedAt) {
    const daemon::HugePages pages = daemon::huge_pages();
    EXPECT_LE(pages.got, pages.wanted);
}

}  // namespace
}  // namespace disparityd

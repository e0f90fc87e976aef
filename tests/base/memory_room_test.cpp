// SPDX-License-Identifier: Apache-2.0
#include "base/memory_room.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.h"

namespace disparityd::base {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MemoryRoomTest : public testing::Test {
protected:
    void write(const std::string& path, const std::string& text) {
        std::filesystem::create_directories(std::filesystem::path(folder_.file(path)).parent_path());
        std::ofstream(folder_.file(path)) << text;
    }

    MemoryRoom room() const { return memory_room(folder_.file("")); }

    test::TemporaryFolder folder_;
};

TEST_F(MemoryRoomTest, NothingIsRefusedWhereNothingIsKnown) {
    EXPECT_EQ(room().bytes, SIZE_MAX);
    EXPECT_NO_THROW(check_memory_room(SIZE_MAX, room()));
}

TEST_F(MemoryRoomTest, TheMachineHasWhatIsAvailable) {
    write("proc/meminfo", "MemTotal:       8000000 kB\nMemFree:  100 kB\nMemAvailable:    2000000 kB\n");
    EXPECT_EQ(room().bytes, 2'048'000'000U);
    EXPECT_EQ(room().where, "this machine");
}

TEST_F(MemoryRoomTest, AGroupOfVersion2LeavesItsLimitLessWhatItHolds) {
    write("proc/meminfo", "MemAvailable:    2000000 kB\n");
    write("proc/self/cgroup", "0::/system.slice/disparityd.service\n");
    write("sys/fs/cgroup/system.slice/disparityd.service/memory.max", "500000000\n");
    write("sys/fs/cgroup/system.slice/disparityd.service/memory.current", "300000000\n");
    write("sys/fs/cgroup/system.slice/disparityd.service/memory.stat", "anon 200000000\ninactive_file 100000000\n");
    EXPECT_EQ(room().bytes, 300'000'000U) << "its files' cache counts as free";
    EXPECT_EQ(room().where, "control group /system.slice/disparityd.service");
}

TEST_F(MemoryRoomTest, AGroupAboveMayLeaveLess) {
    write("proc/self/cgroup", "0::/a/b\n");
    write("sys/fs/cgroup/a/b/memory.max", "max\n");
    write("sys/fs/cgroup/a/b/memory.current", "1000\n");
    write("sys/fs/cgroup/a/memory.max", "5000\n");
    write("sys/fs/cgroup/a/memory.current", "6000\n");
    EXPECT_EQ(room().bytes, 0U) << "it holds more than it may";
    EXPECT_EQ(room().where, "control group /a");
}

TEST_F(MemoryRoomTest, AGroupOfVersion1) {
    write("proc/meminfo", "MemAvailable:    2000000 kB\n");
    write("proc/self/cgroup", "4:cpu,cpuacct:/x\n3:memory:/robot\nnonsense\n");
    write("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    write("sys/fs/cgroup/memory/memory.usage_in_bytes", "5000000000\n");
    write("sys/fs/cgroup/memory/robot/memory.limit_in_bytes", "400000000\n");
    write("sys/fs/cgroup/memory/robot/memory.usage_in_bytes", "300000000\n");
    write("sys/fs/cgroup/memory/robot/memory.stat", "inactive_file 1\ntotal_inactive_file 50000000\n");
    EXPECT_EQ(room().bytes, 150'000'000U);
    EXPECT_EQ(room().where, "control group /robot");
}

TEST_F(MemoryRoomTest, ThisMachineHasSome) {
    const MemoryRoom here = memory_room();
    EXPECT_GT(here.bytes, std::size_t{1} << 20);
    EXPECT_NE(here.bytes, SIZE_MAX);
}

TEST_F(MemoryRoomTest, TheLineSaysHowMuchWhereAndWhatToDo) {
    const MemoryRoom small{300'000'000, "control group /a"};
    EXPECT_NO_THROW(check_memory_room(236'000'000, small));
    EXPECT_NO_THROW(check_memory_room(0, {memory_reserve, "this machine"}));
    EXPECT_THROW(check_memory_room(236'000'001, small), std::runtime_error);
    try {
        check_memory_room(5'368'000'000, small);
        FAIL() << "accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("needs 5368 MB"), HasSubstr("control group /a has 300 MB left"),
                                        HasSubstr("fewer disparities")));
    }
}

}  // namespace
}  // namespace disparityd::base

// SPDX-License-Identifier: Apache-2.0
//
// Who has which core of the computer.
#include "daemon/system/core_locks.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/temporary_folder.h"

namespace disparityd::daemon {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class CoreLocksTest : public testing::Test {
protected:
    fs::path file(int core) const { return fs::path(folder_.path()) / ("disparityd-core-" + std::to_string(core)); }

    const test::TemporaryFolder folder_;
    CoreLocks locks_{false, folder_.path()};
    CoreLocks others_{false, folder_.path()};
};

TEST_F(CoreLocksTest, ACoreBelongsToOneAtATime) {
    EXPECT_TRUE(locks_.claim(3));
    EXPECT_TRUE(locks_.claim(3)) << "it has it already";
    EXPECT_FALSE(others_.claim(3));
    EXPECT_THAT(others_.refusal(), AllOf(HasSubstr("core 3 is held by another program"),
                                         HasSubstr("process " + std::to_string(getpid()))));
    EXPECT_TRUE(others_.claim(4));
    locks_.leave();
    EXPECT_FALSE(locks_.claim(4)) << "only who has it gives it back";
    EXPECT_TRUE(others_.claim(3));
}

TEST_F(CoreLocksTest, AllAreGivenBackAtTheEnd) {
    {
        CoreLocks engine(false, folder_.path());
        EXPECT_TRUE(engine.claim(0));
        EXPECT_TRUE(engine.claim(1));
    }
    EXPECT_TRUE(locks_.claim(0));
    EXPECT_TRUE(locks_.claim(1));
}

TEST_F(CoreLocksTest, AProcessThatIsKilledHasNoneAnyMore) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        CoreLocks held(true, folder_.path());
        const char got = held.claim(0) ? 'y' : 'n';
        static_cast<void>(write(ends[1], &got, 1));
        for (;;) {
            pause();
        }
    }
    ASSERT_GT(child, 0);
    char got = 0;
    EXPECT_EQ(read(ends[0], &got, 1), 1);
    EXPECT_EQ(got, 'y');
    EXPECT_FALSE(locks_.claim(0));
    EXPECT_THAT(locks_.refusal(), HasSubstr("process " + std::to_string(child)));
    EXPECT_EQ(kill(child, SIGKILL), 0);
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_TRUE(locks_.claim(0)) << locks_.refusal();
    close(ends[0]);
    close(ends[1]);
}

TEST_F(CoreLocksTest, EverybodyMayLockAndNobodyWrites) {
    const mode_t before = umask(0077);
    EXPECT_TRUE(locks_.claim(0));
    umask(before);
    struct stat info {};
    ASSERT_EQ(stat(file(0).c_str(), &info), 0);
    EXPECT_EQ(info.st_mode & 07777U, 0444U);
    EXPECT_EQ(info.st_size, 0);
}

// The folder is everybody's: something else may lie where the file is to be.
TEST_F(CoreLocksTest, ALinkIsNotFollowed) {
    const std::string victim = folder_.file("victim");
    fs::create_symlink(victim, file(0));
    EXPECT_FALSE(locks_.claim(0));
    EXPECT_THAT(locks_.refusal(), HasSubstr(file(0).string()));
    EXPECT_FALSE(fs::exists(victim)) << "nothing was made where it leads";
    EXPECT_TRUE(locks_.claim(1)) << "the other cores are claimed all the same";
}

TEST_F(CoreLocksTest, APipeAndAFolderAreNoLocks) {
    ASSERT_EQ(mkfifo(file(0).c_str(), 0666), 0);
    fs::create_directory(file(1));
    for (const int core : {0, 1}) {
        EXPECT_FALSE(locks_.claim(core));
        EXPECT_THAT(locks_.refusal(), HasSubstr("something that is no plain file has this name"));
    }
}

TEST_F(CoreLocksTest, AFolderThatIsMissingIsTold) {
    for (const bool takes_all : {false, true}) {
        CoreLocks lost(takes_all, folder_.file("none"));
        EXPECT_FALSE(lost.claim(0));
        EXPECT_THAT(lost.refusal(), HasSubstr("No such file or directory"));
    }
}

// logind removes what a user has in the folder when the user logs out.
TEST_F(CoreLocksTest, AFileThatWasRemovedIsLockedAnew) {
    ASSERT_TRUE(locks_.claim(0));
    fs::remove(file(0));
    EXPECT_TRUE(locks_.claim(0));
    EXPECT_TRUE(fs::exists(file(0)));
    EXPECT_FALSE(others_.claim(0));
    fs::remove(file(0));
    EXPECT_TRUE(others_.claim(0)) << "nobody can know of the first lock any more";
    EXPECT_FALSE(locks_.claim(0)) << "and who had it learns that it is gone";
    others_.leave();
    EXPECT_TRUE(locks_.claim(0));
}

// Were one of them pinned and the others not, they would not drop frames evenly.
TEST_F(CoreLocksTest, OfSeveralThatTakeAllNoneHasACore) {
    CoreLocks first(true, folder_.path());
    EXPECT_TRUE(first.claim(0));
    {
        CoreLocks second(true, folder_.path());
        EXPECT_FALSE(second.claim(2));
        EXPECT_THAT(second.refusal(), HasSubstr("another daemon takes all cores, too"));
        EXPECT_FALSE(first.claim(0)) << "it learns of the second";
        EXPECT_TRUE(others_.claim(0)) << "and has given it back";
        others_.leave();
        EXPECT_FALSE(second.claim(0));
        first.leave();
        EXPECT_TRUE(second.claim(0)) << "who has left counts no more";
    }
    EXPECT_TRUE(first.claim(0)) << "nor does who has ended";
}

// Who was given a share would find no core, did the first that takes all keep them.
TEST_F(CoreLocksTest, WhoTakesAllGivesWayToAShare) {
    CoreLocks all(true, folder_.path());
    EXPECT_TRUE(all.claim(0));
    EXPECT_TRUE(all.claim(1));
    EXPECT_FALSE(locks_.claim(0)) << "the first one has not looked yet";
    EXPECT_THAT(locks_.refusal(), HasSubstr("core 0 is held by another program"));
    EXPECT_FALSE(all.claim(0));
    EXPECT_THAT(all.refusal(), HasSubstr("another daemon has a share of the cores, and comes first"));
    EXPECT_FALSE(all.claim(1)) << "one that is pinned in part would drop frames unevenly";
    EXPECT_TRUE(locks_.claim(0));
    EXPECT_TRUE(others_.claim(1)) << "shares are no rivals";
    locks_.leave();
    EXPECT_FALSE(all.claim(0)) << "one of two is left";
    others_.leave();
    EXPECT_TRUE(all.claim(0));
    EXPECT_TRUE(all.claim(1));
}

TEST_F(CoreLocksTest, AFileOfSharesThatWasRemovedIsMadeAnew) {
    CoreLocks all(true, folder_.path());
    ASSERT_TRUE(locks_.claim(0));
    EXPECT_FALSE(all.claim(1));
    fs::remove(fs::path(folder_.path()) / "disparityd-core-shares");
    EXPECT_TRUE(all.claim(1)) << "nobody can know of that lock any more";
    EXPECT_TRUE(locks_.claim(0));
    EXPECT_FALSE(all.claim(1));
}

TEST(CoreLockFolder, UnitsLetTheDaemonWriteThere) {
    std::ifstream file(DISPARITYD_UNIT);
    const std::string unit{std::istreambuf_iterator<char>(file), {}};
    EXPECT_THAT(unit, HasSubstr("\nReadWritePaths=" + std::string(core_lock_folder) + "\n"));
    for (const char* hides : {"\nPrivateIPC=yes", "\nTemporaryFileSystem=", "\nInaccessiblePaths="}) {
        EXPECT_THAT(unit, Not(HasSubstr(hides)));
    }
}

}  // namespace
}  // namespace disparityd::daemon

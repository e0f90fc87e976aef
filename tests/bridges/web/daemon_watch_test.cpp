// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/daemon/daemon_watch.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <future>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "bridges/web/http/all_daemons.h"
#include "tests/temporary_folder.h"

namespace disparityd::web {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A socket at which somebody listens, as a daemon does. What was killed leaves its file behind.
class Listening {
public:
    explicit Listening(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.copy(address.sun_path, sizeof address.sun_path - 1);
        EXPECT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << path;
        EXPECT_EQ(::listen(fd_, 8), 0);
    }
    ~Listening() { ::close(fd_); }
    Listening(const Listening&) = delete;
    Listening& operator=(const Listening&) = delete;

private:
    int fd_;
};

void set_time(const std::string& path, std::time_t seconds) {
    const std::array<timespec, 2> times{timespec{seconds, 0}, timespec{seconds, 0}};
    ASSERT_EQ(utimensat(AT_FDCWD, path.c_str(), times.data(), 0), 0);
}

class SocketScanTest : public ::testing::Test {
protected:
    std::string system_folder() const { return folder_.file("system"); }
    std::string user_folder() const { return folder_.file("user"); }

    test::TemporaryFolder folder_;
    SocketScan scan_{{system_folder(), user_folder()}};
};

TEST_F(SocketScanTest, DaemonsComeAndGoWithTheirFoldersAndSockets) {
    EXPECT_THAT(scan_.names(), IsEmpty());
    std::filesystem::create_directory(system_folder());
    std::filesystem::create_directory(user_folder());
    const Listening listening_1(system_folder() + "/disparityd.sock");
    const Listening listening_2(user_folder() + "/disparityd-front.sock");
    EXPECT_THAT(scan_.names(), ElementsAre("default", "front"));
    const Listening listening_3(system_folder() + "/disparityd-front.sock");
    std::filesystem::remove(user_folder() + "/disparityd-front.sock");
    EXPECT_THAT(scan_.names(), ElementsAre("default", "front"));
    std::filesystem::remove_all(system_folder());
    EXPECT_THAT(scan_.names(), IsEmpty());
}

TEST_F(SocketScanTest, OtherFilesAreNoDaemons) {
    std::filesystem::create_directory(system_folder());
    folder_.write("system/disparityd-file.sock", "");
    const Listening listening_4(system_folder() + "/other.sock");
    const Listening listening_5(system_folder() + "/disparityd-a b.sock");
    const Listening listening_6(system_folder() + "/disparityd-...sock");
    const Listening listening_7(system_folder() + "/disparityd-.sock");
    std::filesystem::create_symlink(system_folder() + "/other.sock", system_folder() + "/disparityd-link.sock");
    EXPECT_THAT(scan_.names(), IsEmpty());
}

TEST_F(SocketScanTest, OneThatWasKilledStaysAndWhatWasLeftBehindBeforeIsNone) {
    std::filesystem::create_directory(user_folder());
    { const Listening killed_before(user_folder() + "/disparityd-old.sock"); }
    {
        const Listening killed_later(user_folder() + "/disparityd-killed.sock");
        EXPECT_THAT(scan_.names(), ElementsAre("killed"));
    }
    EXPECT_THAT(scan_.names(), ElementsAre("killed"));
    std::filesystem::remove(user_folder() + "/disparityd-old.sock");
    const Listening again(user_folder() + "/disparityd-old.sock");
    EXPECT_THAT(scan_.names(), ElementsAre("killed", "old"));
}

TEST_F(SocketScanTest, SocketsOfOtherUsersCountInTheSystemsFolderOnly) {
    if (getuid() != 0) {
        GTEST_SKIP() << "only root can give a file away";
    }
    for (const std::string& folder : {system_folder(), user_folder()}) {
        std::filesystem::create_directory(folder);
    }
    const std::string service = system_folder() + "/disparityd-service.sock";
    const std::string foreign = user_folder() + "/disparityd-foreign.sock";
    const Listening listening_8(service);
    const Listening listening_12(foreign);
    for (const std::string& path : {service, foreign}) {
        ASSERT_EQ(chown(path.c_str(), 12345, 12345), 0);
    }
    EXPECT_THAT(scan_.names(), ElementsAre("service"));
}

TEST_F(SocketScanTest, AFolderThatHasNotChangedIsNotReadAgain) {
    std::filesystem::create_directory(user_folder());
    const Listening listening_9(user_folder() + "/disparityd-a.sock");
    set_time(user_folder(), 1000);
    EXPECT_THAT(scan_.names(), ElementsAre("a"));
    const Listening listening_10(user_folder() + "/disparityd-b.sock");
    set_time(user_folder(), 1000);
    EXPECT_THAT(scan_.names(), ElementsAre("a")) << "its time says that it is as before";
    set_time(user_folder(), 1001);
    EXPECT_THAT(scan_.names(), ElementsAre("a", "b"));
}

TEST_F(SocketScanTest, TheThreadTellsWhatHasChanged) {
    std::filesystem::create_directory(user_folder());
    std::promise<void> told_empty;
    std::promise<std::set<std::string>> told_names;
    DaemonWatch watch({system_folder(), user_folder()}, [&](const std::set<std::string>& names) {
        if (names.empty()) {
            told_empty.set_value();
        } else {
            told_names.set_value(names);
        }
    });
    told_empty.get_future().wait();
    const Listening listening_11(user_folder() + "/disparityd-late.sock");
    EXPECT_THAT(told_names.get_future().get(), ElementsAre("late"));
}

TEST(WhyNoDaemonTest, SaysWhereWasLookedAndWhatToDo) {
    const test::TemporaryFolder folder;
    const std::string why = why_no_daemon({folder.path(), "/nowhere"});
    EXPECT_THAT(why, HasSubstr("no daemon has a socket in " + folder.path() + " or /nowhere"));
    EXPECT_TRUE(why.find("start one") != std::string::npos || why.find("shared memory of") != std::string::npos) << why;
    // Memory of a daemon whose socket is elsewhere is the likely cause.
    const std::string object = "/dev/shm/disparityd.why-" + std::to_string(getpid());
    const int fd = open(object.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    ASSERT_GE(fd, 0);
    close(fd);
    EXPECT_THAT(why_no_daemon({folder.path()}), HasSubstr("there is shared memory of"));
    unlink(object.c_str());
}

TEST(DaemonInPathTest, OnlyNamesThatDaemonsHave) {
    EXPECT_EQ(daemon_in_path("/i/front"), "front");
    EXPECT_EQ(daemon_in_path("/i/front/api/status"), "front");
    EXPECT_EQ(daemon_in_path("/i/a.b_c-9/"), "a.b_c-9");
    for (const char* path : {"/", "/i", "/i/", "/i//api/status", "/i/a%20b/", "/i/a b/", "/j/front/", "i/front"}) {
        EXPECT_EQ(daemon_in_path(path), "") << path;
    }
    EXPECT_EQ(daemon_in_path("/i/" + std::string(65, 'x') + "/"), "");
}

}  // namespace
}  // namespace disparityd::web

// SPDX-License-Identifier: Apache-2.0
//
// What the service manager hears, by a socket that stands for it.
#include <algorithm>
#include <array>
#include <csignal>

#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using std::chrono::steady_clock;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class NotifySocket {
public:
    explicit NotifySocket(const std::string& path) : path_(path), fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.copy(address.sun_path, sizeof(address.sun_path) - 1);
        EXPECT_EQ(::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    }
    ~NotifySocket() { ::close(fd_); }
    NotifySocket(const NotifySocket&) = delete;
    NotifySocket& operator=(const NotifySocket&) = delete;

    const std::string& path() const { return path_; }

    /// The next message that holds the text; empty when none came in time.
    std::string wait_for(const std::string& text, std::chrono::milliseconds timeout = DaemonProcess::patience) {
        const auto deadline = steady_clock::now() + timeout;
        for (;;) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
            pollfd event{fd_, POLLIN, 0};
            if (::poll(&event, 1, static_cast<int>(std::max<std::int64_t>(0, left))) <= 0) {
                return {};
            }
            std::array<char, 4096> bytes{};
            const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
            const std::string message(bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(0, got)));
            if (message.find(text) != std::string::npos) {
                return message;
            }
        }
    }

private:
    std::string path_;
    int fd_;
};

using ServiceManagerTest = DaemonTest;

TEST_F(ServiceManagerTest, HearsEveryStepOfALife) {
    NotifySocket manager(folder_.path() + "/notify");
    const auto begin = steady_clock::now();
    const auto daemon = start(config_text(), {}, {{"NOTIFY_SOCKET", manager.path()}, {"WATCHDOG_USEC", "2000000"}});
    EXPECT_THAT(manager.wait_for("READY=1"), HasSubstr("STATUS=running"));
    ASSERT_TRUE(daemon->wait_until_ready());
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(manager.wait_for("WATCHDOG=1"), "WATCHDOG=1") << daemon->log();
    }
    EXPECT_GE(steady_clock::now() - begin, 2s) << "three, half the watchdog's time apart";
    EXPECT_THAT(manager.wait_for("STATUS=running"), HasSubstr("frames/s, scene:vga"));

    daemon->send_signal(SIGHUP);
    EXPECT_THAT(manager.wait_for("RELOADING=1"), HasSubstr("MONOTONIC_USEC="));
    EXPECT_NE(manager.wait_for("READY=1"), "");

    folder_.write("d.toml", "[nonsense]\n");
    daemon->send_signal(SIGHUP);
    EXPECT_NE(manager.wait_for("RELOADING=1"), "");
    EXPECT_NE(manager.wait_for("READY=1"), "");
    EXPECT_THAT(daemon->log(), HasSubstr("unknown section [nonsense]"));

    daemon->send_signal(SIGTERM);
    EXPECT_EQ(manager.wait_for("STOPPING=1"), "STOPPING=1");
    EXPECT_EQ(daemon->wait_for_exit(), 0);
}

TEST_F(ServiceManagerTest, ACameraThatIsNotThereIsWaitedFor) {
    NotifySocket manager(folder_.path() + "/notify");
    const auto daemon = start(config_text("v4l2:64x16?device=/dev/there-is-none"), {},
                              {{"NOTIFY_SOCKET", manager.path()}, {"WATCHDOG_USEC", "2000000"}});
    ASSERT_TRUE(daemon->wait_until_ready()) << daemon->log();
    EXPECT_NE(
        manager.wait_for("STATUS=waiting, v4l2:64x16?device=/dev/there-is-none: no camera /dev/there-is-none: plug"),
        "");
    WireClient client(daemon->address("tcp:"));
    ASSERT_TRUE(client.hello("test"));
    const v1::Status now = status(client);
    EXPECT_EQ(now.state(), "waiting");
    EXPECT_EQ(now.camera().state(), "absent");
    EXPECT_THAT(now.detail(), HasSubstr("plug it in"));
    EXPECT_EQ(manager.wait_for("WATCHDOG=1"), "WATCHDOG=1") << "waiting is an answer";
    daemon->send_signal(SIGTERM);
    EXPECT_EQ(daemon->wait_for_exit(), 0);
}

TEST_F(ServiceManagerTest, AStoppedDaemonDoesNotFeedTheWatchdog) {
    NotifySocket manager(folder_.path() + "/notify");
    const auto daemon = start(config_text(), {}, {{"NOTIFY_SOCKET", manager.path()}, {"WATCHDOG_USEC", "1000000"}});
    ASSERT_NE(manager.wait_for("WATCHDOG=1"), "");
    daemon->send_signal(SIGSTOP);
    while (manager.wait_for("WATCHDOG=1", 100ms) != "") {
    }
    EXPECT_EQ(manager.wait_for("WATCHDOG=1", 1200ms), "");
    daemon->send_signal(SIGCONT);
    EXPECT_EQ(manager.wait_for("WATCHDOG=1"), "WATCHDOG=1");
}

TEST_F(ServiceManagerTest, TheJournalGetsPriorities) {
    const auto daemon = start(config_text(), {}, {{"JOURNAL_STREAM", "8:1"}});
    ASSERT_TRUE(daemon->wait_until_ready());
    EXPECT_TRUE(daemon->wait_for_log("<6>serving at tcp:127.0.0.1:"));
    WireClient(daemon->address("tcp:")).send(subscription({v1::LEFT}));
    EXPECT_TRUE(daemon->wait_for_log("<4>client 1 (tcp:127.0.0.1:"));
    EXPECT_TRUE(daemon->wait_for_log("the first message must be Hello"));
}

}  // namespace
}  // namespace disparityd::test

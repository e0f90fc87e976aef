// SPDX-License-Identifier: Apache-2.0
//
// The real daemon, after somebody has removed or replaced the names by which clients find it.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "clients/cpp/disparity_client.hpp"
#include "proto/socket_places.h"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using disparity::ReadResult;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using namespace std::chrono_literals;

class LostPlacesTest : public DaemonTest {
protected:
    std::string object() const { return "/dev/shm/disparityd." + shared_memory_name(); }
    std::string socket() const { return folder_.path() + "/s/d.sock"; }

    std::unique_ptr<DaemonProcess> start_watched() {
        std::filesystem::create_directory(folder_.path() + "/s");
        return start_ready(config_text(), {"--set", "socket.unix=" + socket()});
    }

    /// A reader that comes now finds the daemon's object and gets a frame.
    void expect_new_reader() {
        disparity::SharedMemoryOptions options;
        options.may_be_absent = true;
        disparity::SharedMemoryReader reader(shared_memory_name(), options);
        expect_frame(reader);
    }

    static void expect_frame(disparity::SharedMemoryReader& reader) {
        disparity::Frame frame;
        ReadResult result = ReadResult::gone;
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (result != ReadResult::frame && std::chrono::steady_clock::now() < deadline) {
            result = reader.read(frame, 1s);
        }
        EXPECT_EQ(result, ReadResult::frame) << reader.why_gone();
    }

    static bool eventually(const std::function<bool()>& holds) {
        const auto deadline = std::chrono::steady_clock::now() + 60s;
        while (!holds()) {
            if (std::chrono::steady_clock::now() > deadline) {
                return false;
            }
            std::this_thread::sleep_for(5ms);
        }
        return true;
    }

    /// A client that comes now connects to the file and gets a frame.
    void expect_new_client() { EXPECT_TRUE(subscriber("unix:" + socket(), {v1::DISPARITY}).receive_frame()); }

    /// Reloads the configuration, and waits until that is done.
    static void reload(const DaemonProcess& daemon) {
        const auto served = [&daemon] {
            const std::string log = daemon.log();
            std::size_t count = 0;
            for (auto at = log.find("serving scene:"); at != std::string::npos;
                 at = log.find("serving scene:", at + 1)) {
                ++count;
            }
            return count;
        };
        const std::size_t before = served();
        daemon.send_signal(SIGHUP);
        EXPECT_TRUE(eventually([&] { return served() > before; })) << daemon.log();
    }
};

TEST_F(LostPlacesTest, AnObjectThatWasRemovedIsMadeAnewAndReadersMoveOver) {
    const auto daemon = start_watched();
    WireClient client(daemon->address("tcp:"));
    client.hello();
    disparity::SharedMemoryReader mapped(shared_memory_name());
    expect_frame(mapped);
    const std::string told =
        "shared memory /disparityd." + shared_memory_name() + " was removed or replaced by another program; made anew";
    EXPECT_THAT(status(client).notices(), Not(Contains(HasSubstr("made anew"))));

    ASSERT_TRUE(std::filesystem::remove(object()));
    ASSERT_TRUE(daemon->wait_for_log(told)) << daemon->log();
    EXPECT_THAT(status(client).notices(), Contains(HasSubstr(told)));
    expect_new_reader();
    expect_frame(mapped);

    reload(*daemon);
    EXPECT_THAT(status(client).notices(), Not(Contains(HasSubstr("made anew"))));
    expect_frame(mapped);
    ASSERT_TRUE(std::filesystem::remove(object()));
    reload(*daemon);  // whichever comes first, the reload or the watch
    expect_new_reader();
    expect_frame(mapped);

    // Something else in its place.
    std::ofstream(folder_.path() + "/other") << "not of disparityd";
    std::filesystem::copy_file(folder_.path() + "/other", object() + ".other");
    std::filesystem::rename(object() + ".other", object());
    ASSERT_TRUE(eventually([this] { return std::filesystem::file_size(object()) > 1000; })) << daemon->log();
    expect_new_reader();
    expect_frame(mapped);
    daemon->send_signal(SIGTERM);
    EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
    EXPECT_FALSE(std::filesystem::exists(object()));
}

TEST_F(LostPlacesTest, WhatCannotBeMadeAnewIsToldAndTriedAgain) {
    const auto daemon = start_watched();
    WireClient client(daemon->address("tcp:"));
    client.hello();
    disparity::SharedMemoryReader mapped(shared_memory_name());
    std::filesystem::remove(object());
    std::filesystem::create_directory(object());
    EXPECT_TRUE(daemon->wait_for_log("cannot be made anew: shared memory /disparityd." + shared_memory_name()))
        << daemon->log();
    EXPECT_THAT(status(client).notices(), Contains(HasSubstr("cannot be made anew")));
    expect_frame(mapped);  // those who have it mapped lose nothing
    std::filesystem::remove(object());
    expect_new_reader();
    // A reader may find the object before the daemon has taken its notice back.
    const auto deadline = std::chrono::steady_clock::now() + DaemonProcess::patience;
    const auto complains = Contains(HasSubstr("cannot be made anew"));
    while (testing::Value(status(client).notices(), complains) && std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_THAT(status(client).notices(), Not(complains));
}

TEST_F(LostPlacesTest, ASocketFileThatWasRemovedIsMadeAnewAndClientsStay) {
    const auto daemon = start_watched();
    WireClient local = subscriber("unix:" + socket(), {v1::DISPARITY});
    ASSERT_TRUE(local.receive_frame());
    const std::string told = "socket unix:" + socket() + " was removed or replaced by another program; made anew";
    ASSERT_TRUE(std::filesystem::remove(socket()));
    ASSERT_TRUE(daemon->wait_for_log(told)) << daemon->log();
    EXPECT_THAT(status(local).notices(), Contains(HasSubstr(told)));
    expect_new_client();
    struct stat mode {};
    ASSERT_EQ(stat(socket().c_str(), &mode), 0);
    EXPECT_EQ(mode.st_mode & 0777, 0660U);

    reload(*daemon);
    expect_new_client();
    ASSERT_TRUE(std::filesystem::remove(socket()));
    reload(*daemon);  // whichever comes first, the reload or the watch
    // The file is there a moment before somebody listens.
    ASSERT_TRUE(eventually([this] { return proto::somebody_listens(socket()); })) << daemon->log();
    expect_new_client();
    ASSERT_TRUE(local.receive_frame()) << "a client from before the first removal";
    daemon->send_signal(SIGTERM);
    EXPECT_EQ(daemon->wait_for_exit(), 0) << daemon->log();
    EXPECT_FALSE(std::filesystem::exists(socket()));
}

TEST_F(LostPlacesTest, ASocketWhosePlaceIsTakenComesBackWhenItIsFree) {
    const auto daemon = start_watched();
    WireClient client(daemon->address("tcp:"));
    client.hello();
    // Another file.
    std::filesystem::remove(socket());
    std::ofstream(socket()) << "not a socket";
    EXPECT_TRUE(daemon->wait_for_log("something that is no socket has this name")) << daemon->log();
    EXPECT_THAT(status(client).notices(), Contains(HasSubstr("cannot be made anew")));
    std::filesystem::remove(socket());
    EXPECT_TRUE(daemon->wait_for_log("; made anew")) << daemon->log();
    expect_new_client();
    // The folder is gone, and comes back with everything in it.
    std::filesystem::rename(folder_.path() + "/s", folder_.path() + "/away");
    EXPECT_TRUE(daemon->wait_for_log("No such file or directory")) << daemon->log();
    std::filesystem::rename(folder_.path() + "/away", folder_.path() + "/s");
    EXPECT_TRUE(daemon->wait_for_log("socket unix:" + socket() + " is there again")) << daemon->log();
    expect_new_client();
}

}  // namespace
}  // namespace disparityd::test

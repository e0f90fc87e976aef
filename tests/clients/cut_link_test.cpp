// SPDX-License-Identifier: Apache-2.0
//
// A link that is cut and comes back: server and client in network namespaces of their own, with a pair of veth devices
// between them. Needs root; skipped without.
#include <atomic>
#include <cstdlib>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

#include <disparity_client.hpp>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sched.h>
#include <unistd.h>

#include "proto/monotonic_clock.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using disparity::Frame;
using disparity::ReadResult;
using namespace std::chrono_literals;

constexpr auto long_enough = 60s;
constexpr auto frame_interval = 33ms;

bool run(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// Takes the calling thread into a new network namespace, and back at its end.
class OwnNetwork {
public:
    OwnNetwork() : before_(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC)) {
        entered_ = before_ >= 0 && ::unshare(CLONE_NEWNET) == 0;
    }
    ~OwnNetwork() {
        if (entered_) {
            EXPECT_EQ(::setns(before_, CLONE_NEWNET), 0);
        }
        ::close(before_);
    }
    OwnNetwork(const OwnNetwork&) = delete;
    OwnNetwork& operator=(const OwnNetwork&) = delete;

    bool entered() const { return entered_; }

private:
    int before_;
    bool entered_ = false;
};

/// What a client has read.
struct Read {
    std::int64_t at_ns = 0;
    std::int64_t told_age_ns = 0;
    std::uint64_t index = 0;
};

class CutLinkTest : public ServerTest {
protected:
    /// Connects this thread's network with that of the thread `other`. Returns why that is not possible.
    static std::string link_to(pid_t other) {
        const std::string to = std::to_string(other);
        if (!run("ip link add near type veth peer name far netns " + to)) {
            return "no veth devices can be made here (ip link add)";
        }
        const bool up = run("ip address add 10.99.0.1/24 dev near") && run("ip link set near up");
        return up ? "" : "the veth device cannot be set up";
    }

    void publish(const std::stop_token& stop) {
        while (!stop.stop_requested()) {
            daemon::PublishedFrame frame = feed_.next();
            frame.captured = std::chrono::steady_clock::now();
            frame.published = frame.captured;
            {
                const std::lock_guard lock(mutex_);
                captured_.push_back(std::chrono::nanoseconds(frame.captured.time_since_epoch()).count());
            }
            server_->publish(frame);
            std::this_thread::sleep_for(frame_interval);
        }
    }

    /// Reads until the end is asked for, in a network of its own.
    void read(const std::stop_token& stop) {
        const OwnNetwork network;
        thread_.set_value(network.entered() ? ::gettid() : 0);
        if (!linked_.get_future().get() || !run("ip address add 10.99.0.2/24 dev far") || !run("ip link set far up")) {
            return;
        }
        disparity::SocketClient client(tcp_, "cut", long_enough);
        client.subscribe({.products = {disparity::Product::scan}});
        Frame frame;
        while (!stop.stop_requested()) {
            const ReadResult result = client.read(frame, 200ms);
            const std::int64_t now = proto::monotonic_ns();
            const std::lock_guard lock(mutex_);
            if (result == ReadResult::frame) {
                read_.push_back({now, frame.age_ns, frame.publish_index});
            } else if (result == ReadResult::gone) {
                why_gone_.push_back(client.why_gone());
            }
        }
        v1::Status status;
        status.ParseFromString(client.status(long_enough));
        clients_ = status.clients_size();
    }

    std::size_t frames_read() {
        const std::lock_guard lock(mutex_);
        return read_.size();
    }

    template <typename Condition>
    static bool wait_for(Condition condition) {
        for (const auto end = std::chrono::steady_clock::now() + long_enough; std::chrono::steady_clock::now() < end;) {
            if (condition()) {
                return true;
            }
            std::this_thread::sleep_for(5ms);
        }
        return false;
    }

    std::mutex mutex_;
    std::vector<std::int64_t> captured_;  ///< by publish index
    std::vector<Read> read_;
    std::vector<std::string> why_gone_;
    std::promise<pid_t> thread_;
    std::promise<bool> linked_;
    std::atomic<int> clients_{-1};
};

TEST_F(CutLinkTest, FramesAreFreshWhenTheLinkIsBack) {
    if (::geteuid() != 0 || !run("ip link show")) {
        GTEST_SKIP() << "needs root and ip (iproute2)";
    }
    const OwnNetwork network;
    if (!network.entered()) {
        GTEST_SKIP() << "no network namespace can be made here";
    }
    std::jthread reader([this](const std::stop_token& stop) { read(stop); });
    const pid_t client = thread_.get_future().get();
    const std::string missing = client == 0 ? "no second network namespace can be made here" : link_to(client);
    if (!missing.empty()) {
        linked_.set_value(false);
        GTEST_SKIP() << missing;
    }
    config_.tcp = "10.99.0.1:0";
    restart();
    std::jthread publisher([this](const std::stop_token& stop) { publish(stop); });
    linked_.set_value(true);
    ASSERT_TRUE(wait_for([this] { return frames_read() > 20; }));

    ASSERT_TRUE(run("ip link set near down"));
    std::this_thread::sleep_for(3s);  // longer than TCP waits before it tries a third time
    ASSERT_TRUE(run("ip link set near up"));
    const std::int64_t back_ns = proto::monotonic_ns();
    const std::size_t before = frames_read();
    ASSERT_TRUE(wait_for([&] { return frames_read() > before + 20; }));
    reader.request_stop();
    reader.join();
    publisher.request_stop();
    publisher.join();

    EXPECT_LT(read_.at(before).at_ns - back_ns, 10'000'000'000) << "TCP alone may take 23 s";
    for (const Read& one : read_) {
        const std::int64_t age = one.at_ns - captured_.at(one.index);
        EXPECT_LE(one.told_age_ns, age);
        EXPECT_LT(age, 2'000'000'000) << "frame " << one.index << " is one of before the cut";
    }
    EXPECT_THAT(why_gone_, testing::Contains(testing::HasSubstr("no answer from the daemon for")));
    EXPECT_EQ(clients_, 1) << "the place of the old connection is free";
    RecordProperty("first_frame_ms", static_cast<int>((read_.at(before).at_ns - back_ns) / 1'000'000));
}

}  // namespace
}  // namespace disparityd::test

// SPDX-License-Identifier: Apache-2.0
//
// What a client sends to the daemon: a session of its own for every input, over a real socket, with frames to send.
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/client_session.h"
#include "tests/daemon/frame_feed.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

/// A daemon that grants everything.
class Host final : public SessionHost {
public:
    /// What it does, it does in `loop`, so that the same input always takes the same way.
    explicit Host(boost::asio::io_context& loop) : compressor_(loop, loop.get_executor()) {
        ring_.put(pool_.copy(feed_.next(), ~0U));
    }

    const StreamLayout& layout() const override { return feed_.layout(); }
    FrameRing& frames() override { return ring_; }
    FrameCompressor& compressor() override { return compressor_; }
    const SensorRing& sensors() override { return samples_; }
    ClientLog& log() override { return log_; }
    v1::Status status() override { return {}; }
    void start_recording(const std::string& path, RecordAnswer answer) override {
        answer({}, path.empty() ? "record: no path" : "");
    }
    void stop_recording(RecordAnswer answer) override { answer({}, ""); }
    void control_camera(const v1::CameraRequest&, CameraAnswer answer) override { answer({}, ""); }
    void subscription_changed() override {}
    void closed(std::uint64_t) override { closed_ = true; }

    void publish() {
        ring_.put(pool_.copy(feed_.next(), ~0U));
        samples_.put(std::vector<capture::SensorSample>(2), std::chrono::steady_clock::now());
    }
    bool is_closed() const { return closed_; }

private:
    test::FrameFeed feed_{8, 6, {v1::DISPARITY, v1::CONFIDENCE, v1::DEPTH, v1::LEFT}};
    FramePool pool_{feed_.layout(), 4};
    FrameRing ring_{2};
    FrameCompressor compressor_;
    SensorRing samples_;
    ClientLog log_;
    bool closed_ = false;
};

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    spdlog::set_level(spdlog::level::off);
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::array<int, 2> ends{};
    fuzz::expect(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) == 0, "socketpair");
    boost::asio::io_context loop;
    Host host(loop);
    const auto session = std::make_shared<ClientSession>(
        ClientSession::Socket(loop, boost::asio::generic::stream_protocol(AF_UNIX, 0), ends[0]), "fuzz", 1, host);
    session->start();
    std::size_t sent = 0;
    // Until the session has read all and has nothing to do; what it answers is thrown away.
    for (bool busy = true; busy;) {
        const ssize_t written = sent < size ? ::send(ends[1], data + sent, size - sent, MSG_NOSIGNAL) : 0;
        sent += written > 0 ? static_cast<std::size_t>(written) : 0;
        busy = loop.poll() > 0 || written > 0;
        std::array<std::uint8_t, 4096> answer{};
        while (::recv(ends[1], answer.data(), answer.size(), 0) > 0) {
            busy = true;
        }
    }
    host.publish();
    session->frame_arrived();
    session->sensors_arrived();
    session->layout_changed();
    loop.poll();
    session->status();
    ::close(ends[1]);
    session->stop();
    loop.poll();
    return 0;
}

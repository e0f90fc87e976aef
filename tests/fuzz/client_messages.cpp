// SPDX-License-Identifier: Apache-2.0
//
// What a client sends to the daemon: a session of its own for every input, over a real socket, with frames to send.
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/socket/client_session.h"
#include "tests/daemon/socket/pattern_frames.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

/// A daemon that grants everything.
class Host final : public daemon::SessionHost {
public:
    /// What it does, it does in `loop`, so that the same input always takes the same way.
    explicit Host(boost::asio::io_context& loop) : compressor_(loop, loop.get_executor()) {
        ring_.put(pool_.copy(feed_.next(), ~0U));
    }

    const daemon::StreamLayout& layout() const override { return feed_.layout(); }
    daemon::FrameRing& frames() override { return ring_; }
    daemon::FrameCompressor& compressor() override { return compressor_; }
    const daemon::SensorRing& sensors() override { return samples_; }
    daemon::ClientLog& log() override { return log_; }
    v1::Status status() override { return {}; }
    const daemon::ClientRules& rules() const override { return rules_; }
    bool is_recording_for(std::uint64_t) const override { return false; }
    void start_recording(const daemon::RecordRequest& request, RecordAnswer answer) override {
        answer({}, request.path.empty() ? "record: no path" : "");
    }
    void stop_recording(RecordAnswer answer) override { answer({}, ""); }
    void control_camera(const v1::CameraRequest&, CameraAnswer answer) override { answer({}, ""); }
    void trace(const v1::TraceRequest& request, TraceAnswer answer) override {
        answer(std::make_shared<std::vector<v1::Trace>>(request.seconds() > 0 ? 2 : 0), "");
    }
    void subscription_changed() override {}
    void came_back(const daemon::ClientSession&) override {}
    void closed(std::uint64_t) noexcept override { closed_ = true; }

    void publish() {
        ring_.put(pool_.copy(feed_.next(), ~0U));
        samples_.put(std::vector<capture::SensorSample>(2), std::chrono::steady_clock::now());
    }
    bool is_closed() const { return closed_; }

private:
    test::PatternFrames feed_{8, 6, {v1::DISPARITY, v1::CONFIDENCE, v1::DEPTH, v1::LEFT}};
    daemon::FramePool pool_{feed_.layout(), 4};
    daemon::FrameRing ring_{2};
    daemon::FrameCompressor compressor_;
    daemon::SensorRing samples_;
    daemon::ClientLog log_;
    // Without a pause between messages.
    daemon::ClientRules rules_{{}, {}, {}, {}, {}};
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
    const auto session = std::make_shared<daemon::ClientSession>(
        daemon::ClientSession::Socket(loop, boost::asio::generic::stream_protocol(AF_UNIX, 0), ends[0]),
        daemon::ClientPeer{.address = "fuzz", .local = true, .user = ::geteuid()}, 1, host);
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
    session->watch();
    loop.poll();
    session->status();
    ::close(ends[1]);
    session->stop();
    loop.poll();
    return 0;
}

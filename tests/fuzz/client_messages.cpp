// SPDX-License-Identifier: Apache-2.0
//
// What a client sends to the daemon: a session of its own for every input, over a real socket, with frames to send.
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/requests/status_request.h"
#include "daemon/socket/clients.h"
#include "daemon/socket/frames/frame_pool.h"
#include "tests/daemon/socket/pattern_frames.h"
#include "tests/fuzz/outcome.h"

using namespace disparityd;

namespace {

daemon::Request granted(v1::Envelope::BodyCase message, std::function<void(v1::Envelope&)> answer) {
    return {.message = message,
            .name = "request",
            .word = "request",
            .changes_something = [](const v1::Envelope&) { return true; },
            .handle = [answer = std::move(answer)](const v1::Envelope&, const daemon::Requester&,
                                                   const daemon::Reply& reply) { reply(daemon::answer_of(answer)); }};
}

/// A daemon that grants everything.
daemon::Requests all_granted() {
    return {daemon::status_request([] { return v1::Status(); }),
            granted(v1::Envelope::kRecordStart, [](v1::Envelope& answer) { answer.mutable_record_status(); }),
            granted(v1::Envelope::kRecordStop, [](v1::Envelope& answer) { answer.mutable_record_status(); }),
            granted(v1::Envelope::kCameraRequest, [](v1::Envelope& answer) { answer.mutable_camera_controls(); }),
            granted(v1::Envelope::kGiveLevel, [](v1::Envelope& answer) { answer.mutable_level_status(); }),
            {.message = v1::Envelope::kTraceRequest,
             .name = "trace_request",
             .word = "trace",
             .handle = [](const v1::Envelope& message, const daemon::Requester&, const daemon::Reply& reply) {
                 const std::size_t parts = message.trace_request().seconds() > 0 ? 2 : 0;
                 reply({std::vector<v1::Envelope>(parts), parts > 0 ? "" : "trace: no time"});
             }}};
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    spdlog::set_level(spdlog::level::off);
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::array<int, 2> ends{};
    fuzz::expect(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) == 0, "socketpair");
    boost::asio::io_context loop;
    test::PatternFrames feed(8, 6, {v1::DISPARITY, v1::CONFIDENCE, v1::DEPTH, v1::LEFT});
    daemon::FramePool pool(feed.layout(), 4);
    // Without a pause between messages. Frames are compressed in the loop, so that the same input always takes the
    // same way.
    daemon::Clients clients(loop, loop.get_executor(), 2, daemon::ClientPlaces(4, SIZE_MAX, false, true),
                            {{}, {}, {}, {}, {}}, all_granted(), [] { return v1::Status(); }, {});
    clients.set_layout(feed.layout());
    clients.frame_arrived(pool.copy(feed.next(), ~0U));
    clients.accept(daemon::ClientSession::Socket(loop, boost::asio::generic::stream_protocol(AF_UNIX, 0), ends[0]),
                   daemon::ClientPeer{.address = "fuzz", .local = true, .user = ::geteuid()});
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
    clients.frame_arrived(pool.copy(feed.next(), ~0U));
    clients.sensors_arrived(std::vector<capture::SensorSample>(2), std::chrono::steady_clock::now());
    clients.set_layout(feed.layout());
    clients.watch();
    loop.poll();
    clients.status();
    ::close(ends[1]);
    clients.end_all();
    loop.poll();
    return 0;
}

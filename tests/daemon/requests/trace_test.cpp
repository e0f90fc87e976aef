// SPDX-License-Identifier: Apache-2.0
//
// Traces of a real daemon, asked for on the wire.
#include <csignal>
#include <limits>
#include <map>

#include <gmock/gmock.h>

#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::HasSubstr;

class TraceTest : public DaemonTest {
protected:
    static constexpr const char* fast_scene = "scene:vga@1000?width=320&height=176&loop=8";

    static bool ask(WireClient& client, double seconds) {
        v1::Envelope request;
        request.mutable_trace_request()->set_seconds(seconds);
        return client.send(request);
    }

    /// Returns the parts of an answer as one trace; nothing where it is refused, and why.
    static std::optional<v1::Trace> receive(WireClient& client, std::string* refusal = nullptr) {
        v1::Trace trace;
        while (const auto message = client.receive(DaemonProcess::patience)) {
            if (message->envelope.has_error() && refusal != nullptr) {
                *refusal = message->envelope.error().message();
                return std::nullopt;
            }
            if (message->envelope.has_trace()) {
                trace.MergeFrom(message->envelope.trace());
                if (message->envelope.trace().last()) {
                    return trace;
                }
            }
        }
        return std::nullopt;
    }

    static WireClient connect(const DaemonProcess& daemon) {
        WireClient client(daemon.address("unix:"));
        client.hello();
        return client;
    }
};

TEST_F(TraceTest, HasWorkOfEveryStageWithinItsTime) {
    const auto daemon = start_ready(config_text(fast_scene, 160, 88, "[scan]\nenabled = true\n"));
    WireClient client = subscriber(daemon->address("tcp:"), {v1::DISPARITY});
    ASSERT_TRUE(client.receive_frame());
    ASSERT_TRUE(ask(client, 0.3));
    const auto trace = receive(client);
    ASSERT_TRUE(trace);
    EXPECT_GE(trace->duration_ns(), 300'000'000U);
    std::map<std::string, int> worked;
    for (const v1::TraceTrack& track : trace->tracks()) {
        for (const v1::TraceEvent& event : track.events()) {
            EXPECT_GE(event.begin_ns(), 0);
            EXPECT_LE(static_cast<std::uint64_t>(event.begin_ns()) + event.duration_ns(), trace->duration_ns());
            ASSERT_LT(event.name(), static_cast<std::uint32_t>(trace->names_size()));
            if (event.kind() == v1::TRACE_WORK) {
                ++worked[trace->names(static_cast<int>(event.name()))];
            }
        }
    }
    for (const char* stage : {"capture", "rectify", "census", "match", "post-process", "scan", "publish"}) {
        EXPECT_GT(worked[stage], 0) << stage;
    }
}

// The times of the steps in a trace are those that the status adds up.
TEST_F(TraceTest, StepsTakeAsLongAsTheStatusSays) {
    const auto daemon = start_ready(config_text(fast_scene));
    WireClient client = connect(*daemon);
    const v1::Status before = status(client);
    ASSERT_TRUE(ask(client, 0.3));
    const auto trace = receive(client);
    const v1::Status after = status(client);
    ASSERT_TRUE(trace);
    std::map<std::string, std::uint64_t> count;
    std::map<std::string, std::uint64_t> sum_ns;
    for (const v1::TraceTrack& track : trace->tracks()) {
        for (const v1::TraceEvent& event : track.events()) {
            if (event.kind() == v1::TRACE_STEP) {
                ++count[trace->names(static_cast<int>(event.name()))];
                sum_ns[trace->names(static_cast<int>(event.name()))] += event.duration_ns();
            }
        }
    }
    for (int i = 0; i < after.totals().steps_size(); ++i) {
        const v1::StepTotal& end = after.totals().steps(i);
        if (!count.contains(end.name())) {
            continue;
        }
        SCOPED_TRACE(end.name());
        const v1::StepTotal* begin = i < before.totals().steps_size() ? &before.totals().steps(i) : nullptr;
        EXPECT_LE(count[end.name()], end.count() - (begin != nullptr ? begin->count() : 0));
        EXPECT_LE(sum_ns[end.name()], end.sum_ns() - (begin != nullptr ? begin->sum_ns() : 0));
        EXPECT_GT(sum_ns[end.name()], 0U);
    }
    EXPECT_GE(count.size(), 3U);
}

TEST_F(TraceTest, FramesAreTheSameMeanwhile) {
    const auto daemon = start_ready(config_text(fast_scene));
    WireClient client = subscriber(daemon->address("unix:"), {v1::DISPARITY, v1::CONFIDENCE, v1::DEPTH});
    std::map<std::uint64_t, std::vector<std::uint8_t>> frames;  // of the scene, which repeats itself
    const auto expect_same = [&frames](const WireClient::Message& message) {
        const auto [frame, first] = frames.try_emplace(message.envelope.frame().sequence() % 8, message.payload);
        EXPECT_TRUE(first || frame->second == message.payload) << "frame " << message.envelope.frame().sequence();
    };
    while (frames.size() < 8) {
        const auto message = client.receive_frame();
        ASSERT_TRUE(message);
        expect_same(*message);
    }
    ASSERT_TRUE(ask(client, 0.3));
    int seen = 0;
    for (bool last = false; !last;) {
        const auto message = client.receive(DaemonProcess::patience);
        ASSERT_TRUE(message);
        if (message->envelope.has_frame()) {
            expect_same(*message);
            ++seen;
        }
        last = message->envelope.has_trace() && message->envelope.trace().last();
    }
    EXPECT_GT(seen, 0);
}

TEST_F(TraceTest, IsRefusedWithAWrongTimeOrBesideAnotherOne) {
    const auto daemon = start_ready(config_text());
    WireClient client = connect(*daemon);
    for (const double seconds : {0.0, 0.01, -1.0, 10.5, std::numeric_limits<double>::quiet_NaN()}) {
        ASSERT_TRUE(ask(client, seconds));
        EXPECT_THAT(client.receive_error(), HasSubstr("allowed: 0.1 to 10"));
    }
    WireClient other = connect(*daemon);
    std::string refusal;
    while (refusal.empty()) {  // the daemon may be slow to read the second question
        ASSERT_TRUE(ask(client, 1));
        ASSERT_TRUE(ask(other, 1));
        receive(client, &refusal);
        receive(other, &refusal);
    }
    EXPECT_THAT(refusal, HasSubstr("another one is being taken"));
}

TEST_F(TraceTest, IsRefusedWhenTheConfigurationChangesMeanwhile) {
    const auto daemon = start_ready(config_text());
    WireClient client = connect(*daemon);
    std::string refusal;
    while (refusal.empty()) {  // a reload may be too late for the first one
        ASSERT_TRUE(ask(client, 1));
        daemon->send_signal(SIGHUP);
        receive(client, &refusal);
    }
    EXPECT_THAT(refusal, HasSubstr("the configuration was loaded again"));
    do {  // a second reload may still be under way
        ASSERT_TRUE(ask(client, 0.1));
    } while (!receive(client, &refusal));
}

// A daemon that stops leaves nobody waiting.
TEST_F(TraceTest, EndsWithTheDaemon) {
    const auto daemon = start_ready(config_text());
    WireClient client = connect(*daemon);
    ASSERT_TRUE(ask(client, 10));
    daemon->send_signal(SIGTERM);
    EXPECT_TRUE(client.is_closed(DaemonProcess::patience));
    EXPECT_EQ(daemon->wait_for_exit(), 0);
}

}  // namespace
}  // namespace disparityd::test

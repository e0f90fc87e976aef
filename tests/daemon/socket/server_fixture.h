// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "daemon/socket/socket_server.h"
#include "tests/daemon/socket/pattern_frames.h"
#include "tests/daemon/wire_client.h"

namespace disparityd::test {

/// A server at a port and a path of its own, fed by hand.
class ServerTest : public ::testing::Test {
protected:
    void start(std::size_t max_clients = 64, std::size_t client_queue = 4) {
        config_.tcp = "127.0.0.1:0";
        config_.max_clients = max_clients;
        config_.client_queue = client_queue;
        restart();
    }

    /// Makes a server from the configuration as it is.
    void restart() {
        config_.unix_path = "/tmp/disparityd-test-" + std::to_string(getpid()) + ".sock";
        const auto daemons_status = [this] {
            if (before_status_) {
                before_status_();
            }
            v1::Status status;
            status.set_state("running");
            return status;
        };
        server_ = std::make_unique<daemon::SocketServer>(
            config_, daemons_status, daemon::Requests{record_start(), record_stop(), camera(), trace()});
        server_->set_layout(feed_.layout());
        server_->start();
        tcp_ = server_->addresses().at(0);
        unix_ = server_->addresses().at(1);
    }

    WireClient connect(const std::string& address, const std::string& name = "test") {
        WireClient client(address);
        const auto welcome = client.hello(name);
        EXPECT_TRUE(welcome && welcome->has_welcome());
        return client;
    }

    /// The refusal of a request; empty: it was granted.
    static std::string ask(WireClient& client, const v1::Envelope& request) {
        EXPECT_TRUE(client.send(request));
        const auto answer = client.receive();
        if (!answer) {
            return "no answer";
        }
        EXPECT_FALSE(answer->envelope.error().closing());
        return answer->envelope.error().message();
    }

    /// What only those who may control are granted.
    static std::vector<v1::Envelope> control_requests() {
        std::vector<v1::Envelope> requests(3);
        requests[0].mutable_record_start()->set_path("a.mkv");
        requests[1].mutable_record_stop();
        requests[2].mutable_camera_request()->add_settings()->set_name("gain-left");
        return requests;
    }

    /// Subscribes and waits until the server has taken it in.
    void subscribe(WireClient& client, const v1::Envelope& subscription) {
        ASSERT_TRUE(client.send(subscription));
        status(client);
    }

    // Requests as a daemon has them, which are answered at once.

    daemon::Request record_start() {
        return {
            .message = v1::Envelope::kRecordStart,
            .name = "record_start",
            .word = "record",
            .changes_something = [](const v1::Envelope&) { return true; },
            .handle =
                [this](const v1::Envelope& message, const daemon::Requester& requester, const daemon::Reply& reply) {
                    const std::string& path = message.record_start().path();
                    asked_by_owner_ = requester.owns_daemon;
                    recorder_ = requester.client;
                    if (path == "held.mkv") {
                        held_answer_.set_value(reply);
                        return;
                    }
                    reply(path.empty() ? daemon::refusal_of("record: no path")
                                       : daemon::answer_of([&](v1::Envelope& answer) {
                                             answer.mutable_record_status()->set_active(true);
                                             answer.mutable_record_status()->set_path(path);
                                         }));
                },
            .goes_on_for = [this](std::uint64_t client) { return recording_ && client == recorder_; },
            .client_is_gone = [this](std::uint64_t client) { gone_ = client; }};
    }

    daemon::Request record_stop() {
        return {.message = v1::Envelope::kRecordStop,
                .name = "record_stop",
                .word = "record",
                .changes_something = [](const v1::Envelope&) { return true; },
                .rate = rate_of_stops_,
                .handle =
                    [this](const v1::Envelope&, const daemon::Requester&, const daemon::Reply& reply) {
                        ++stops_;
                        reply(daemon::answer_of([](v1::Envelope& answer) { answer.mutable_record_status(); }));
                    }};
    }

    static daemon::Request camera() {
        return {
            .message = v1::Envelope::kCameraRequest,
            .name = "camera_request",
            .word = "camera",
            .changes_something = [](const v1::Envelope& asked) { return asked.camera_request().settings_size() > 0; },
            .handle =
                [](const v1::Envelope& message, const daemon::Requester&, const daemon::Reply& reply) {
                    const v1::CameraRequest& request = message.camera_request();
                    if (request.settings_size() == 0) {
                        reply(daemon::refusal_of("camera: nothing asked for"));
                        return;
                    }
                    reply(daemon::answer_of([&](v1::Envelope& answer) {
                        for (const v1::CameraSetting& setting : request.settings()) {
                            v1::CameraControl& control = *answer.mutable_camera_controls()->add_controls();
                            control.set_name(setting.name());
                            control.set_value(setting.value());
                        }
                    }));
                }};
    }

    static daemon::Request trace() {
        return {.message = v1::Envelope::kTraceRequest,
                .name = "trace_request",
                .word = "trace",
                .handle = [](const v1::Envelope& message, const daemon::Requester&, const daemon::Reply& reply) {
                    if (message.trace_request().seconds() <= 0) {
                        reply(daemon::refusal_of("trace: no time"));
                        return;
                    }
                    daemon::Answer answer{std::vector<v1::Envelope>(2), ""};
                    answer.messages[0].mutable_trace()->add_tracks()->set_name("first");
                    answer.messages[1].mutable_trace()->add_tracks()->set_name("second");
                    answer.messages[1].mutable_trace()->set_last(true);
                    reply(std::move(answer));
                }};
    }

    std::atomic<bool> asked_by_owner_{false};           ///< the last recording; read it after the answer
    std::atomic<std::uint64_t> recorder_{0};            ///< who has asked for it
    std::promise<daemon::Reply> held_answer_;           ///< to a recording of "held.mkv"
    std::atomic<std::uint64_t> gone_{0};                ///< the client that has gone last
    std::atomic<bool> recording_{false};                ///< what the server is told of it
    std::atomic<int> stops_{0};                         ///< recordings that clients have ended
    std::shared_ptr<daemon::RateLimit> rate_of_stops_;  ///< set before start(); null: none
    std::function<void()> before_status_;               ///< in the server's thread; set before start()
    daemon::SocketServerConfig config_;
    PatternFrames feed_{64, 48, all_products()};
    std::unique_ptr<daemon::SocketServer> server_;
    std::string tcp_;
    std::string unix_;
};

}  // namespace disparityd::test

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
        daemon::SocketServices services;
        services.status = [this] {
            if (before_status_) {
                before_status_();
            }
            v1::Status status;
            status.set_state("running");
            return status;
        };
        services.start_recording = [this](const daemon::RecordRequest& request,
                                          const daemon::SessionHost::RecordAnswer& answer) {
            v1::RecordStatus status;
            status.set_active(true);
            status.set_path(request.path);
            asked_by_owner_ = request.owner;
            recorder_ = request.client;
            if (request.path == "held.mkv") {
                held_answer_.set_value(answer);
                return;
            }
            answer(status, request.path.empty() ? "record: no path" : "");
        };
        services.stop_recording = [this](const daemon::SessionHost::RecordAnswer& answer) {
            ++stops_;
            answer({}, "");
        };
        services.is_recording_for = [this](std::uint64_t client) { return recording_ && client == recorder_; };
        services.client_is_gone = [this](std::uint64_t client) { gone_ = client; };
        services.control_camera = [](const v1::CameraRequest& request,
                                     const daemon::SessionHost::CameraAnswer& answer) {
            v1::CameraControls controls;
            for (const v1::CameraSetting& setting : request.settings()) {
                v1::CameraControl& control = *controls.add_controls();
                control.set_name(setting.name());
                control.set_value(setting.value());
            }
            answer(controls, request.settings_size() == 0 ? "camera: nothing asked for" : "");
        };
        services.trace = [](const v1::TraceRequest& request, const daemon::SessionHost::TraceAnswer& answer) {
            std::vector<v1::Trace> parts(2);
            parts[0].add_tracks()->set_name("first");
            parts[1].add_tracks()->set_name("second");
            parts[1].set_last(true);
            answer(std::make_shared<const std::vector<v1::Trace>>(std::move(parts)),
                   request.seconds() > 0 ? "" : "trace: no time");
        };
        server_ = std::make_unique<daemon::SocketServer>(config_, services);
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

    std::atomic<bool> asked_by_owner_{false};                      ///< the last recording; read it after the answer
    std::atomic<std::uint64_t> recorder_{0};                       ///< who has asked for it
    std::promise<daemon::SessionHost::RecordAnswer> held_answer_;  ///< to a recording of "held.mkv"
    std::atomic<std::uint64_t> gone_{0};                           ///< the client that has gone last
    std::atomic<bool> recording_{false};                           ///< what the server is told of it
    std::atomic<int> stops_{0};                                    ///< recordings that clients have ended
    std::function<void()> before_status_;                          ///< in the server's thread; set before start()
    daemon::SocketServerConfig config_;
    PatternFrames feed_{64, 48, all_products()};
    std::unique_ptr<daemon::SocketServer> server_;
    std::string tcp_;
    std::string unix_;
};

}  // namespace disparityd::test

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/bridges/web/http_client.h"
#include "tests/daemon/daemon_fixture.h"

namespace disparityd::test {

/// disparity-web as a process, beside a real daemon where a test starts one.
class WebTest : public DaemonTest {
protected:
    static constexpr const char* as_json = "Content-Type: application/json\r\n";

    std::string socket() const { return "unix:" + folder_.path() + "/d.sock"; }

    /// Starts the program on a free port, and sets port().
    std::unique_ptr<DaemonProcess> start_web(const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"--socket", socket()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return launch_web(arguments);
    }

    std::unique_ptr<DaemonProcess> launch_web(std::vector<std::string> arguments,
                                              const DaemonProcess::Environment& environment = {}) {
        arguments.insert(arguments.end(), {"--listen", "127.0.0.1:0"});
        auto web = std::make_unique<DaemonProcess>(folder_, arguments, environment, DISPARITY_WEB);
        const bool listens = web->wait_for_line([this](const std::string& line) {
            const std::size_t colon = line.rfind(':');
            port_ = static_cast<unsigned short>(std::stoi(line.substr(colon + 1)));
            return true;
        });
        EXPECT_TRUE(listens) << web->log();
        return web;
    }

    unsigned short port() const { return port_; }

    static bool is_running(const nlohmann::json& status) { return !status.is_null() && status["state"] == "running"; }

    /// Asks for the status until the daemon is there and runs, or is gone.
    nlohmann::json wait_for_daemon(const std::string& wanted, const std::string& more = "") const {
        const auto deadline = std::chrono::steady_clock::now() + DaemonProcess::patience;
        nlohmann::json status;
        while (std::chrono::steady_clock::now() < deadline) {
            const auto answer = http(port_, "GET", "/api/status", more);
            status = answer ? nlohmann::json::parse(answer->body) : nlohmann::json();
            if (answer && status["daemon"] == wanted && (wanted == "gone" || is_running(status["status"]))) {
                return status;
            }
        }
        ADD_FAILURE() << "the daemon is not " << wanted << ": " << status.dump();
        return status;
    }

    static nlohmann::json header_of(const std::string& message) {
        std::uint32_t size = 0;
        std::memcpy(&size, message.data(), sizeof size);
        return nlohmann::json::parse(message.substr(sizeof size, size));
    }

    /// Returns the next frame's message; texts before it are left out.
    static std::string next_frame(WebSocketClient& client) {
        for (;;) {
            auto [text, message] = client.read();
            if (!text) {
                return message;
            }
        }
    }

private:
    unsigned short port_ = 0;
};

}  // namespace disparityd::test

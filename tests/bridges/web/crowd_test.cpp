// SPDX-License-Identifier: Apache-2.0
//
// disparity-web with more visitors than places: those that ask for nothing make place, streams leave some for requests.
#include <sys/stat.h>

#include "tests/bridges/web/web_fixture.h"

namespace disparityd::test {
namespace {

constexpr const char* live_upgrade =
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: disparityd.live.v1\r\n";

class CrowdTest : public WebTest {
protected:
    CrowdTest() : daemon_(start_ready(config_text())) {}

    /// What monitoring and a new page ask for.
    void expect_requests_are_answered(const std::string& more = "") {
        for (const char* target : {"/healthz", "/metrics", "/"}) {
            const auto answer = http(port(), "GET", target, more);
            ASSERT_TRUE(answer) << target;
            EXPECT_EQ(answer->status, 200U) << target;
        }
    }

    /// A page connects again when it is refused: those that have left may still have their places.
    void expect_a_page_gets_frames() {
        const auto deadline = std::chrono::steady_clock::now() + DaemonProcess::patience;
        for (bool connected = false; !connected && std::chrono::steady_clock::now() < deadline;) {
            try {
                WebSocketClient page(port(), "disparityd.live.v1");
                page.send(R"({"type":"subscribe","images":["disparity"]})");
                connected = header_of(next_frame(page))["type"] == "frame";
            } catch (const boost::system::system_error&) {
            }
            if (connected) {
                return;
            }
        }
        ADD_FAILURE() << "no page gets frames";
    }

    std::unique_ptr<DaemonProcess> daemon_;
};

TEST_F(CrowdTest, WebSocketsThatAskForNothingKeepNobodyOut) {
    const auto web = start_web({"--max-connections", "16"});
    wait_for_daemon("there");
    std::vector<std::unique_ptr<WebSocketClient>> silent;
    for (int i = 0; i < 40; ++i) {
        silent.push_back(
            std::make_unique<WebSocketClient>(port(), i % 2 == 0 ? "disparityd.live.v1" : "foxglove.sdk.v1"));
        if (i % 4 == 0) {
            silent.back()->send(R"({"type":"subscribe","images":[]})");
        }
    }
    expect_requests_are_answered();
    expect_a_page_gets_frames();
}

TEST_F(CrowdTest, StreamsLeavePlacesForRequests) {
    const auto web = start_web({"--max-connections", "16"});
    wait_for_daemon("there");
    std::vector<std::unique_ptr<HttpClient>> viewers;
    for (int i = 0; i < 20; ++i) {
        viewers.push_back(std::make_unique<HttpClient>(port()));
        const auto head = viewers.back()->ask("GET", "/stream.mjpg?width=16");
        ASSERT_TRUE(head);
        EXPECT_EQ(head->status, i < 14 ? 200U : 503U) << i;
        if (i >= 14) {
            EXPECT_THAT(head->body, testing::HasSubstr("all 14 places for pages and streams are taken"));
        }
    }
    expect_requests_are_answered();
    viewers.clear();
    expect_a_page_gets_frames();
}

TEST_F(CrowdTest, ViewersLeavePlacesForControllers) {
    const std::string tokens = folder_.write("tokens", "view 0123456789abcdef\ncontrol fedcba9876543210\n");
    chmod(tokens.c_str(), 0600);
    const auto web = start_web({"--max-connections", "16", "--token-file", tokens});
    const std::string viewer = "Authorization: Bearer 0123456789abcdef\r\n";
    const std::string controller = "Authorization: Bearer fedcba9876543210\r\n";
    wait_for_daemon("there", viewer);
    std::vector<std::unique_ptr<HttpClient>> pages;
    const auto open = [&](const std::string& who) {
        pages.push_back(std::make_unique<HttpClient>(port()));
        // Subscribed, so that none of them is idle: a masked text frame with a mask of zeros.
        const std::string text = R"({"type":"subscribe","images":["left"]})";
        const auto answer = pages.back()->ask("GET", "/live", live_upgrade + who);
        pages.back()->send(std::string("\x81") + static_cast<char>(0x80U + text.size()) + std::string(4, '\0') + text);
        return answer ? answer->status : 0U;
    };
    for (int i = 0; i < 12; ++i) {
        EXPECT_EQ(open(viewer), 101U) << i;
    }
    // The subscription of the last one may not have been read yet: it then is idle, and makes place once.
    unsigned status = 101;
    for (int i = 0; i < 50 && status == 101; ++i) {
        status = open(viewer);
    }
    EXPECT_EQ(status, 503U);
    EXPECT_EQ(open(controller), 101U);
    expect_requests_are_answered(viewer);
}

}  // namespace
}  // namespace disparityd::test

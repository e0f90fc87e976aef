// SPDX-License-Identifier: Apache-2.0
//
// disparity-web and visitors who mean no good: others still get their frames, and the program lives.
#include <csignal>

#include <boost/asio/write.hpp>

#include "tests/bridges/web/web_fixture.h"

namespace disparityd::test {
namespace {

using nlohmann::json;

class HostileTest : public WebTest {
protected:
    HostileTest() : daemon_(start_ready(config_text())), web_(start_web({"--max-connections", "16"})) {
        wait_for_daemon("there");
    }

    /// The program still serves frames, and ends in order. Whether the daemon drops frames depends on how busy the
    /// machine is: lab/measure-page tells.
    void expect_service() {
        WebSocketClient page(port(), "disparityd.live.v1");
        page.send(R"({"type":"subscribe","images":["disparity"]})");
        EXPECT_EQ(header_of(next_frame(page))["type"], "frame");
        wait_for_daemon("there");
        web_->send_signal(SIGTERM);
        EXPECT_EQ(web_->wait_for_exit(), 0) << web_->log();
    }

    std::unique_ptr<DaemonProcess> daemon_;
    std::unique_ptr<DaemonProcess> web_;
};

TEST_F(HostileTest, ConnectionsThatSayNothingKeepNobodyOut) {
    std::vector<std::unique_ptr<HttpClient>> silent;
    for (int i = 0; i < 100; ++i) {
        silent.push_back(std::make_unique<HttpClient>(port()));
        if (i % 2 == 0) {
            silent.back()->send("GET / HTTP/1.1\r\nHost: 127");  // and never the rest
        }
        if (i % 10 == 0) {
            EXPECT_EQ(http(port(), "GET", "/api/session")->status, 200U);
        }
    }
    EXPECT_TRUE(silent.front()->ended()) << "the one that waited longest made place";
    expect_service();
}

TEST_F(HostileTest, WhatIsNoRequestEndsTheConnection) {
    const std::string long_line(9000, 'a');
    for (const std::string& bytes :
         {std::string("\x16\x03\x01\x02\x00\x01", 6), std::string("GET\r\n\r\n"),
          "GET /" + long_line + " HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\nX: " + long_line + "\r\n\r\n",
          std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET / HTTP/1.1\r\nContent-Length: x\r\n\r\n"),
          std::string("POST /api/session HTTP/1.1\r\nContent-Length: 99999999\r\n\r\n"),
          std::string("POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nFFFFFFFFFFFFFFFFF\r\n"),
          std::string(100, '\0')}) {
        HttpClient client(port());
        client.send(bytes);
        EXPECT_TRUE(client.ended()) << bytes.substr(0, 60);
    }
    expect_service();
}

TEST_F(HostileTest, OtherNamesAndOtherPagesAreRefused) {
    HttpClient rebound(port());
    rebound.send("GET /api/status HTTP/1.1\r\nHost: evil.example\r\n\r\n");
    EXPECT_EQ(rebound.answer()->status, 403U);
    HttpClient nameless(port());
    nameless.send("GET /api/status HTTP/1.1\r\n\r\n");
    EXPECT_EQ(nameless.answer()->status, 403U);
    for (const char* target : {"/", "/api/status", "/snapshot.png", "/stream.mjpg", "/metrics", "/healthz"}) {
        EXPECT_EQ(http(port(), "GET", target, "Origin: http://evil.example\r\n")->status, 403U) << target;
    }
    const std::string upgrade =
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: disparityd.live.v1\r\n";
    EXPECT_EQ(http(port(), "GET", "/live", upgrade)->status, 101U);
    EXPECT_EQ(http(port(), "GET", "/live", upgrade + "Origin: http://evil.example\r\n")->status, 403U);
    EXPECT_EQ(http(port(), "GET", "/live",
                   "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n")
                  ->status,
              400U);
    expect_service();
}

TEST_F(HostileTest, BadMessagesAndBadFramesOfWebSockets) {
    for (const std::string& text :
         {std::string("{"), std::string(60000, '['), std::string("{\"type\":\"subscribe\",\"images\":7}")}) {
        WebSocketClient page(port(), "disparityd.live.v1");
        page.send(text);
        for (bool told = false; !told;) {
            told = json::parse(page.read().second)["type"] == "error";
        }
    }
    WebSocketClient binary(port(), "disparityd.live.v1");
    binary.send_binary(std::string(1000, '\7'));
    WebSocketClient viewer(port(), "foxglove.sdk.v1");
    viewer.send("{\"op\":7}");
    viewer.send_binary(std::string(1000, '\7'));
    for (const std::string& bytes :
         {std::string("\x81\x05hello"), std::string("\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff"),
          std::string("\x82\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14), std::string("\x80\x80\0\0\0\0", 6)}) {
        WebSocketClient page(port(), "disparityd.live.v1");
        boost::asio::write(page.socket(), boost::asio::buffer(bytes));
        EXPECT_THROW(
            for (;;) { page.read(); }, boost::system::system_error);
    }
    WebSocketClient large(port(), "disparityd.live.v1");
    EXPECT_THROW(
        {
            large.send(std::string(100000, ' '));
            for (;;) {
                large.read();
            }
        },
        boost::system::system_error);
    expect_service();
}

TEST_F(HostileTest, AViewerThatReadsNothingKeepsNobodyWaiting) {
    HttpClient viewer(port());
    viewer.send("GET /stream.mjpg HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    WebSocketClient deaf(port(), "disparityd.live.v1");
    deaf.send(R"({"type":"subscribe","images":["left","disparity"],"encoding":"lossless"})");
    WebSocketClient page(port(), "disparityd.live.v1");
    page.send(R"({"type":"subscribe","images":["disparity"]})");
    for (int i = 0; i < 30; ++i) {
        const json frame = header_of(next_frame(page));
        page.send(R"({"type":"seen","publish_index":)" + frame["publish_index"].dump() + "}");
    }
    expect_service();
}

}  // namespace
}  // namespace disparityd::test

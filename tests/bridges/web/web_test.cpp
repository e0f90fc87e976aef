// SPDX-License-Identifier: Apache-2.0
//
// disparity-web beside a real daemon: what a visitor gets.
#include <csignal>

#include <opencv2/imgcodecs.hpp>

#include "tests/bridges/web/web_fixture.h"

namespace disparityd::test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

cv::Mat decoded(const std::string& bytes) {
    return cv::imdecode(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED);
}

class WebPageTest : public WebTest {
protected:
    std::unique_ptr<DaemonProcess> start_daemon() {
        return start_ready(config_text(scene, 160, 88, "[scan]\nenabled = true\n"));
    }
};

TEST_F(WebPageTest, ThePageAndItsHeaders) {
    const auto web = start_web();
    const auto page = http(port(), "GET", "/");
    ASSERT_TRUE(page);
    EXPECT_EQ(page->status, 200U);
    EXPECT_THAT(page->body, HasSubstr("<!DOCTYPE html>"));
    EXPECT_THAT(page->head.at("content-security-policy"), StartsWith("default-src 'none'; script-src 'self'"));
    EXPECT_EQ(page->head.at("x-content-type-options"), "nosniff");
    const auto head = HttpClient(port());
    EXPECT_EQ(http(port(), "GET", "/page.css")->head.at("content-type"), "text/css; charset=utf-8");
}

TEST_F(WebPageTest, NothingButThePagesFilesIsThere) {
    const auto web = start_web();
    for (const char* target : {"/../options.cpp", "/..%2f..%2fetc/passwd", "//etc/passwd", "/page.css/", "/PAGE.CSS",
                               "/index.html", "/%00", "/?x", "/page.css?x=../../"}) {
        const auto answer = http(port(), "GET", target);
        ASSERT_TRUE(answer) << target;
        const bool query = std::string(target).find('?') != std::string::npos;
        EXPECT_EQ(answer->status, query ? 200U : 404U) << target;
    }
}

TEST_F(WebPageTest, TheStatusIsTheDaemons) {
    const auto web = start_web();
    EXPECT_EQ(wait_for_daemon("gone")["status"], nullptr);
    EXPECT_EQ(http(port(), "GET", "/healthz")->status, 503U);
    const auto daemon = start_daemon();
    const json status = wait_for_daemon("there");
    EXPECT_EQ(status["status"]["method"], "census");
    EXPECT_EQ(status["status"]["source"], scene);
    EXPECT_EQ(http(port(), "GET", "/healthz")->body, "ok\n");
    EXPECT_THAT(http(port(), "GET", "/metrics")->body, HasSubstr("\ndisparityd_up 1\n"));
}

TEST_F(WebPageTest, ADaemonThatIsKilledIsSaidAndItsNextOneFound) {
    const auto web = start_web();
    auto daemon = start_daemon();
    wait_for_daemon("there");
    WebSocketClient page(port(), "disparityd.live.v1");
    page.send(R"({"type":"subscribe","images":["disparity"]})");
    const auto next_capture = [&page] {
        const json frame = header_of(next_frame(page));
        page.send(R"({"type":"seen","publish_index":)" + frame["publish_index"].dump() + "}");
        return frame["captured_ms"].get<double>();
    };
    next_capture();
    daemon->send_signal(SIGKILL);
    EXPECT_EQ(daemon->wait_for_exit(), 128 + SIGKILL);
    EXPECT_NE(wait_for_daemon("gone")["why"], "");
    const double restart_ms =
        std::chrono::duration<double, std::milli>(std::chrono::system_clock::now().time_since_epoch()).count();
    daemon = start_daemon();
    // Frames of the first daemon may still be on their way.
    while (next_capture() < restart_ms) {
    }
    web->send_signal(SIGTERM);
    EXPECT_EQ(web->wait_for_exit(), 0) << web->log();
}

TEST_F(WebPageTest, SnapshotsAreOfTheFrame) {
    const auto daemon = start_daemon();
    const auto web = start_web();
    wait_for_daemon("there");
    const cv::Mat disparity = decoded(http(port(), "GET", "/snapshot.png")->body);
    EXPECT_EQ(disparity.type(), CV_16UC1);
    EXPECT_EQ(disparity.size(), cv::Size(160, 88));
    const cv::Mat left = decoded(http(port(), "GET", "/snapshot.png?image=left")->body);
    EXPECT_EQ(left.type(), CV_8UC1);
    const cv::Mat coloured = decoded(http(port(), "GET", "/snapshot.jpg?image=depth")->body);
    EXPECT_EQ(coloured.type(), CV_8UC3);
    EXPECT_THAT(http(port(), "GET", "/snapshot.ply")->body, StartsWith("ply\nformat binary_little_endian 1.0\n"));
    EXPECT_EQ(http(port(), "GET", "/snapshot.png?image=x")->status, 400U);
    const auto missing = http(port(), "GET", "/snapshot.png?image=depth_error");
    EXPECT_EQ(missing->status, 404U);
    EXPECT_THAT(missing->body, HasSubstr("= true in its configuration"));
}

TEST_F(WebPageTest, AStreamOfJpegs) {
    const auto daemon = start_daemon();
    const auto web = start_web();
    wait_for_daemon("there");
    HttpClient viewer(port());
    const auto head = viewer.ask("GET", "/stream.mjpg?image=left&width=80");
    ASSERT_TRUE(head);
    EXPECT_EQ(head->head.at("content-type"), "multipart/x-mixed-replace; boundary=disparityd-frame");
    EXPECT_NE(head->head.at("x-max-rate"), "");
    EXPECT_EQ(HttpClient(port()).ask("GET", "/stream.mjpg?rate=2")->head.at("x-max-rate"), "2");
    for (int i = 0; i < 3; ++i) {
        const auto part = viewer.answer();
        ASSERT_TRUE(part);
        EXPECT_EQ(part->head.at("content-type"), "image/jpeg");
        EXPECT_EQ(decoded(part->body).size(), cv::Size(80, 44));
    }
}

TEST_F(WebPageTest, ViewersOfAStreamAndOfFoxgloveAreToldThatTheDaemonHasGone) {
    auto daemon = start_daemon();
    const auto web = start_web();
    wait_for_daemon("there");
    HttpClient viewer(port());
    ASSERT_TRUE(viewer.ask("GET", "/stream.mjpg?image=left&width=80"));
    WebSocketClient foxglove(port(), "foxglove.sdk.v1");
    foxglove.read();
    json channel;
    const json advertise = json::parse(foxglove.read().second);
    for (const json& offered : advertise["channels"]) {
        channel = offered["topic"] == "/status" ? offered["id"] : channel;
    }
    foxglove.send(json{{"op", "subscribe"}, {"subscriptions", {{{"id", 5}, {"channelId", channel}}}}}.dump());
    const auto next_status = [&foxglove] { return json::parse(next_frame(foxglove).substr(13)); };
    const auto next_part = [&viewer](const char* fact) {
        auto part = viewer.answer();
        while (part && part->head.count(fact) == 0) {
            part = viewer.answer();
        }
        return part;
    };
    ASSERT_TRUE(next_part("x-timestamp"));
    EXPECT_EQ(next_status()["state"], "running");
    daemon->send_signal(SIGKILL);
    daemon->wait_for_exit();
    // The second one ends the first: browsers wait for that.
    for (int i = 0; i < 2; ++i) {
        const auto part = next_part("x-no-picture");
        ASSERT_TRUE(part);
        EXPECT_EQ(decoded(part->body).size(), cv::Size(80, 44));
        EXPECT_EQ(part->head.count("x-timestamp"), 0U);
    }
    json status = next_status();
    while (status["state"] != "gone") {
        status = next_status();
    }
    EXPECT_NE(status["detail"], "");
    EXPECT_EQ(status["source"], scene) << "the last that is known";
    daemon = start_daemon();
    ASSERT_TRUE(next_part("x-timestamp"));
    while (next_status()["state"] != "running") {
    }
}

TEST_F(WebPageTest, FramesOfAWebSocket) {
    const auto daemon = start_daemon();
    const auto web = start_web();
    wait_for_daemon("there");
    WebSocketClient page(port(), "disparityd.live.v1");
    EXPECT_EQ(page.protocol(), "disparityd.live.v1");
    page.send(R"({"type":"subscribe","images":["left","disparity"],"cloud_step":4,"scan":true})");
    page.send(R"({"type":"point","x":80,"y":44})");
    json last;
    for (int i = 0; i < 5; ++i) {
        const std::string message = next_frame(page);
        const json frame = header_of(message);
        ASSERT_EQ(frame["images"].size(), 2U);
        const json& disparity = frame["images"][1];
        std::uint32_t head = 0;
        std::memcpy(&head, message.data(), sizeof head);
        const cv::Mat picture = decoded(
            message.substr(4 + head + disparity["offset"].get<std::size_t>(), disparity["bytes"].get<std::size_t>()));
        EXPECT_EQ(picture.size(), cv::Size(160, 88));
        EXPECT_EQ(frame["scan"]["sectors"].size(), 72U);
        EXPECT_EQ(frame["cloud"]["width"], 40);
        if (!last.is_null()) {
            EXPECT_GT(frame["publish_index"], last["publish_index"]);
        }
        last = frame;
        page.send(R"({"type":"seen","publish_index":)" + frame["publish_index"].dump() + "}");
    }
    EXPECT_TRUE(last.contains("point"));
}

TEST_F(WebPageTest, APageThatSeesNothingGetsTwoFramesAndThenTheNewest) {
    const auto daemon = start_daemon();
    const auto web = start_web();
    wait_for_daemon("there");
    WebSocketClient page(port(), "disparityd.live.v1");
    page.send(R"({"type":"subscribe","images":["disparity"]})");
    next_frame(page);
    const json second = header_of(next_frame(page));
    // Ten statuses, that is five seconds, come without a frame between them.
    for (int statuses = 0; statuses < 10;) {
        const auto [text, message] = page.read();
        ASSERT_TRUE(text) << "a third frame is under way";
        statuses += json::parse(message)["type"] == "status" ? 1 : 0;
    }
    page.send(R"({"type":"seen","publish_index":)" + second["publish_index"].dump() + "}");
    const json third = header_of(next_frame(page));
    EXPECT_GT(third["skipped"], 5);
    EXPECT_LT(third["age_ms"], 5000);
}

TEST_F(WebPageTest, ASlowPageGetsSmallerImages) {
    const auto daemon = start_daemon();
    const auto web = start_web();
    wait_for_daemon("there");
    WebSocketClient page(port(), "disparityd.live.v1");
    page.send(R"({"type":"subscribe","images":["disparity"]})");
    // Each frame is seen when two statuses have come after it, that is, half a second later at the earliest.
    json frame;
    while (frame["scale"] != 4) {
        frame = header_of(next_frame(page));
        for (int statuses = 0; statuses < 2;) {
            const auto [text, message] = page.read();
            statuses += text && json::parse(message)["type"] == "status" ? 1 : 0;
            frame = text ? frame : header_of(message);
        }
        page.send(R"({"type":"seen","publish_index":)" + frame["publish_index"].dump() + "}");
    }
    EXPECT_EQ(frame["images"][0]["width"], 40);
    // Values are wanted whole, and are not said to be fewer.
    page.send(R"({"type":"subscribe","images":["disparity"],"encoding":"lossless"})");
    do {
        frame = header_of(next_frame(page));
        page.send(R"({"type":"seen","publish_index":)" + frame["publish_index"].dump() + "}");
    } while (frame["images"][0]["encoding"] == "jpeg");
    EXPECT_EQ(frame["images"][0]["width"], 160);
    EXPECT_EQ(frame["scale"], 1);
}

TEST_F(WebPageTest, FoxglovesViewersAreGreeted) {
    const auto daemon = start_daemon();
    const auto web = start_web();
    wait_for_daemon("there");
    for (const char* protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
        WebSocketClient viewer(port(), protocol);
        EXPECT_EQ(viewer.protocol(), protocol);
        EXPECT_EQ(json::parse(viewer.read().second)["op"], "serverInfo");
        const json advertise = json::parse(viewer.read().second);
        EXPECT_EQ(advertise["op"], "advertise");
        json depth;
        for (const json& channel : advertise["channels"]) {
            depth = channel["topic"] == "/disparity" ? channel["id"] : depth;
        }
        viewer.send(json{{"op", "subscribe"}, {"subscriptions", {{{"id", 5}, {"channelId", depth}}}}}.dump());
        const std::string message = next_frame(viewer);
        EXPECT_EQ(message[0], 1);
        EXPECT_EQ(message[1], 5);
    }
}

TEST_F(WebPageTest, ProductsFollowAReload) {
    const auto daemon = start_daemon();
    const auto web = start_web();
    const json before = wait_for_daemon("there")["status"]["products"];
    EXPECT_THAT(before, Contains("depth"));
    EXPECT_THAT(before, Not(Contains("depth_error")));
    EXPECT_EQ(http(port(), "GET", "/snapshot.png?image=depth_error")->status, 404U);
    WebSocketClient page(port(), "disparityd.live.v1");
    EXPECT_EQ(json::parse(page.read().second)["products"], before);

    std::string config = config_text();
    config.insert(config.find("method ="), "depth = false\ndepth_error = true\n");
    folder_.write("d.toml", config);
    daemon->send_signal(SIGHUP);
    json hello;
    while (hello["type"] != "hello") {
        hello = json::parse(page.read().second);
    }
    EXPECT_THAT(hello["products"], Contains("depth_error"));
    EXPECT_THAT(hello["products"], Not(Contains("depth")));
    EXPECT_EQ(http(port(), "GET", "/snapshot.png?image=depth_error")->status, 200U);
}

TEST_F(WebPageTest, ControlIsARightOfItsOwn) {
    const auto daemon = start_daemon();
    const auto looks = start_web();
    wait_for_daemon("there");
    const std::string start = R"({"path":"a.mkv"})";
    EXPECT_EQ(http(port(), "POST", "/api/recording", as_json, start)->status, 403U);
    EXPECT_EQ(http(port(), "DELETE", "/api/recording")->status, 403U);
    EXPECT_EQ(http(port(), "POST", "/api/camera", as_json, R"({"name":"gain-left","value":1})")->status, 403U);
    EXPECT_EQ(json::parse(http(port(), "GET", "/api/session")->body)["control"], false);
    const auto controls = start_web({"--allow-control"});
    const auto started = http(port(), "POST", "/api/recording", as_json, start);
    EXPECT_EQ(started->status, 200U) << started->body;
    EXPECT_EQ(json::parse(started->body)["active"], true);
    EXPECT_EQ(http(port(), "POST", "/api/recording", as_json, start)->status, 409U);
    EXPECT_EQ(http(port(), "POST", "/api/recording", "Content-Type: text/plain\r\n", start)->status, 400U);
    EXPECT_EQ(http(port(), "POST", "/api/recording", as_json, "{")->status, 400U);
    EXPECT_EQ(http(port(), "PUT", "/api/recording")->status, 400U);
    const auto stopped = http(port(), "DELETE", "/api/recording");
    EXPECT_EQ(stopped->status, 200U) << stopped->body;
    EXPECT_THAT(http(port(), "GET", "/api/camera")->body, HasSubstr("is no camera"));
}

TEST_F(WebPageTest, TokensOpenTheDoor) {
    const auto daemon = start_daemon();
    const std::string tokens = folder_.write("tokens", "view 0123456789abcdef\ncontrol fedcba9876543210\n");
    chmod(tokens.c_str(), 0600);
    const auto web = start_web({"--token-file", tokens});
    EXPECT_EQ(http(port(), "GET", "/")->status, 200U) << "the page asks for the token";
    EXPECT_EQ(http(port(), "GET", "/api/status")->status, 401U);
    EXPECT_EQ(http(port(), "GET", "/metrics")->status, 401U);
    EXPECT_EQ(http(port(), "GET", "/snapshot.png")->status, 401U);
    EXPECT_EQ(http(port(), "GET", "/stream.mjpg")->status, 401U);
    EXPECT_THROW(WebSocketClient(port(), "disparityd.live.v1"), boost::system::system_error);
    EXPECT_EQ(http(port(), "GET", "/api/status", "Authorization: Bearer 0123456789abcdef\r\n")->status, 200U);
    EXPECT_EQ(http(port(), "DELETE", "/api/recording", "Authorization: Bearer 0123456789abcdef\r\n")->status, 403U);
    const auto session = http(port(), "POST", "/api/session", as_json, R"({"token":"fedcba9876543210"})");
    ASSERT_EQ(session->status, 200U);
    EXPECT_EQ(json::parse(session->body)["control"], true);
    const std::string cookie = session->head.at("set-cookie");
    EXPECT_EQ(http(port(), "GET", "/api/status", "Cookie: " + cookie.substr(0, cookie.find(';')) + "\r\n")->status,
              200U);
    EXPECT_EQ(http(port(), "POST", "/api/session", as_json, R"({"token":"wrong"})")->status, 403U);
    EXPECT_EQ(http(port(), "POST", "/api/session", as_json, R"({"token":"fedcba9876543210"})")->status, 200U)
        << "a right token waits for nobody";
}

TEST_F(WebPageTest, WhoGuessesTokensIsToldToWait) {
    const auto daemon = start_daemon();
    const std::string tokens = folder_.write("tokens", "view 0123456789abcdef\n");
    chmod(tokens.c_str(), 0600);
    const auto web = start_web({"--token-file", tokens});
    const auto logged_in = http(port(), "POST", "/api/session", as_json, R"({"token":"0123456789abcdef"})");
    const std::string right = "Authorization: Bearer 0123456789abcdef\r\n";
    unsigned status = 0;
    int guesses = 0;
    // The time that this takes gives some of them back.
    for (; status != 429U && guesses < 1000; ++guesses) {
        status = http(port(), "GET", "/api/status", "Authorization: Bearer 000000000000000f\r\n")->status;
    }
    EXPECT_GT(guesses, 10);
    ASSERT_EQ(status, 429U);
    EXPECT_EQ(http(port(), "POST", "/api/session", as_json, R"({"token":"000000000000000f"})")->status, 429U);
    HttpClient guesser(port());
    EXPECT_EQ(guesser.ask("GET", "/api/status", "Authorization: Bearer 000000000000000f\r\n")->status, 429U);
    EXPECT_TRUE(guesser.ended()) << "each further guess costs a connection";
    for (int i = 0; i < 40; ++i) {
        EXPECT_EQ(http(port(), "GET", "/api/status", right)->status, 200U) << "others may share the address";
    }
    EXPECT_EQ(http(port(), "POST", "/api/session", as_json, R"({"token":"0123456789abcdef"})")->status, 200U);
    EXPECT_EQ(http(port(), "GET", "/")->status, 200U);
    const std::string cookie = logged_in->head.at("set-cookie");
    EXPECT_EQ(http(port(), "GET", "/api/session", "Cookie: " + cookie.substr(0, cookie.find(';')) + "\r\n")->status,
              200U)
        << "who has logged in does not notice";
}

}  // namespace
}  // namespace disparityd::test

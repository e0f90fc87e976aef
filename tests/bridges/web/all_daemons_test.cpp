// SPDX-License-Identifier: Apache-2.0
//
// disparity-web --all beside several real daemons.
#include <csignal>
#include <map>

#include <opencv2/imgcodecs.hpp>

#include "tests/bridges/web/web_fixture.h"

namespace disparityd::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class AllDaemonsTest : public WebTest {
protected:
    AllDaemonsTest() : environment_{{"XDG_RUNTIME_DIR", folder_.path()}} {}
    ~AllDaemonsTest() override {
        for (const std::string& name : names_) {
            ::shm_unlink(("/disparityd." + name).c_str());
        }
    }

    /// Returns a daemon's name that no other test has.
    static std::string named(const std::string& name) { return name + '-' + std::to_string(getpid()); }
    static std::string at(const std::string& name, const std::string& path = "") {
        return "/i/" + named(name) + '/' + path;
    }

    /// A daemon where clients look for it by its name. Frames are `width` px wide.
    std::unique_ptr<DaemonProcess> start_named(const std::string& name, int width = 160) {
        names_.push_back(named(name));
        return start_ready(
            config_text(scene, width, 88),
            {"--name", named(name), "--set", "socket.unix=" + folder_.path() + "/disparityd-" + named(name) + ".sock"});
    }

    std::unique_ptr<DaemonProcess> start_all(std::vector<std::string> more = {}) {
        more.emplace_back("--all");
        return launch_web(more, environment_);
    }

    static json parsed(const std::optional<HttpAnswer>& answer) {
        return answer ? json::parse(answer->body, nullptr, false) : json();
    }

    /// Waits until a daemon is "there" and runs, or is "gone". Returns its entry in the list.
    json wait_for(const std::string& name, const std::string& wanted) const {
        const auto deadline = std::chrono::steady_clock::now() + DaemonProcess::patience;
        json list;
        while (std::chrono::steady_clock::now() < deadline) {
            list = parsed(http(port(), "GET", "/api/instances"));
            for (const json& entry : list.value("instances", json::array())) {
                if (entry["name"] == named(name) && entry["daemon"] == wanted &&
                    (wanted == "gone" || entry.value("state", "") == "running")) {
                    return entry;
                }
            }
        }
        ADD_FAILURE() << named(name) << " is not " << wanted << ": " << list.dump();
        return {};
    }

    std::string metric(const std::string& name, const std::string& metric) const {
        const std::string text = http(port(), "GET", "/metrics")->body;
        const std::string begin = '\n' + metric + "{camera=\"" + named(name) + "\"} ";
        const std::size_t found = text.find(begin);
        return found == std::string::npos
                   ? "absent"
                   : text.substr(found + begin.size(), text.find('\n', found + 1) - found - begin.size());
    }

    int snapshot_width(const std::string& name) const {
        const auto answer = http(port(), "GET", at(name, "snapshot.png"));
        const std::vector<std::uint8_t> bytes(answer->body.begin(), answer->body.end());
        return answer->status == 200 ? cv::imdecode(bytes, cv::IMREAD_UNCHANGED).cols : 0;
    }

private:
    DaemonProcess::Environment environment_;
    std::vector<std::string> names_;
};

/// Reads so many frames, each of which is seen.
void read_frames(WebSocketClient& page, int count) {
    for (int i = 0; i < count;) {
        const auto [text, message] = page.read();
        if (text) {
            continue;
        }
        std::uint32_t size = 0;
        std::memcpy(&size, message.data(), sizeof size);
        const json frame = json::parse(message.substr(sizeof size, size));
        page.send(R"({"type":"seen","publish_index":)" + frame["publish_index"].dump() + "}");
        ++i;
    }
}

TEST_F(AllDaemonsTest, EachIsFoundAndHasItsOwnPlace) {
    const auto web = start_all();
    const json none = parsed(http(port(), "GET", "/api/instances"));
    EXPECT_EQ(none["instances"].empty(), !none["note"].get<std::string>().empty()) << none.dump();
    const auto front = start_named("front", 160);
    const auto rear = start_named("rear", 128);
    const json entry = wait_for("front", "there");
    EXPECT_EQ(entry["path"], at("front"));
    EXPECT_EQ(entry["source"], scene);
    wait_for("rear", "there");
    EXPECT_EQ(snapshot_width("front"), 160);
    EXPECT_EQ(snapshot_width("rear"), 128);
    EXPECT_EQ(parsed(http(port(), "GET", at("rear", "api/status")))["status"]["geometry"]["width"], 128);
    EXPECT_EQ(http(port(), "GET", at("rear", "healthz"))->body, "ok\n");
    EXPECT_EQ(metric("front", "disparityd_up"), "1");
    EXPECT_EQ(metric("rear", "disparityd_up"), "1");
    EXPECT_THAT(http(port(), "GET", at("rear", "metrics"))->body, Not(HasSubstr("camera=")));
    WebSocketClient page(port(), "disparityd.live.v1", at("rear", "live"));
    page.send(R"({"type":"subscribe","images":["disparity"]})");
    EXPECT_EQ(header_of(next_frame(page))["width"], 128);
    // A third one comes while the server runs.
    const auto top = start_named("top");
    wait_for("top", "there");
    EXPECT_EQ(metric("top", "disparityd_up"), "1");
}

TEST_F(AllDaemonsTest, WhatIsOfNoDaemonIsSaid) {
    const auto web = start_all();
    EXPECT_THAT(http(port(), "GET", "/")->body, HasSubstr("/overview.js"));
    for (const std::string& path : {at("nobody"), "/i/" + named("nobody")}) {
        EXPECT_THAT(http(port(), "GET", path)->body, HasSubstr("/main.js")) << "a page that waits for its daemon";
    }
    const auto absent = http(port(), "GET", at("nobody", "api/status"));
    EXPECT_EQ(absent->status, 404U);
    EXPECT_THAT(absent->body, HasSubstr("no daemon of this name was found"));
    EXPECT_EQ(http(port(), "GET", at("nobody", "healthz"))->status, 503U);
    for (const char* path : {"/snapshot.png", "/stream.mjpg", "/api/status", "/api/camera", "/overview.html",
                             "/i/../api/status", "/i/a%20b/api/status"}) {
        EXPECT_EQ(http(port(), "GET", path)->status, 404U) << path;
    }
    for (const std::string& path : {std::string("/live"), at("nobody", "live")}) {
        EXPECT_THROW(WebSocketClient(port(), "disparityd.live.v1", path), boost::system::system_error) << path;
    }
}

TEST_F(AllDaemonsTest, OneThatIsKilledOrStoppedIsToldAndFoundAgain) {
    const auto web = start_all();
    auto front = start_named("front");
    const auto rear = start_named("rear");
    wait_for("front", "there");
    wait_for("rear", "there");
    front->send_signal(SIGKILL);
    EXPECT_EQ(front->wait_for_exit(), 128 + SIGKILL);
    EXPECT_NE(wait_for("front", "gone")["why"], "");
    EXPECT_EQ(metric("front", "disparityd_up"), "0");
    EXPECT_EQ(metric("front", "disparityd_uptime_seconds"), "absent");
    EXPECT_THAT(http(port(), "GET", "/healthz")->body, HasSubstr(named("front") + ": "));
    EXPECT_EQ(metric("rear", "disparityd_up"), "1");
    front = start_named("front");
    wait_for("front", "there");
    front->send_signal(SIGTERM);
    EXPECT_EQ(front->wait_for_exit(), 0);
    wait_for("front", "gone");
    EXPECT_EQ(metric("front", "disparityd_up"), "0") << "its alert needs it to stay in the list";
    front = start_named("front");
    wait_for("front", "there");
    web->send_signal(SIGTERM);
    EXPECT_EQ(web->wait_for_exit(), 0) << web->log();
}

TEST_F(AllDaemonsTest, OneThatHangsHoldsNoOther) {
    const auto web = start_all({"--allow-control"});
    const auto front = start_named("front");
    const auto rear = start_named("rear");
    wait_for("front", "there");
    wait_for("rear", "there");
    WebSocketClient page(port(), "disparityd.live.v1", at("rear", "live"));
    page.send(R"({"type":"subscribe","images":["disparity"]})");
    read_frames(page, 1);
    front->send_signal(SIGSTOP);
    // What waits for the one that hangs: frames, and the most requests that there may be.
    WebSocketClient waiting(port(), "disparityd.live.v1", at("front", "live"));
    waiting.send(R"({"type":"subscribe","images":["disparity"],"sensors":true})");
    std::vector<std::unique_ptr<HttpClient>> hanging;
    for (int i = 0; i < 12; ++i) {
        hanging.push_back(std::make_unique<HttpClient>(port()));
        hanging.back()->send("GET " + at("front", i % 2 == 0 ? "api/camera" : "snapshot.png") +
                             " HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    }
    read_frames(page, 30);
    EXPECT_EQ(snapshot_width("rear"), 160);
    const auto started = http(port(), "POST", at("rear", "api/recording"), as_json, R"({"path":"rear.mkv"})");
    EXPECT_EQ(started->status, 200U) << started->body;
    EXPECT_NE(wait_for("front", "gone")["why"], "");
    EXPECT_EQ(http(port(), "DELETE", at("rear", "api/recording"))->status, 200U);
    for (const auto& client : hanging) {
        EXPECT_TRUE(client->answer());
    }
    front->send_signal(SIGCONT);
    wait_for("front", "there");
    read_frames(waiting, 1);
}

TEST_F(AllDaemonsTest, ControlGoesToTheChosenOneAndNeedsItsRight) {
    const std::string tokens = folder_.write("tokens", "view 0123456789abcdef\ncontrol fedcba9876543210\n");
    chmod(tokens.c_str(), 0600);
    const std::string view = "Authorization: Bearer 0123456789abcdef\r\n";
    const std::string control = "Authorization: Bearer fedcba9876543210\r\n";
    const auto front = start_named("front");
    const auto rear = start_named("rear");
    const auto web = start_all({"--token-file", tokens});
    const auto records = [&](const std::string& name) {
        json status;
        while (!is_running(status)) {
            status = parsed(http(port(), "GET", at(name, "api/status"), view)).value("status", json());
        }
        return status.contains("record") && status["record"].value("active", false);
    };
    EXPECT_FALSE(records("rear"));
    for (const std::string& path : {std::string("/api/instances"), std::string("/metrics"), at("front", "api/status"),
                                    at("front", "snapshot.png"), at("front", "stream.mjpg"), at("x", "api/status")}) {
        EXPECT_EQ(http(port(), "GET", path)->status, 401U) << path;
    }
    EXPECT_EQ(http(port(), "GET", "/")->status, 200U) << "the page asks for the token";
    EXPECT_EQ(http(port(), "GET", "/api/instances", view)->status, 200U);
    const std::string body = R"({"path":"one.mkv"})";
    EXPECT_EQ(http(port(), "POST", at("rear", "api/recording"), view + as_json, body)->status, 403U);
    EXPECT_EQ(http(port(), "POST", "/api/recording", control + as_json, body)->status, 404U);
    const auto started = http(port(), "POST", at("rear", "api/recording"), control + as_json, body);
    ASSERT_EQ(started->status, 200U) << started->body;
    while (!records("rear")) {
    }
    EXPECT_FALSE(records("front"));
    EXPECT_EQ(http(port(), "DELETE", at("rear", "api/recording"), control)->status, 200U);
}

}  // namespace
}  // namespace disparityd::test

// SPDX-License-Identifier: Apache-2.0
//
// Viewers whose protocol has no answer, and who pause: when they go on, they get what is seen now.
#include <chrono>
#include <cstring>

#include "tests/bridges/web/web_fixture.h"

namespace disparityd::test {
namespace {

using nlohmann::json;

double now_s() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class SlowViewerTest : public WebTest {
protected:
    SlowViewerTest() : daemon_(start_ready(config_text(scene, 320, 176))), web_(start_web()) {
        wait_for_daemon("there");
    }

    /// Returns when a page beside it has seen so many frames.
    void wait_for_frames(int frames) {
        WebSocketClient page(port(), "disparityd.live.v1");
        page.send(R"({"type":"subscribe","images":["disparity"],"max_width":16})");
        for (int i = 0; i < frames; ++i) {
            const json frame = header_of(next_frame(page));
            page.send(R"({"type":"seen","publish_index":)" + frame["publish_index"].dump() + "}");
        }
    }

    std::unique_ptr<DaemonProcess> daemon_;
    std::unique_ptr<DaemonProcess> web_;
};

TEST_F(SlowViewerTest, OfAnMjpegStreamWhatTheViewersSystemHoldsIsOld) {
    HttpClient viewer(port(), 4096);
    ASSERT_TRUE(viewer.ask("GET", "/stream.mjpg?image=left"));
    const auto first = viewer.answer();
    ASSERT_TRUE(first);
    wait_for_frames(60);
    const double resumed = now_s();
    int old = 0;
    for (double captured = 0; captured < resumed; ++old) {
        const auto part = viewer.answer();
        ASSERT_TRUE(part);
        captured = std::stod(part->head.at("x-timestamp"));
    }
    // The client's own object has read what came with the first part.
    const auto held = static_cast<int>(65536 / first->body.size());
    EXPECT_LE(old, 3 + held) << "of 60 frames; a JPEG has " << first->body.size() << " bytes";
}

TEST_F(SlowViewerTest, OfFoxglovesFramesTwoAreOld) {
    WebSocketClient viewer(port(), "foxglove.sdk.v1");
    viewer.read();
    const json advertise = json::parse(viewer.read().second);
    json channel;
    for (const json& offered : advertise["channels"]) {
        channel = offered["topic"] == "/disparity" ? offered["id"] : channel;
    }
    viewer.send(json{{"op", "subscribe"}, {"subscriptions", {{{"id", 5}, {"channelId", channel}}}}}.dump());
    for (int i = 0; i < 5; ++i) {
        next_frame(viewer);
    }
    wait_for_frames(30);
    const double resumed = now_s();
    int old = 0;
    for (double received = 0; received < resumed; ++old) {
        const std::string message = next_frame(viewer);
        std::uint64_t ns = 0;
        std::memcpy(&ns, message.data() + 5, sizeof ns);
        received = static_cast<double>(ns) / 1e9;
    }
    EXPECT_LE(old, 3) << "two that were under way, and then one of now";
}

}  // namespace
}  // namespace disparityd::test

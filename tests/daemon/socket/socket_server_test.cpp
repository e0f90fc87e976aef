// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/socket_server.h"

#include <array>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <zstd.h>

#include "daemon/requests/camera_request.h"
#include "proto/framing.h"
#include "tests/daemon/socket/server_fixture.h"

namespace disparityd::test {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;

v1::Status no_status() {
    return {};
}

using SocketServerTest = ServerTest;

std::vector<std::uint8_t> planes_of(std::uint64_t n, const std::vector<v1::Product>& products, std::uint32_t x,
                                    std::uint32_t y, std::uint32_t width, std::uint32_t height) {
    std::vector<std::uint8_t> all;
    for (const v1::Product product : products) {
        const auto plane = PatternFrames::expected(n, product, x, y, width, height);
        all.insert(all.end(), plane.begin(), plane.end());
    }
    return all;
}

TEST_F(SocketServerTest, WelcomeSaysWhatThereIs) {
    start();
    for (const std::string& address : {tcp_, unix_}) {
        WireClient client(address);
        const auto answer = client.hello();
        ASSERT_TRUE(answer && answer->has_welcome());
        const v1::Welcome& welcome = answer->welcome();
        EXPECT_EQ(welcome.protocol_version(), proto::protocol_version);
        EXPECT_EQ(welcome.products_size(), static_cast<int>(proto::products.size()));
        EXPECT_EQ(welcome.geometry().width(), 64U);
        EXPECT_EQ(welcome.geometry().calibration_id(), 0xfedcba9876543210U);
        EXPECT_EQ(welcome.shared_memory(), "/disparityd.feed");
        EXPECT_FALSE(welcome.server_version().empty());
    }
}

TEST_F(SocketServerTest, FramesCarryEverything) {
    start();
    const std::vector<v1::Product> products{v1::LEFT_COLOUR, v1::DISPARITY, v1::DEPTH};
    for (const std::string& address : {tcp_, unix_}) {
        WireClient client = connect(address);
        subscribe(client, subscription(products));
        const daemon::PublishedFrame sent = feed_.next();
        const std::uint64_t n = sent.info.publish_index;
        server_->publish(sent);
        const auto message = client.receive_frame();
        ASSERT_TRUE(message);
        const v1::Frame& frame = message->envelope.frame();
        EXPECT_EQ(frame.publish_index(), n);
        EXPECT_EQ(frame.sequence(), 1000 + n);
        EXPECT_EQ(frame.monotonic_ns(), static_cast<std::int64_t>(n) * 1000);
        EXPECT_EQ(frame.realtime_ns(), static_cast<std::int64_t>(n) * 1000 + 7);
        EXPECT_GE(frame.age_ns(), 5'000'000);
        EXPECT_LT(frame.age_ns(), 60'000'000'000);
        EXPECT_EQ(frame.flags(), static_cast<std::uint32_t>(v1::DROPPED_BEFORE));
        EXPECT_EQ(frame.dropped_before(), n % 3);
        EXPECT_EQ(frame.skipped(), 0U);
        EXPECT_FALSE(frame.has_region());
        EXPECT_EQ(frame.geometry().f(), 350.5);
        EXPECT_EQ(frame.geometry().cx(), 160.25);
        EXPECT_EQ(frame.geometry().cy(), 120.75);
        EXPECT_EQ(frame.geometry().baseline_mm(), 120);
        EXPECT_EQ(frame.geometry().disparity_offset(), 0.5);
        EXPECT_EQ(frame.geometry().d_min(), -16);
        EXPECT_EQ(frame.geometry().disparities(), 64U);
        EXPECT_EQ(frame.geometry().invalid(), -272);
        ASSERT_EQ(frame.planes_size(), 3);
        EXPECT_EQ(frame.planes(0).product(), v1::LEFT_COLOUR);
        EXPECT_EQ(frame.planes(0).bytes_per_pixel(), 3U);
        EXPECT_EQ(frame.planes(0).payload_bytes(), 64U * 48 * 3);
        EXPECT_EQ(frame.planes(1).product(), v1::DISPARITY);
        EXPECT_EQ(message->payload, planes_of(n, products, 0, 0, 64, 48));
    }
}

TEST_F(SocketServerTest, RegionAndCompression) {
    start();
    WireClient client = connect(tcp_);
    v1::Envelope request = subscription({v1::DISPARITY, v1::LEFT_COLOUR});
    v1::Region& region = *request.mutable_subscribe()->mutable_region();
    region.set_x(10);
    region.set_y(20);
    region.set_width(33);
    region.set_height(7);
    request.mutable_subscribe()->set_encoding(v1::ZSTD);
    subscribe(client, request);
    server_->publish(feed_.next());
    const auto message = client.receive_frame();
    ASSERT_TRUE(message);
    const v1::Frame& frame = message->envelope.frame();
    EXPECT_EQ(frame.region().x(), 10U);
    EXPECT_EQ(frame.region().height(), 7U);
    EXPECT_EQ(frame.geometry().width(), 64U);
    std::vector<std::uint8_t> planes;
    std::size_t at = 0;
    for (const v1::PlaneInfo& plane : frame.planes()) {
        EXPECT_EQ(plane.encoding(), v1::ZSTD);
        std::vector<std::uint8_t> raw(std::size_t{plane.width()} * plane.height() * plane.bytes_per_pixel());
        ASSERT_EQ(ZSTD_decompress(raw.data(), raw.size(), message->payload.data() + at, plane.payload_bytes()),
                  raw.size());
        planes.insert(planes.end(), raw.begin(), raw.end());
        at += plane.payload_bytes();
    }
    EXPECT_EQ(at, message->payload.size());
    EXPECT_EQ(planes, planes_of(0, {v1::DISPARITY, v1::LEFT_COLOUR}, 10, 20, 33, 7));
}

// They are compressed one after the other; two that want the same may share.
TEST_F(SocketServerTest, CompressedFramesReachAllWhoWantThem) {
    start();
    std::vector<WireClient> clients;
    const auto selection = [](std::uint32_t x, v1::Encoding encoding) {
        v1::Envelope request = subscription({v1::DISPARITY, v1::CONFIDENCE});
        request.mutable_subscribe()->set_encoding(encoding);
        request.mutable_subscribe()->mutable_region()->set_x(x);
        request.mutable_subscribe()->mutable_region()->set_width(20);
        request.mutable_subscribe()->mutable_region()->set_height(30);
        return request;
    };
    for (std::uint32_t i = 0; i < 24; ++i) {
        clients.push_back(connect(i % 2 == 0 ? tcp_ : unix_));
        subscribe(clients.back(), selection(i / 2, v1::ZSTD));
    }
    for (int round = 0; round < 5; ++round) {
        server_->publish(feed_.next());
        for (std::uint32_t i = 0; i < clients.size(); ++i) {
            const auto message = clients[i].receive_frame();
            ASSERT_TRUE(message) << i;
            const v1::Frame& frame = message->envelope.frame();
            EXPECT_EQ(frame.skipped(), 0U);
            std::vector<std::uint8_t> planes;
            std::size_t at = 0;
            for (const v1::PlaneInfo& plane : frame.planes()) {
                EXPECT_EQ(plane.encoding(), v1::ZSTD);
                std::vector<std::uint8_t> raw(std::size_t{20} * 30 * plane.bytes_per_pixel());
                ASSERT_EQ(ZSTD_decompress(raw.data(), raw.size(), &message->payload[at], plane.payload_bytes()),
                          raw.size());
                planes.insert(planes.end(), raw.begin(), raw.end());
                at += plane.payload_bytes();
            }
            EXPECT_EQ(planes, planes_of(frame.publish_index(), {v1::DISPARITY, v1::CONFIDENCE}, i / 2, 0, 20, 30)) << i;
        }
    }
    // Another subscription while a frame is being compressed for the old one.
    for (int round = 0; round < 20; ++round) {
        server_->publish(feed_.next());
        const v1::Encoding encoding = round % 2 == 0 ? v1::RAW : v1::ZSTD;
        subscribe(clients[0], selection(1, encoding));
        server_->publish(feed_.next());
        auto message = clients[0].receive_frame();
        while (message && (message->envelope.frame().planes(0).encoding() != encoding ||
                           message->envelope.frame().region().x() != 1)) {
            message = clients[0].receive_frame();
        }
        ASSERT_TRUE(message) << round;
    }
}

TEST_F(SocketServerTest, BadSubscriptionsAreRefusedAndTheOldOneStays) {
    start();
    WireClient client = connect(tcp_);
    subscribe(client, subscription({v1::CONFIDENCE}));
    std::vector<std::pair<v1::Envelope, std::string>> cases;
    v1::Envelope bad = subscription({v1::DISPARITY});
    bad.mutable_subscribe()->mutable_region()->set_x(60);
    bad.mutable_subscribe()->mutable_region()->set_width(5);
    bad.mutable_subscribe()->mutable_region()->set_height(1);
    cases.emplace_back(bad, "region: found x 60");
    bad.mutable_subscribe()->mutable_region()->set_x(0xffffffff);
    bad.mutable_subscribe()->mutable_region()->set_width(2);
    cases.emplace_back(bad, "within the image of 64 x 48");
    bad = subscription({static_cast<v1::Product>(17)});
    cases.emplace_back(bad, "products: found 17");
    bad = subscription({v1::DISPARITY});
    bad.mutable_subscribe()->set_max_rate(-1);
    cases.emplace_back(bad, "max_rate");
    bad = subscription({v1::DISPARITY});
    bad.mutable_subscribe()->set_status_interval_s(std::numeric_limits<double>::quiet_NaN());
    cases.emplace_back(bad, "status_interval_s");
    bad.mutable_subscribe()->set_status_interval_s(1e308);
    cases.emplace_back(bad, "status_interval_s: found 1e+308, allowed: 0 (none) .. 86400");
    bad = subscription({v1::DISPARITY});
    bad.mutable_subscribe()->set_encoding(static_cast<v1::Encoding>(9));
    cases.emplace_back(bad, "encoding: found 9");
    for (const auto& [request, expected] : cases) {
        ASSERT_TRUE(client.send(request));
        EXPECT_THAT(client.receive_error(), HasSubstr(expected));
    }
    server_->publish(feed_.next());
    const auto message = client.receive_frame();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->envelope.frame().planes(0).product(), v1::CONFIDENCE);
}

// As docs/protocol.md promises newer clients.
TEST_F(SocketServerTest, AnUnknownMessageIsAnsweredAndTheConnectionStays) {
    start();
    WireClient client = connect(tcp_);
    v1::Envelope empty;
    ASSERT_TRUE(client.send(empty));
    const std::array<std::uint8_t, 7> field_99_of_no_bytes = {3, 0, 0, 0, 0x9a, 0x06, 0};
    ASSERT_TRUE(client.send_bytes(field_99_of_no_bytes));
    for (int i = 0; i < 2; ++i) {
        const auto answer = client.receive();
        ASSERT_TRUE(answer && answer->envelope.has_error());
        EXPECT_THAT(answer->envelope.error().message(), HasSubstr("allowed: hello, subscribe"));
        EXPECT_FALSE(answer->envelope.error().closing());
    }
    EXPECT_NO_THROW(status(client));
}

TEST_F(SocketServerTest, MaxRateSkipsAndCounts) {
    start(64, 32);
    WireClient client = connect(tcp_);
    v1::Envelope request = subscription({v1::CONFIDENCE});
    request.mutable_subscribe()->set_max_rate(10);
    subscribe(client, request);
    // 40 frames at 40 per second of their own clock, which is what max_rate goes by.
    const auto start_time = std::chrono::steady_clock::now();
    for (int i = 0; i < 40; ++i) {
        daemon::PublishedFrame frame = feed_.next();
        frame.published = start_time + i * 25ms;
        server_->publish(frame);
        status(client);  // the server has looked at it
    }
    const v1::Status now = status(client);
    ASSERT_EQ(now.clients_size(), 1);
    EXPECT_EQ(now.clients(0).frames_sent(), 10U);
    EXPECT_EQ(now.clients(0).frames_skipped(), 27U);  // three between two that are sent
}

TEST_F(SocketServerTest, StatusAtIntervals) {
    start();
    WireClient client = connect(unix_, "watcher");
    v1::Envelope request = subscription({});
    request.mutable_subscribe()->set_status_interval_s(0.1);
    ASSERT_TRUE(client.send(request));
    for (int i = 0; i < 3; ++i) {
        const auto message = client.receive();
        ASSERT_TRUE(message && message->envelope.has_status());
        EXPECT_EQ(message->envelope.status().clients(0).name(), "watcher");
        EXPECT_EQ(message->envelope.status().clients(0).address(), "unix");
    }
}

TEST_F(SocketServerTest, RecordingAnswersComeBack) {
    start();
    WireClient client = connect(unix_);
    v1::Envelope request;
    request.mutable_record_start()->set_path("a.mkv");
    ASSERT_TRUE(client.send(request));
    const auto answer = client.receive();
    ASSERT_TRUE(answer && answer->envelope.has_record_status());
    EXPECT_EQ(answer->envelope.record_status().path(), "a.mkv");
    request.mutable_record_start()->set_path("");
    ASSERT_TRUE(client.send(request));
    EXPECT_EQ(client.receive_error(), "record: no path");
    status(client);
}

TEST_F(SocketServerTest, NewLayoutReachesClients) {
    start();
    WireClient client = connect(tcp_);
    WireClient depth = connect(tcp_);
    v1::Envelope request = subscription({v1::DISPARITY});
    request.mutable_subscribe()->mutable_region()->set_x(20);
    request.mutable_subscribe()->mutable_region()->set_width(44);
    request.mutable_subscribe()->mutable_region()->set_height(48);
    subscribe(client, request);
    subscribe(depth, subscription({v1::DEPTH}));
    PatternFrames smaller(32, 16, {v1::DISPARITY});
    server_->set_layout(smaller.layout());
    server_->publish(smaller.next());
    const auto message = client.receive_frame();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->envelope.frame().geometry().width(), 32U);
    EXPECT_EQ(message->envelope.frame().region().width(), 12U);
    EXPECT_EQ(message->envelope.frame().region().height(), 16U);
    EXPECT_EQ(message->payload, PatternFrames::expected(0, v1::DISPARITY, 20, 0, 12, 16));
    EXPECT_THAT(depth.receive_error(), HasSubstr("no longer served"));
}

TEST_F(SocketServerTest, NothingIsCopiedWhenNobodyWantsIt) {
    start();
    WireClient client = connect(tcp_);
    server_->publish(feed_.next());
    subscribe(client, subscription({v1::LEFT}));
    server_->publish(feed_.next());
    const auto message = client.receive_frame();
    ASSERT_TRUE(message);
    EXPECT_EQ(message->envelope.frame().publish_index(), 1U);
    EXPECT_EQ(message->envelope.frame().skipped(), 0U);
}

TEST_F(SocketServerTest, OtherAddressesKeepClients) {
    start();
    WireClient client = connect(tcp_);
    const std::string old_unix = unix_;
    config_.unix_path += "2";
    server_->reconfigure(config_);
    EXPECT_EQ(server_->addresses().at(0), tcp_);
    connect("unix:" + config_.unix_path);
    EXPECT_EQ(status(client).state(), "running");
    EXPECT_THROW(WireClient{old_unix}, std::runtime_error);
    config_.tcp = "";
    server_->reconfigure(config_);
    EXPECT_EQ(status(client).state(), "running");
    EXPECT_THROW(WireClient{tcp_}, std::runtime_error);
}

TEST_F(SocketServerTest, AddressesInUseAreNamed) {
    start();
    daemon::SocketServerConfig second = config_;
    second.unix_path = "";
    second.tcp = tcp_.substr(4);
    try {
        daemon::SocketServer server(second, no_status, {});
        FAIL() << "bound twice";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), HasSubstr(tcp_));
        EXPECT_THAT(error.what(), HasSubstr("[socket] tcp"));
    }
    second = config_;
    second.tcp = "";
    try {
        daemon::SocketServer server(second, no_status, {});
        FAIL() << "bound twice";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), HasSubstr(config_.unix_path));
        EXPECT_THAT(error.what(), HasSubstr("[socket] unix"));
    }
    connect(unix_);
}

TEST_F(SocketServerTest, LeftOverUnixSocketIsReplacedAndOwnRemoved) {
    const std::string path = "/tmp/disparityd-left-" + std::to_string(getpid()) + ".sock";
    {
        const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.copy(address.sun_path, sizeof(address.sun_path) - 1);
        ASSERT_EQ(::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
        ::close(fd);
    }
    daemon::SocketServerConfig config;
    config.unix_path = path;
    {
        daemon::SocketServer server(config, no_status, {});
        server.set_layout(feed_.layout());
        server.start();
        connect("unix:" + path);
    }
    struct stat found {};
    EXPECT_NE(stat(path.c_str(), &found), 0);
    EXPECT_EQ(errno, ENOENT);
}

TEST_F(SocketServerTest, AnAddressIsTakenBeforeItIsServed) {
    daemon::SocketServerConfig config;
    config.unix_path = "/tmp/disparityd-early-" + std::to_string(getpid()) + ".sock";
    daemon::SocketServer first(config, no_status, {});
    first.set_layout(feed_.layout());
    EXPECT_THROW(daemon::SocketServer(config, no_status, {}), std::runtime_error);
    WireClient early("unix:" + config.unix_path);
    first.start();
    const auto welcome = early.hello("early");
    EXPECT_TRUE(welcome && welcome->has_welcome());
}

TEST_F(SocketServerTest, ASubscriptionFromBeforeTheFirstLayoutHoldsFromThenOn) {
    daemon::SocketServerConfig config;
    config.unix_path = "/tmp/disparityd-prepares-" + std::to_string(getpid()) + ".sock";
    daemon::SocketServer server(config, no_status, {});
    server.start();
    WireClient client("unix:" + config.unix_path);
    const auto welcome = client.hello("early");
    ASSERT_TRUE(welcome && welcome->has_welcome());
    EXPECT_EQ(welcome->welcome().geometry().width(), 0U);
    EXPECT_EQ(welcome->welcome().products_size(), 0);
    subscribe(client, subscription({v1::DISPARITY}));  // the status comes all the same

    server.set_layout(feed_.layout());
    status(client);  // the layout was taken in before
    server.publish(feed_.next());
    const auto answer = client.receive();
    ASSERT_TRUE(answer && answer->envelope.has_frame());
    EXPECT_EQ(answer->envelope.frame().planes(0).product(), v1::DISPARITY);
}

TEST(CameraRequest, OneOfTooManySettingsIsRefusedAndOneWithoutASource) {
    daemon::CameraControlService camera([] { return nullptr; });
    const auto refusal = [&](int settings) {
        v1::CameraRequest request;
        while (request.settings_size() < settings) {
            request.add_settings();
        }
        std::promise<std::string> told;
        camera.ask(request, [&](const daemon::Answer& answer) { told.set_value(answer.refusal); });
        return told.get_future().get();
    };
    EXPECT_THAT(refusal(65), HasSubstr("found 65 settings, allowed: at most 64"));
    EXPECT_THAT(refusal(64), HasSubstr("the source is being prepared"));
}

TEST_F(SocketServerTest, CameraRequestsAreAnsweredOrRefused) {
    start();
    WireClient client = connect(unix_);
    v1::Envelope request;
    v1::CameraSetting& gain = *request.mutable_camera_request()->add_settings();
    gain.set_name("gain-left");
    gain.set_value(30);
    ASSERT_TRUE(client.send(request));
    auto answer = client.receive();
    ASSERT_TRUE(answer && answer->envelope.has_camera_controls());
    EXPECT_EQ(answer->envelope.camera_controls().controls(0).name(), "gain-left");
    EXPECT_EQ(answer->envelope.camera_controls().controls(0).value(), 30);
    request.mutable_camera_request()->clear_settings();
    ASSERT_TRUE(client.send(request));
    answer = client.receive();
    ASSERT_TRUE(answer && answer->envelope.has_error());
    EXPECT_EQ(answer->envelope.error().message(), "camera: nothing asked for");
    EXPECT_FALSE(answer->envelope.error().closing());
}

TEST_F(SocketServerTest, ARequestThatIsMadeTooOftenIsRefusedWhoeverMakesIt) {
    rate_of_stops_ = std::make_shared<daemon::RateLimit>(3, std::chrono::hours(1));
    start();
    v1::Envelope request;
    request.mutable_record_stop();
    for (int i = 0; i < 3; ++i) {
        WireClient client = connect(unix_);
        ASSERT_TRUE(client.send(request));
        const auto answer = client.receive();
        ASSERT_TRUE(answer && answer->envelope.has_record_status()) << i;
    }
    WireClient client = connect(unix_);
    ASSERT_TRUE(client.send(request));
    const auto answer = client.receive();
    ASSERT_TRUE(answer && answer->envelope.has_error());
    EXPECT_THAT(answer->envelope.error().message(), HasSubstr("record: asked for too often: ask again in 3"));
    EXPECT_FALSE(answer->envelope.error().closing());
    EXPECT_EQ(stops_, 3);
    status(client);  // other requests are answered
}

TEST_F(SocketServerTest, ATraceComesInPartsOrIsRefused) {
    start();
    WireClient client = connect(tcp_);
    v1::Envelope request;
    request.mutable_trace_request()->set_seconds(1);
    ASSERT_TRUE(client.send(request));
    for (const char* name : {"first", "second"}) {
        const auto part = client.receive();
        ASSERT_TRUE(part && part->envelope.has_trace());
        EXPECT_EQ(part->envelope.trace().tracks(0).name(), name);
        EXPECT_EQ(part->envelope.trace().last(), name == std::string("second"));
    }
    request.mutable_trace_request()->set_seconds(0);
    ASSERT_TRUE(client.send(request));
    EXPECT_EQ(client.receive_error(), "trace: no time");
}

TEST_F(SocketServerTest, AFileInPlaceOfTheSocketIsRefused) {
    const std::string path = "/tmp/disparityd-file-" + std::to_string(getpid());
    FILE* file = fopen(path.c_str(), "w");
    ASSERT_NE(file, nullptr);
    fclose(file);
    daemon::SocketServerConfig config;
    config.unix_path = path;
    try {
        daemon::SocketServer server(config, no_status, {});
        FAIL() << "replaced a file";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), HasSubstr(path));
        EXPECT_THAT(error.what(), HasSubstr("no socket"));
    }
    struct stat found {};
    EXPECT_EQ(stat(path.c_str(), &found), 0);
    unlink(path.c_str());
}

}  // namespace
}  // namespace disparityd::test

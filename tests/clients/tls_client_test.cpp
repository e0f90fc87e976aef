// SPDX-License-Identifier: Apache-2.0
//
// The client libraries over TLS: every byte of a frame, the checks of both ends, and the lines that say what is wrong.
#include <atomic>
#include <cinttypes>
#include <cstdio>
#include <latch>
#include <sstream>
#include <thread>

#include <arpa/inet.h>
#include <disparity_client.h>
#include <disparity_client.hpp>
#include <gmock/gmock.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/stat.h>

#include "tests/certificate_folder.h"
#include "tests/daemon/socket/server_fixture.h"
#include "tests/proto/command_output.h"

namespace disparityd::test {
namespace {

using disparity::ConnectOptions;
using disparity::Frame;
using disparity::Product;
using disparity::ReadResult;
using disparity::SocketClient;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Facts = CertificateFolder::Facts;
using namespace std::chrono_literals;

constexpr const char* view_token = "0123456789abcdef";
constexpr const char* control_token = "fedcba9876543210";
constexpr std::uint32_t width = 640;
constexpr std::uint32_t height = 360;

std::uint64_t fnv1a(const std::vector<std::uint8_t>& bytes) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;
    for (const std::uint8_t byte : bytes) {
        hash = (hash ^ byte) * 0x100000001b3ULL;
    }
    return hash;
}

/// A server that publishes frames all the time.
class TlsClientTest : public ServerTest {
protected:
    ~TlsClientTest() override { stop_publishing(); }

    void start_with_tls(bool certificates = false) {
        config_.access.certificates = certificates;
        config_.tls = proto::make_server_tls(files_.server(certificates), "test");
        start_publishing();
    }

    void start_publishing() {
        feed_ = PatternFrames(width, height, all_products());
        start();
        publish_on();
    }

    void publish_on() {
        publishing_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                server_->publish(feed_.next());
                std::this_thread::sleep_for(10ms);
            }
        });
    }

    void stop_publishing() {
        publishing_.request_stop();
        if (publishing_.joinable()) {
            publishing_.join();
        }
    }

    ConnectOptions options(const std::string& certificate = "", const std::string& token = "") const {
        const proto::TlsFiles files = files_.client(certificate);
        ConnectOptions options;
        options.authority = files.authority;
        options.certificate = files.certificate;
        options.key = files.key;
        options.token = token;
        return options;
    }

    /// Why no connection is made.
    static std::string refusal(const std::string& address, const ConnectOptions& options) {
        try {
            SocketClient client(address, options, "test", 60s);
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    }

    /// As a program prints frames: "INDEX PRODUCT HASH" for each plane.
    static std::string line_of(std::uint64_t index, Product product) {
        const auto bytes = PatternFrames::expected(index, static_cast<v1::Product>(product), 0, 0, width, height);
        char line[80];
        std::snprintf(line, sizeof line, "%" PRIu64 " %u %016" PRIx64, index, static_cast<unsigned>(product),
                      fnv1a(bytes));
        return line;
    }

    static void expect_pattern(const std::string& printed) {
        std::istringstream lines(printed);
        int count = 0;
        for (std::string line; std::getline(lines, line); ++count) {
            std::istringstream words(line);
            std::uint64_t index = 0;
            unsigned product = 0;
            words >> index >> product;
            EXPECT_EQ(line, line_of(index, static_cast<Product>(product)));
        }
        EXPECT_EQ(count, 6) << printed;  // three frames of two planes
    }

    /// Connects as "guest". 1: a frame came; else prints why none did.
    int frame_in_cpp() const {
        try {
            SocketClient client(tcp_, options("guest"), "test", 60s);
            client.subscribe({.products = {Product::disparity}});
            Frame frame;
            return client.read(frame, 60s) == ReadResult::frame ? 1 : 0;
        } catch (const std::exception& error) {
            ADD_FAILURE() << error.what();
            return 0;
        }
    }

    int frame_in_c() const {
        const ConnectOptions given = options("guest");
        disparity_connect_options files{};
        files.authority = given.authority.c_str();
        files.certificate = given.certificate.c_str();
        files.key = given.key.c_str();
        const std::uint32_t product = DISPARITY_PRODUCT_DISPARITY;
        disparity_subscription wanted{};
        wanted.products = &product;
        wanted.product_count = 1;
        disparity_frame* const frame = disparity_frame_new();
        disparity_socket* const client = disparity_socket_open_with(tcp_.c_str(), "c", 60000, &files, sizeof files);
        const bool served = client != nullptr && disparity_socket_subscribe(client, &wanted) == 0 &&
                            disparity_socket_read(client, frame, 60000) == DISPARITY_FRAME;
        EXPECT_TRUE(served) << disparity_last_error();
        disparity_socket_close(client);
        disparity_frame_free(frame);
        return served ? 1 : 0;
    }

    CertificateFolder files_;
    std::jthread publishing_;
};

TEST_F(TlsClientTest, CppReadsTheBytesThatWerePublished) {
    start_with_tls();
    for (const bool compressed : {false, true}) {
        for (const std::string& address : {tcp_, unix_}) {
            SocketClient client(address, options(), "test", 60s);
            client.subscribe({.products = {Product::disparity, Product::left_colour}, .compressed = compressed});
            for (int i = 0; i < 3; ++i) {
                Frame frame;
                ASSERT_EQ(client.read(frame, 60s), ReadResult::frame);
                ASSERT_EQ(frame.planes.size(), 2U);
                for (const disparity::PlaneData& plane : frame.planes) {
                    EXPECT_EQ(plane.bytes,
                              PatternFrames::expected(frame.publish_index, static_cast<v1::Product>(plane.product), 0,
                                                      0, width, height));
                }
            }
        }
    }
}

TEST_F(TlsClientTest, CReadsTheBytesThatWerePublished) {
    files_.make({.common_name = "guest"});
    config_.access.tokens = {{view_token}, {}};
    start_with_tls(true);
    const auto [status, text] =
        command_output(TLS_C_CHECK " " + tcp_ + " " + files_.file("authority.crt") + " " + files_.file("guest.crt") +
                       " " + files_.file("guest.key") + " " + files_.write_secret("token", view_token));
    EXPECT_EQ(status, 0) << text;
    expect_pattern(text);
}

TEST_F(TlsClientTest, PythonReadsTheBytesThatWerePublished) {
    const std::string python = TLS_PYTHON_CHECK;
    if (python.empty()) {
        GTEST_SKIP() << "no Python for this machine's programs";
    }
    files_.make({.common_name = "guest"});
    config_.access.tokens = {{view_token}, {}};
    start_with_tls(true);
    const auto [status, text] =
        command_output(python + " " + tcp_ + " " + files_.file("authority.crt") + " " + files_.file("guest.crt") + " " +
                       files_.file("guest.key") + " " + files_.write_secret("token", view_token));
    if (status == 77) {
        GTEST_SKIP() << "numpy or protobuf is not installed for Python";
    }
    EXPECT_EQ(status, 0) << text;
    expect_pattern(text);
}

// More than may shake hands at once, while frames reach all of them.
TEST_F(TlsClientTest, FortyThatComeAtOnceAreAllServed) {
    constexpr int clients = 40;
    files_.make({.common_name = "guest"});
    start_with_tls(true);
    std::latch together(clients);
    std::atomic<int> served{0};
    std::vector<std::jthread> threads;
    for (int i = 0; i < clients; ++i) {
        threads.emplace_back([&, in_c = i % 2 == 0] {
            together.arrive_and_wait();
            served += in_c ? frame_in_c() : frame_in_cpp();
        });
    }
    threads.clear();
    EXPECT_EQ(served, clients);
}

TEST_F(TlsClientTest, AnotherImplementationOfTlsCanTalkToTheServer) {
    if (command_output("openssl version").first != 0) {
        GTEST_SKIP() << "the program openssl is not installed";
    }
    start_with_tls();
    for (const char* version : {"-tls1_2", "-tls1_3"}) {
        const auto [status, text] =
            command_output("openssl s_client -connect " + tcp_.substr(4) + " -CAfile " + files_.file("authority.crt") +
                           " -verify_return_error -verify_ip 127.0.0.1 " + version + " </dev/null 2>&1");
        EXPECT_EQ(status, 0) << text;
        EXPECT_THAT(text, HasSubstr("Verify return code: 0 (ok)"));
    }
    const auto [status, text] = command_output("openssl s_client -connect " + tcp_.substr(4) + " -CAfile " +
                                               files_.file("authority.crt") + " -tls1_1 </dev/null 2>&1");
    EXPECT_NE(status, 0) << text;
}

TEST_F(TlsClientTest, WhatIsWrongIsOneLineWithWhatToDo) {
    files_.make({.common_name = "guest"});
    start_with_tls();
    ConnectOptions nobody;
    EXPECT_THAT(refusal(tcp_, nobody),
                AllOf(HasSubstr(tcp_), HasSubstr("certificate verify failed"), HasSubstr("authority's file")));
    ConnectOptions other = options();
    other.server_name = "elsewhere";
    EXPECT_THAT(refusal(tcp_, other), AllOf(HasSubstr("mismatch"), HasSubstr("the certificate is not for elsewhere")));
    other.server_name = "localhost";
    EXPECT_EQ(refusal(tcp_, other), "");
    ConnectOptions half = options("guest");
    half.key.clear();
    EXPECT_THAT(refusal(tcp_, half), HasSubstr("go together"));
    half = options("guest");
    half.key = files_.file("server.key");
    EXPECT_THAT(refusal(tcp_, half), AllOf(HasSubstr("server.key"), HasSubstr("mismatch")));
    half.certificate = files_.file("none.crt");
    EXPECT_THAT(refusal(tcp_, half), AllOf(HasSubstr("none.crt"), HasSubstr("cannot be used")));
    ConnectOptions no_authority;
    no_authority.authority = files_.file("guest.key");
    EXPECT_THAT(refusal(tcp_, no_authority),
                AllOf(HasSubstr("guest.key"), HasSubstr("authority's certificate cannot be used")));
    EXPECT_THAT(refusal("tcp" + tcp_.substr(3), {}), HasSubstr("connect to tls:HOST:PORT"));
    EXPECT_THAT(refusal("tls:127.0.0.1", {}), HasSubstr("expected tls:HOST:PORT"));
}

TEST_F(TlsClientTest, APortWithoutTlsIsNamed) {
    start_publishing();
    EXPECT_THAT(refusal("tls" + tcp_.substr(3), options()), HasSubstr("speaks no TLS"));
}

TEST_F(TlsClientTest, ACertificateThatIsMissingIsToldByTheDaemon) {
    start_with_tls(true);
    EXPECT_THAT(refusal(tcp_, options()),
                AllOf(HasSubstr("certificate required"), HasSubstr("its authority has signed")));
}

TEST_F(TlsClientTest, ACertificateForAnotherPurposeIsToldAsThat) {
    files_.make({.purpose = Facts::Purpose::server, .common_name = "a-server", .hosts = {"127.0.0.1"}});
    files_.make({.common_name = "guest"});
    start_with_tls(true);
    EXPECT_THAT(refusal(tcp_, options("a-server")),
                AllOf(HasSubstr("for another purpose than a client's"), testing::Not(HasSubstr("signed"))));
    stop_publishing();
    // A server refuses to start with it; others than this one may not.
    SSL_CTX* const context = config_.tls.get();
    ASSERT_EQ(SSL_CTX_use_certificate_chain_file(context, files_.file("guest.crt").c_str()), 1);
    ASSERT_EQ(SSL_CTX_use_PrivateKey_file(context, files_.file("guest.key").c_str(), SSL_FILETYPE_PEM), 1);
    EXPECT_THAT(refusal(tcp_, options("guest")),
                AllOf(HasSubstr("is not for a server"), testing::Not(HasSubstr("signed by nobody"))));
}

TEST_F(TlsClientTest, TokensAreSentAndRefused) {
    config_.access.tokens = {{view_token}, {control_token}};
    start_with_tls();
    EXPECT_THAT(refusal(tcp_, options()), HasSubstr("a token is needed"));
    EXPECT_THAT(refusal(tcp_, options("", "0123456789abcdeg")), HasSubstr("this token is not known"));
    SocketClient viewer(tcp_, options("", view_token), "test", 60s);
    try {
        viewer.start_recording("a.mkv", 60s);
        FAIL() << "a viewer may record";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), HasSubstr("record: refused, this client may look only"));
    }
    EXPECT_THROW(viewer.control_camera({{"gain-left", 1}}, 60s), std::runtime_error);
    ConnectOptions from_file = options();
    from_file.token_file = files_.write_secret("tokens", "# mine\ncontrol " + std::string(control_token) + "\n");
    SocketClient controller(tcp_, from_file, "test", 60s);
    EXPECT_NO_THROW(controller.start_recording("a.mkv", 60s));
    EXPECT_NO_THROW(controller.control_camera({{"gain-left", 1}}, 60s));
    ::chmod(from_file.token_file.c_str(), 0644);
    EXPECT_THAT(refusal(tcp_, from_file), HasSubstr("chmod o-rw"));
    from_file.token_file = files_.write_secret("empty", "# none\n\n");
    EXPECT_THAT(refusal(tcp_, from_file), HasSubstr("holds no token"));
    from_file.token_file = files_.file("pipe");
    ASSERT_EQ(::mkfifo(from_file.token_file.c_str(), 0600), 0);
    EXPECT_THAT(refusal(tcp_, from_file), HasSubstr("not a regular file"));
    from_file.token_file = files_.file("absent");
    EXPECT_THAT(refusal(tcp_, from_file), HasSubstr("cannot be read"));
}

TEST_F(TlsClientTest, ATokenGoesUnencryptedToThisMachineOnly) {
    config_.access.tokens = {{view_token}, {}};
    start_publishing();
    EXPECT_EQ(refusal(tcp_, options("", view_token)), "") << "over loopback";
    EXPECT_THAT(refusal(tcp_, {}), HasSubstr("a token is needed"));
    EXPECT_EQ(refusal(unix_, {}), "") << "the Unix socket needs none";
}

TEST_F(TlsClientTest, ATokenGoesUnencryptedToNoOtherMachine) {
    // An address of this machine that is not loopback looks like that of another one.
    ifaddrs* all = nullptr;
    ASSERT_EQ(::getifaddrs(&all), 0);
    std::string own;
    for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
        if (one->ifa_addr != nullptr && one->ifa_addr->sa_family == AF_INET && (one->ifa_flags & IFF_LOOPBACK) == 0) {
            char text[INET_ADDRSTRLEN];
            own =
                ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(one->ifa_addr)->sin_addr, text, sizeof text);
        }
    }
    ::freeifaddrs(all);
    if (own.empty()) {
        GTEST_SKIP() << "this machine has no address but loopback";
    }
    config_.access.tokens = {{view_token}, {}};
    config_.tcp = "0.0.0.0:0";
    restart();
    const std::string address = "tcp:" + own + tcp_.substr(tcp_.rfind(':'));
    EXPECT_THAT(refusal(address, options("", view_token)), HasSubstr("a token would be sent unencrypted"));
    EXPECT_THAT(refusal(address, {}), HasSubstr("a token is needed")) << "without one it connects";
}

TEST_F(TlsClientTest, AClientThatReadsOnSurvivesARestart) {
    config_.access.tokens = {{view_token}, {}};
    start_with_tls();
    SocketClient client(tcp_, options("", view_token), "test", 60s);
    client.subscribe({.products = {Product::disparity}});
    Frame frame;
    ASSERT_EQ(client.read(frame, 60s), ReadResult::frame);
    stop_publishing();
    const std::string address = tcp_;
    server_.reset();
    while (client.read(frame, 10s) == ReadResult::frame) {
    }
    config_.tcp = address.substr(4);
    restart();
    publish_on();
    ReadResult result = ReadResult::gone;
    for (int i = 0; i < 60 && result != ReadResult::frame; ++i) {
        result = client.read(frame, 1s);
    }
    EXPECT_EQ(result, ReadResult::frame) << client.why_gone();
}

TEST_F(TlsClientTest, ADaemonThatHangsInTheHandshakeIsNotWaitedForLonger) {
    const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof place;
    ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&place), size), 0);
    ASSERT_EQ(::listen(listener, 1), 0);
    ASSERT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&place), &size), 0);
    const std::string address = "tls:127.0.0.1:" + std::to_string(ntohs(place.sin_port));
    try {
        SocketClient client(address, options(), "test", 200ms);
        FAIL() << "nobody answered";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), HasSubstr("no TLS handshake in time"));
    }
    ::close(listener);
}

}  // namespace
}  // namespace disparityd::test

// SPDX-License-Identifier: Apache-2.0
//
// A connection over TLS that ends while it waits: it must leave alone what gets its descriptor's number next.
#include "daemon/socket/client_stream.h"

#include <array>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/certificate_folder.h"

namespace disparityd::test {
namespace {

using daemon::ClientStream;
using proto::TlsStream;

constexpr std::string_view hello = "bytes of another connection";

/// Two sockets that are connected.
struct Pair {
    Pair() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()), 0); }
    std::array<int, 2> ends{-1, -1};
};

class ClientStreamTest : public ::testing::Test {
protected:
    ~ClientStreamTest() override {
        stream_.close();
        ::close(pair_.ends[1]);
    }

    ClientStream::Socket socket() {
        ClientStream::Socket socket(io_);
        socket.assign(boost::asio::generic::stream_protocol(AF_UNIX, 0), pair_.ends[0]);
        return socket;
    }

    void shake_hands() {
        bool ready = false;
        stream_.async_handshake([&](const ClientStream::Error& error) { ready = !error; });
        for (int i = 0; i < 100 && !(ready && TlsStream::Outcome::done == client_.handshake()); ++i) {
            client_.handshake();
            io_.restart();
            io_.poll();
        }
        ASSERT_TRUE(ready);
    }

    /// Closes the stream, gives its descriptor to a new connection on which `hello` has arrived, calls the handlers
    /// that are left, and expects that the bytes are still there.
    void close_and_reuse() {
        stream_.close();
        const Pair next;
        ASSERT_EQ(next.ends[0], pair_.ends[0]) << "the lowest number that is free";
        ASSERT_EQ(::send(next.ends[1], hello.data(), hello.size(), 0), static_cast<ssize_t>(hello.size()));
        io_.restart();
        io_.poll();
        std::array<char, 64> bytes{};
        EXPECT_EQ(::recv(next.ends[0], bytes.data(), bytes.size(), 0), static_cast<ssize_t>(hello.size()));
        EXPECT_EQ(std::string_view(bytes.data(), hello.size()), hello);
        stream_.end_output();
        EXPECT_LT(::recv(next.ends[1], bytes.data(), bytes.size(), 0), 0) << "nothing was written to it";
        ::close(next.ends[0]);
        ::close(next.ends[1]);
    }

    CertificateFolder files_;
    boost::asio::io_context io_;
    Pair pair_;
    proto::TlsContext server_context_ = proto::make_server_tls(files_.server(), "test");
    proto::TlsContext client_context_ = proto::make_client_tls(files_.client());
    ClientStream stream_{socket(), server_context_};
    TlsStream client_{client_context_, pair_.ends[1], TlsStream::End::client};
};

TEST_F(ClientStreamTest, AReadThatWaitsReadsNothingAfterTheEnd) {
    shake_hands();
    // Both kinds of waiting end with one event: the handler of the first runs while the other's is on its way.
    std::array<std::uint8_t, 16> bytes{};
    bool read_ended = false;
    stream_.async_read_some(boost::asio::buffer(bytes), [&](const ClientStream::Error& error, std::size_t received) {
        EXPECT_TRUE(error);
        EXPECT_EQ(received, 0U);
        read_ended = true;
    });
    io_.restart();
    io_.poll();
    bool first = false;
    std::size_t sent = 0;
    ASSERT_EQ(client_.write(bytes, sent), TlsStream::Outcome::done);
    stream_.async_wait_writable([&](const ClientStream::Error&) {
        ASSERT_FALSE(read_ended);
        first = true;
        close_and_reuse();
    });
    io_.restart();
    while (io_.run_one() != 0 && !first) {
    }
    ASSERT_TRUE(first);
    io_.restart();
    io_.poll();
    EXPECT_TRUE(read_ended);
}

TEST_F(ClientStreamTest, AHandshakeThatWaitsReadsNothingAfterTheEnd) {
    bool ended = false;
    stream_.async_handshake([&](const ClientStream::Error& error) {
        EXPECT_TRUE(error);
        ended = true;
    });
    client_.handshake();  // its first message arrives
    bool first = false;
    stream_.async_wait_writable([&](const ClientStream::Error&) {
        ASSERT_FALSE(ended);
        first = true;
        close_and_reuse();
    });
    while (io_.run_one() != 0 && !first) {
    }
    ASSERT_TRUE(first);
    EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace disparityd::test

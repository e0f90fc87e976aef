// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/websocket.hpp>

namespace disparityd::test {

/// What a server answered.
struct HttpAnswer {
    unsigned status = 0;
    std::map<std::string, std::string> head;  ///< names in lower case
    std::string body;
};

/// A bare TCP connection to a server of this machine: sends what the test says, well formed or not.
class HttpClient {
public:
    /// `receive_bytes`: of what is not read this system holds about so much; 0 = as usual.
    explicit HttpClient(unsigned short port, int receive_bytes = 0);

    void send(const std::string& bytes);
    /// Returns the next answer, or the next part of a multipart one (status 0); nothing when the server ends the
    /// connection instead, or says nothing for a minute.
    std::optional<HttpAnswer> answer();
    /// Returns whether the server ends the connection within a minute.
    bool ended();

    /// Sends a request with a right Host, and returns its answer. `more`: further lines of the head, each with its end.
    std::optional<HttpAnswer> ask(const std::string& method, const std::string& target, const std::string& more = "",
                                  const std::string& body = "");

private:
    boost::asio::io_context context_;
    boost::asio::ip::tcp::socket socket_;
    unsigned short port_;
    std::string unread_;
};

/// One request over a connection of its own.
std::optional<HttpAnswer> http(unsigned short port, const std::string& method, const std::string& target,
                               const std::string& more = "", const std::string& body = "");

/// A WebSocket of Beast's, that is, of the implementation that the server has; the tests with Node have another one.
class WebSocketClient {
public:
    /// Throws boost::system::system_error when it is refused.
    WebSocketClient(unsigned short port, const std::string& protocol, const std::string& target = "/live");

    void send(const std::string& text);
    void send_binary(const std::string& bytes);
    /// Returns the next message: whether it is text, and its bytes. Throws boost::system::system_error at the end.
    std::pair<bool, std::string> read();
    /// The connection below: to send what no WebSocket sends.
    boost::asio::ip::tcp::socket& socket() { return socket_.next_layer(); }
    const std::string& protocol() const { return protocol_; }

private:
    boost::asio::io_context context_;
    boost::beast::websocket::stream<boost::asio::ip::tcp::socket> socket_;
    std::string protocol_;
};

}  // namespace disparityd::test

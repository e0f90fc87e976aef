// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/web/http_client.h"

#include <algorithm>
#include <cctype>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <poll.h>

namespace disparityd::test {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr int patience_ms = 60000;

asio::ip::tcp::endpoint local(unsigned short port) {
    return {asio::ip::address_v4::loopback(), port};
}

/// Appends what comes next. False at the end, or when nothing comes for a minute.
bool read_some(asio::ip::tcp::socket& socket, std::string& bytes) {
    pollfd waited{socket.native_handle(), POLLIN, 0};
    if (poll(&waited, 1, patience_ms) != 1) {
        return false;
    }
    std::array<char, 65536> part;
    error_code error;
    const std::size_t size = socket.read_some(asio::buffer(part), error);
    bytes.append(part.data(), size);
    return !error;
}

}  // namespace

HttpClient::HttpClient(unsigned short port, int receive_bytes) : socket_(context_), port_(port) {
    socket_.open(asio::ip::tcp::v4());
    if (receive_bytes > 0) {
        socket_.set_option(asio::socket_base::receive_buffer_size(receive_bytes));
    }
    socket_.connect(local(port));
}

void HttpClient::send(const std::string& bytes) {
    error_code ignored;  // the server may have ended the connection: answer() tells
    asio::write(socket_, asio::buffer(bytes), ignored);
}

std::optional<HttpAnswer> HttpClient::answer() {
    // The end of a part before this one.
    unread_.erase(0, unread_.compare(0, 2, "\r\n") == 0 ? 2 : 0);
    std::size_t end = 0;
    while ((end = unread_.find("\r\n\r\n")) == std::string::npos) {
        if (!read_some(socket_, unread_)) {
            return std::nullopt;
        }
    }
    HttpAnswer answer;
    const std::string head = unread_.substr(0, end + 2);
    unread_.erase(0, end + 4);
    if (head.compare(0, 5, "HTTP/") == 0) {
        answer.status = static_cast<unsigned>(std::stoi(head.substr(head.find(' ') + 1)));
    }
    for (std::size_t line = head.find("\r\n") + 2; line < head.size();) {
        const std::size_t line_end = head.find("\r\n", line);
        const std::size_t colon = head.find(": ", line);
        std::string name = head.substr(line, colon - line);
        std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
        answer.head[name] = head.substr(colon + 2, line_end - colon - 2);
        line = line_end + 2;
    }
    const auto length = answer.head.find("content-length");
    const std::size_t bytes = length == answer.head.end() ? 0 : std::stoul(length->second);
    while (unread_.size() < bytes) {
        if (!read_some(socket_, unread_)) {
            return std::nullopt;
        }
    }
    answer.body = unread_.substr(0, bytes);
    unread_.erase(0, bytes);
    return answer;
}

bool HttpClient::ended() {
    for (;;) {
        pollfd waited{socket_.native_handle(), POLLIN, 0};
        if (poll(&waited, 1, patience_ms) != 1) {
            return false;
        }
        std::string ignored;
        if (!read_some(socket_, ignored)) {
            return true;
        }
    }
}

std::optional<HttpAnswer> HttpClient::ask(const std::string& method, const std::string& target, const std::string& more,
                                          const std::string& body) {
    const std::string length = body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n";
    send(method + ' ' + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\n" + more + length +
         "\r\n" + body);
    return answer();
}

std::optional<HttpAnswer> http(unsigned short port, const std::string& method, const std::string& target,
                               const std::string& more, const std::string& body) {
    return HttpClient(port).ask(method, target, more, body);
}

WebSocketClient::WebSocketClient(unsigned short port, const std::string& protocol, const std::string& target)
    : socket_(context_) {
    namespace websocket = boost::beast::websocket;
    socket_.next_layer().connect(local(port));
    socket_.set_option(websocket::stream_base::decorator([&protocol](websocket::request_type& request) {
        request.set(boost::beast::http::field::sec_websocket_protocol, protocol);
    }));
    socket_.read_message_max(64 * 1024 * 1024);
    websocket::response_type response;
    socket_.handshake(response, "127.0.0.1:" + std::to_string(port), target);
    protocol_ = std::string(response[boost::beast::http::field::sec_websocket_protocol]);
}

void WebSocketClient::send(const std::string& text) {
    socket_.text(true);
    socket_.write(asio::buffer(text));
}

void WebSocketClient::send_binary(const std::string& bytes) {
    socket_.binary(true);
    socket_.write(asio::buffer(bytes));
}

std::pair<bool, std::string> WebSocketClient::read() {
    boost::beast::flat_buffer buffer;
    socket_.read(buffer);
    return {socket_.got_text(), boost::beast::buffers_to_string(buffer.data())};
}

}  // namespace disparityd::test

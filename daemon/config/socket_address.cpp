// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/socket_address.h"

#include <charconv>
#include <optional>
#include <string_view>

#include <boost/asio/ip/address.hpp>

#include "base/message_text.h"

namespace disparityd::daemon {
namespace {

constexpr const char* form =
    ", allowed: \"ADDRESS:PORT\" such as \"127.0.0.1:9876\" or \"[::1]:9876\", or \"\" for none";

std::optional<TcpAddress> parse(std::string_view text) {
    const auto colon = text.rfind(':');
    if (colon == std::string_view::npos) {
        return std::nullopt;
    }
    std::string_view host = text.substr(0, colon);
    const std::string_view port = text.substr(colon + 1);
    if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
        host = host.substr(1, host.size() - 2);
    } else if (host.find(':') != std::string_view::npos) {
        return std::nullopt;
    }
    TcpAddress address{host == "localhost" ? "127.0.0.1" : std::string(host), 0};
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (port.empty() || error != std::errc() || end != port.data() + port.size()) {
        return std::nullopt;
    }
    boost::system::error_code bad_address;
    boost::asio::ip::make_address(address.host, bad_address);
    if (bad_address) {
        return std::nullopt;
    }
    return address;
}

}  // namespace

std::string tcp_address_problem(const std::string& text, bool protected_by_tls, bool insecure) {
    if (text.empty()) {
        return {};
    }
    const auto address = parse(text);
    if (!address) {
        return "found \"" + base::printable(text) + "\"" + form;
    }
    if (!insecure && !protected_by_tls && !boost::asio::ip::make_address(address->host).is_loopback()) {
        return "found \"" + text +
               "\", which other machines can reach, allowed: with certificate, key and one of client_authority and "
               "tokens "
               "(disparityctl certificates makes the files); a loopback address such as 127.0.0.1; or insecure = true "
               "to accept that whoever reaches it sees what the camera sees";
    }
    return {};
}

TcpAddress parse_tcp_address(const std::string& text) {
    return parse(text).value_or(TcpAddress{});
}

}  // namespace disparityd::daemon

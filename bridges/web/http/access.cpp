// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/http/access.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include <boost/asio/ip/address.hpp>
#include <openssl/rand.h>
#include <unistd.h>

namespace disparityd::web {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t most_sessions = 64;  ///< of each token
constexpr std::chrono::hours session_life{12};

bool equal_without_case(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// Returns the host without its port: "robot", "127.0.0.1", "::1" of "[::1]:8765".
std::string_view without_port(std::string_view host) {
    if (!host.empty() && host.front() == '[') {
        const std::size_t end = host.find(']');
        return end == std::string_view::npos ? host : host.substr(1, end - 1);
    }
    return host.substr(0, host.rfind(':'));
}

std::string own_name() {
    std::array<char, 256> name{};
    return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

/// Returns "disparityd_8765" for the host "robot:8765". Behind a tunnel or a proxy it is the port that the browser
/// sees.
std::string cookie_name(std::string_view host) {
    const std::size_t colon = host.rfind(':');
    const bool has_port = colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos;
    std::string name = "disparityd_";
    for (const char digit : has_port ? host.substr(colon + 1) : std::string_view()) {
        if (digit < '0' || digit > '9' || name.size() >= 16) {
            return "disparityd_";  // no port
        }
        name += digit;
    }
    return name;
}

std::string_view value_of_cookie(std::string_view cookies, std::string_view host) {
    const std::string cookie_begin = cookie_name(host) + '=';
    while (!cookies.empty()) {
        const std::size_t end = std::min(cookies.find(';'), cookies.size());
        std::string_view one = cookies.substr(0, end);
        one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
        if (one.substr(0, cookie_begin.size()) == cookie_begin) {
            return one.substr(cookie_begin.size());
        }
        cookies.remove_prefix(std::min(end + 1, cookies.size()));
    }
    return {};
}

std::string random_name() {
    std::array<unsigned char, 24> bytes{};
    if (RAND_bytes(bytes.data(), bytes.size()) != 1) {
        throw std::runtime_error("the system gives no random numbers");
    }
    constexpr std::string_view digits = "0123456789abcdef";
    std::string name;
    for (const unsigned char byte : bytes) {
        name += digits[byte >> 4U];
        name += digits[byte & 15U];
    }
    return name;
}

}  // namespace

bool is_origin(std::string_view text) {
    const std::size_t colon = text.find("://");
    if (colon == std::string_view::npos || colon == 0) {
        return false;
    }
    const std::string_view scheme = text.substr(0, colon);
    std::string_view host = text.substr(colon + 3);
    if (scheme == "file") {
        return host.empty();
    }
    const bool named = std::all_of(scheme.begin(), scheme.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.';
    });
    const std::size_t end = host.rfind(':');
    if (end != std::string_view::npos && host.find(']', end) == std::string_view::npos) {
        const std::string_view port = host.substr(end + 1);
        if (port.empty() || port.size() > 5 || port.find_first_not_of("0123456789") != std::string_view::npos) {
            return false;
        }
        host = host.substr(0, end);
    }
    const bool address = host.size() > 2 && host.front() == '[' && host.back() == ']';
    if (address) {
        host = host.substr(1, host.size() - 2);
    }
    return named && !host.empty() && std::all_of(host.begin(), host.end(), [address](unsigned char c) {
               return std::isalnum(c) != 0 || c == '.' || (address ? c == ':' : c == '-' || c == '_');
           });
}

bool Access::is_own_host(std::string_view host) const {
    const std::string_view name = without_port(host);
    boost::system::error_code error;
    boost::asio::ip::make_address(std::string(name), error);
    const std::string own = own_name();
    // An address is no name that somebody else could point to this machine.
    return !error || equal_without_case(name, "localhost") || equal_without_case(name, own) ||
           equal_without_case(name, own + ".local") ||
           std::any_of(rules_.hosts.begin(), rules_.hosts.end(),
                       [&](const std::string& other) { return equal_without_case(name, other); });
}

std::string Access::refuses(const Visitor& visitor) const {
    if (!is_own_host(visitor.host)) {
        return "this server does not go by that name; start disparity-web with --host NAME to allow it";
    }
    if (visitor.origin.empty()) {
        return {};
    }
    const std::size_t scheme = visitor.origin.find("://");
    const bool own = scheme != std::string_view::npos &&
                     equal_without_case(visitor.origin.substr(scheme + 3), visitor.host) &&
                     visitor.origin.substr(0, scheme) == (secure_ ? "https" : "http");
    const bool named = std::any_of(rules_.origins.begin(), rules_.origins.end(),
                                   [&](const std::string& other) { return equal_without_case(visitor.origin, other); });
    return own || named
               ? std::string()
               : "pages of other servers may not use this one; start disparity-web with --origin URL to allow it";
}

Right Access::right_of(const Visitor& visitor) const {
    Right right = rules_.anybody_views ? Right::view : Right::none;
    constexpr std::string_view bearer = "Bearer ";
    if (visitor.authorization.substr(0, bearer.size()) == bearer) {
        right = std::max(right, rules_.tokens.right_of(visitor.authorization.substr(bearer.size())));
    }
    const auto session = sessions_.find(value_of_cookie(visitor.cookie, visitor.host));
    if (session != sessions_.end() && session->second.ends > steady_clock::now()) {
        right = std::max(right, session->second.right);
    }
    return right == Right::view && rules_.anybody_controls ? Right::control : right;
}

/// Forgets the sessions that have ended, and where this token has many, the one of it that ends first: who knows one
/// token logs out nobody who knows another.
void Access::make_room(std::string_view token, steady_clock::time_point now) {
    std::erase_if(sessions_, [&](const auto& session) { return session.second.ends <= now; });
    std::size_t count = 0;
    auto first = sessions_.end();
    for (auto session = sessions_.begin(); session != sessions_.end(); ++session) {
        if (session->second.token == token) {
            ++count;
            first = first == sessions_.end() || session->second.ends < first->second.ends ? session : first;
        }
    }
    if (count >= most_sessions) {
        sessions_.erase(first);
    }
}

std::string Access::log_in(std::string_view token, std::string_view host) {
    const Right right = rules_.tokens.right_of(token);
    if (right == Right::none) {
        return {};
    }
    const auto now = steady_clock::now();
    make_room(token, now);
    const std::string name = random_name();
    sessions_.emplace(name, Session{std::string(token), right, now + session_life});
    return cookie_name(host) + '=' + name + "; Path=/; HttpOnly; SameSite=Strict" + (secure_ ? "; Secure" : "");
}

}  // namespace disparityd::web

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

constexpr std::string_view cookie_name = "disparityd=";
constexpr std::size_t most_sessions = 1024;
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

std::string_view value_of_cookie(std::string_view cookies) {
    while (!cookies.empty()) {
        const std::size_t end = std::min(cookies.find(';'), cookies.size());
        std::string_view one = cookies.substr(0, end);
        one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
        if (one.substr(0, cookie_name.size()) == cookie_name) {
            return one.substr(cookie_name.size());
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
    const auto session = sessions_.find(value_of_cookie(visitor.cookie));
    if (session != sessions_.end() && session->second.ends > steady_clock::now()) {
        right = std::max(right, session->second.right);
    }
    return right == Right::view && rules_.anybody_controls ? Right::control : right;
}

std::string Access::log_in(std::string_view token) {
    const Right right = rules_.tokens.right_of(token);
    if (right == Right::none) {
        return {};
    }
    const auto now = steady_clock::now();
    std::erase_if(sessions_, [&](const auto& session) { return session.second.ends <= now; });
    if (sessions_.size() >= most_sessions) {
        sessions_.erase(sessions_.begin());
    }
    const std::string name = random_name();
    sessions_.emplace(name, Session{right, now + session_life});
    return std::string(cookie_name) + name + "; Path=/; HttpOnly; SameSite=Strict" + (secure_ ? "; Secure" : "");
}

}  // namespace disparityd::web

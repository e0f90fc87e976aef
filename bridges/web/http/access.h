// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/access/tokens.h"

namespace disparityd::web {

using base::Right;

/// Says who may do what.
struct AccessRules {
    bool anybody_views = true;      ///< without a token
    bool anybody_controls = false;  ///< whoever may view may control
    base::Tokens tokens;
    std::vector<std::string> hosts;    ///< further names under which this program is reached
    std::vector<std::string> origins;  ///< pages of other servers that may use this one, "https://app.example.org"
};

/// What a request tells of its sender.
struct Visitor {
    std::string_view host;           ///< header Host
    std::string_view origin;         ///< header Origin; empty = not a page's script
    std::string_view authorization;  ///< header Authorization
    std::string_view cookie;         ///< header Cookie
};

/// Returns whether a text is the origin of pages, as browsers send it: "https://app.example.org", "http://[::1]:8080",
/// and "file://" of programs on the desktop.
bool is_origin(std::string_view text);

/// Decides what a request may do. The network's thread owns it.
class Access {
public:
    /// `secure`: cookies are sent over TLS only.
    Access(AccessRules rules, bool secure) : rules_(std::move(rules)), secure_(secure) {}

    /// Returns one line why a browser must not send this, or "". A page elsewhere that gave its own name this machine's
    /// address (DNS rebinding) sends its name as the host; a script of another page sends its page as the origin.
    std::string refuses(const Visitor& visitor) const;

    Right right_of(const Visitor& visitor) const;
    bool needs_token() const { return !rules_.anybody_views || knows_controllers(); }
    /// Whether some visitors may control and others may not.
    bool knows_controllers() const { return !rules_.anybody_controls && !rules_.tokens.controllers().empty(); }

    /// Whether there is such a token. Takes the same time wherever two tokens differ.
    bool knows(std::string_view token) const { return rules_.tokens.right_of(token) != Right::none; }

    /// Returns the value of a Set-Cookie header for whoever knows a token, "" for who does not. `host`: the header
    /// Host; a browser sends a cookie to all ports of a host, so the cookie's name tells them apart. Of many visitors
    /// with one token, the one that would have to log in again first has to.
    std::string log_in(std::string_view token, std::string_view host);

private:
    bool is_own_host(std::string_view host) const;

    AccessRules rules_;
    bool secure_;
    struct Session {
        std::string token;
        Right right = Right::none;
        std::chrono::steady_clock::time_point ends;
    };
    void make_room(std::string_view token, std::chrono::steady_clock::time_point now);

    std::map<std::string, Session, std::less<>> sessions_;
};

}  // namespace disparityd::web

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

/// Decides what a request may do. The network's thread owns it.
class Access {
public:
    /// `secure`: cookies are sent over TLS only.
    Access(AccessRules rules, bool secure) : rules_(std::move(rules)), secure_(secure) {}

    /// Returns one line why a browser must not send this, or "". A page elsewhere that gave its own name this machine's
    /// address (DNS rebinding) sends its name as the host; a script of another page sends its page as the origin.
    std::string refuses(const Visitor& visitor) const;

    Right right_of(const Visitor& visitor) const;
    bool needs_token() const { return !rules_.anybody_views || (!rules_.anybody_controls && has_controllers()); }

    /// Returns the value of a Set-Cookie header for whoever knows a token, "" for who does not.
    std::string log_in(std::string_view token);

private:
    bool has_controllers() const { return !rules_.tokens.controllers().empty(); }
    bool is_own_host(std::string_view host) const;

    AccessRules rules_;
    bool secure_;
    struct Session {
        Right right = Right::none;
        std::chrono::steady_clock::time_point ends;
    };
    std::map<std::string, Session, std::less<>> sessions_;
};

}  // namespace disparityd::web

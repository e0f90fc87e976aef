// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::web {

/// What a visitor may do. Each right contains those before it.
enum class Right {
    none,
    view,     ///< frames, status
    control,  ///< recordings, camera controls
};

/// Says who may do what.
struct AccessRules {
    bool anybody_views = true;         ///< without a token
    bool anybody_controls = false;     ///< whoever may view may control
    std::vector<std::string> viewers;  ///< tokens
    std::vector<std::string> controllers;
    std::vector<std::string> hosts;    ///< further names under which this program is reached
    std::vector<std::string> origins;  ///< pages of other servers that may use this one, "https://app.example.org"
};

/// Reads tokens: each line is "view TOKEN" or "control TOKEN", a token of 16 to 256 printable characters without
/// blanks; empty lines and those that begin with # say nothing. Throws std::invalid_argument with one line: file, line,
/// found, allowed; also when others may read the file.
void read_tokens(const std::string& path, AccessRules& rules);

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
    bool has_controllers() const { return !rules_.controllers.empty(); }
    Right right_of_token(std::string_view token) const;
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

// SPDX-License-Identifier: Apache-2.0
#include "daemon/socket/client_access.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <grp.h>
#include <sys/socket.h>

#include "base/message_text.h"

#ifndef SO_PEERGROUPS
#define SO_PEERGROUPS 59
#endif

namespace disparityd::daemon {
namespace {

using base::Right;

bool is_in(const std::vector<UserGroup>& groups, const ClientPeer& peer) {
    return std::any_of(groups.begin(), groups.end(), [&](const UserGroup& group) {
        return std::find(peer.groups.begin(), peer.groups.end(), group.number) != peer.groups.end();
    });
}

std::string names_of(const std::vector<UserGroup>& groups) {
    std::string names;
    for (const UserGroup& group : groups) {
        names += (names.empty() ? "" : " or ") + group.name;
    }
    return names;
}

std::string user_of(const ClientPeer& peer) {
    return peer.user ? fmt::format("user {}", *peer.user) : std::string("an unknown user");
}

/// Returns whether the number means the same group here as outside of the daemon's user namespace.
bool is_visible(gid_t number) {
    std::ifstream map("/proc/self/gid_map");
    std::uint64_t first = 0;
    std::uint64_t outside = 0;
    std::uint64_t count = 0;
    bool known = false;
    while (map >> first >> outside >> count) {
        known = true;
        if (number >= first && number - first < count) {
            return true;
        }
    }
    return !known;
}

Right right_on_unix(const ClientAccess& access, const ClientPeer& peer) {
    const bool controls = access.control_groups.empty() ? access.view_groups.empty() || is_in(access.view_groups, peer)
                                                        : is_in(access.control_groups, peer);
    if (peer.owns_daemon() || controls) {
        return Right::control;
    }
    return access.view_groups.empty() || is_in(access.view_groups, peer) ? Right::view : Right::none;
}

}  // namespace

Right ClientAccess::right_of(const ClientPeer& peer, std::string_view token) const {
    if (peer.local) {
        return right_on_unix(*this, peer);
    }
    // After a reload these may ask for more than when the client connected.
    if ((encrypted && !peer.encrypted) || (certificates && !peer.certificate)) {
        return Right::none;
    }
    const Right by_token = tokens.empty() ? Right::view : tokens.right_of(token);
    if (by_token == Right::none) {
        return Right::none;
    }
    const bool by_certificate = peer.certificate && std::find(control_certificates.begin(), control_certificates.end(),
                                                              *peer.certificate) != control_certificates.end();
    return tcp_control || by_certificate ? Right::control : by_token;
}

std::string ClientAccess::why_not_view(const ClientPeer& peer, std::string_view token) const {
    if (peer.local) {
        return fmt::format("{} may not look, allowed: members of {} ([access] view_groups)", user_of(peer),
                           names_of(view_groups));
    }
    if (encrypted && !peer.encrypted) {
        return "this port speaks TLS only, allowed: tls:HOST:PORT";
    }
    if (certificates && !peer.certificate) {
        return "a client's certificate is needed ([socket] client_authority)";
    }
    return token.empty()
               ? "a token is needed, allowed: one of the file of [socket] tokens; clients take it from a file "
                 "(--token-file)"
               : "this token is not known, allowed: one of the file of [socket] tokens";
}

std::string ClientAccess::why_not_control(const ClientPeer& peer) const {
    if (peer.local) {
        return fmt::format("refused for {}, who may look only, allowed: members of {} ([access] control_groups)",
                           user_of(peer), names_of(control_groups));
    }
    if (!asks_over_tcp()) {
        return fmt::format(
            "refused over TCP, which every user of a machine reaches, allowed: over {}, or with [socket] tcp_control = "
            "true",
            unix_path.empty() ? "a Unix socket ([socket] unix)" : "unix:" + unix_path);
    }
    std::string allowed;
    if (!tokens.empty()) {
        allowed = "a token with the right control (the file of [socket] tokens)";
    }
    if (certificates) {
        allowed += (allowed.empty() ? "" : ", or ") +
                   fmt::format("[access] control_certificates with the name \"{}\" of the client's certificate",
                               base::printable(peer.certificate.value_or("")));
    }
    return "refused, this client may look only, allowed: " + allowed;
}

std::vector<UserGroup> find_groups(const std::vector<std::string>& names, const std::string& key) {
    std::vector<UserGroup> groups;
    for (const std::string& name : names) {
        gid_t number = 0;
        const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
        if (error != std::errc() || end != name.data() + name.size()) {
            const ::group* const found = ::getgrnam(name.c_str());
            if (found == nullptr) {
                throw std::invalid_argument(fmt::format(
                    "{}: found \"{}\", allowed: groups of this machine (getent group)", key, base::printable(name)));
            }
            number = found->gr_gid;
        }
        if (!is_visible(number)) {
            throw std::invalid_argument(
                fmt::format("{}: the group {} cannot be seen from inside of the daemon's user namespace, allowed: with "
                            "PrivateUsers=no in its unit (systemctl edit disparityd)",
                            key, base::printable(name)));
        }
        groups.push_back({number, name});
    }
    return groups;
}

std::vector<gid_t> groups_of_peer(int socket) {
    ucred credentials{};
    socklen_t size = sizeof credentials;
    if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &credentials, &size) != 0) {
        return {};
    }
    std::vector<gid_t> groups(64);
    for (;;) {
        size = static_cast<socklen_t>(groups.size() * sizeof(gid_t));
        if (::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) == 0) {
            groups.resize(size / sizeof(gid_t));
            break;
        }
        if (errno != ERANGE || size <= groups.size() * sizeof(gid_t)) {
            groups.clear();  // Linux before 4.13: only the first group is known
            break;
        }
        groups.resize(size / sizeof(gid_t));
    }
    groups.push_back(credentials.gid);
    return groups;
}

}  // namespace disparityd::daemon

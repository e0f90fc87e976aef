// SPDX-License-Identifier: Apache-2.0
#include "clients/places/daemon_sockets.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <sys/stat.h>
#include <unistd.h>

#include "clients/places/running_daemons.h"

namespace disparityd::clients {
namespace {

bool starts_with(const std::string& text, const std::string& start) {
    return text.compare(0, start.size(), start) == 0;
}

/// A path where a daemon of this name listens by default.
struct DefaultPath {
    std::string path;
    /// Only root and the service may create files there. Elsewhere another user may have put a socket, and a robot
    /// would act on that user's frames.
    bool of_the_system = false;
};

/// Returns the default paths. The daemon listens in the first of these folders that it may write to.
std::vector<DefaultPath> default_paths(const std::string& name) {
    check_daemon_name(name);
    std::vector<DefaultPath> paths;
    for (const std::string& folder : socket_folders()) {
        paths.push_back({folder + '/' + socket_file(name, folder), paths.empty()});
    }
    return paths;
}

/// Says what to do when no daemon of this name answers.
std::string advice(const std::string& name) {
    const std::vector<std::string> running = running_daemons();
    std::string names;
    for (const std::string& other : running) {
        names += other == name ? "" : (names.empty() ? "" : ", ") + other;
    }
    return names.empty() ? "start one with disparityd" + (name == "default" ? "" : " --name " + name) +
                               ", or say with --socket where it listens"
                         : "daemons of other names run: " + names + "; say which with --name";
}

bool is_trusted(uid_t user) {
    return user == getuid() || user == 0;
}

std::string not_trusted(const std::string& socket, uid_t user, const char* what) {
    return socket + ": " + what + " user " + std::to_string(user) +
           ", neither to this user nor to root, so it is left alone; if that daemon is meant, say so with --socket " +
           socket;
}

}  // namespace

DaemonSockets default_sockets(const std::string& name) {
    DaemonSockets found;
    for (const DefaultPath& place : default_paths(name)) {
        struct stat file {};
        // stat would follow a link of another user.
        if (lstat(place.path.c_str(), &file) != 0 || !S_ISSOCK(file.st_mode)) {
            continue;
        }
        const std::string address = "unix:" + place.path;
        if (place.of_the_system || is_trusted(file.st_uid)) {
            found.usable.push_back({address, !place.of_the_system});
        } else {
            found.refused.push_back(not_trusted(address, file.st_uid, "the socket belongs to"));
        }
    }
    // A daemon of another name does not listen at the default port.
    if (name == "default") {
        found.usable.push_back({default_tcp});
    }
    return found;
}

std::string socket_address(const std::string& text) {
    if (starts_with(text, "tcp:") || starts_with(text, "tls:") || starts_with(text, "unix:")) {
        return text;
    }
    if (text.find('/') != std::string::npos) {
        return "unix:" + text;
    }
    throw std::invalid_argument("--socket: found '" + text +
                                "', allowed: tcp:HOST:PORT such as tcp:127.0.0.1:9876, tls:HOST:PORT, or unix:PATH");
}

disparity::SocketClient connect(const DaemonSockets& sockets, const std::string& daemon, const std::string& client_name,
                                const std::function<void(const std::string&)>& note, std::chrono::milliseconds timeout,
                                const disparity::ConnectOptions& options) {
    std::vector<std::string> refused = sockets.refused;
    std::vector<std::string> failed;
    for (const auto& [socket, check_user] : sockets.usable) {
        try {
            disparity::SocketClient client(socket, options, client_name, timeout);
            const std::optional<unsigned> user = client.server_user();
            if (check_user && user && !is_trusted(*user)) {
                refused.push_back(not_trusted(socket, *user, "its process belongs to"));
                continue;
            }
            std::for_each(refused.begin(), refused.end(), note);
            return client;
        } catch (const std::runtime_error& error) {
            const std::string reason = error.what();
            const bool named = reason.find(socket.substr(socket.find(':') + 1)) != std::string::npos;
            failed.push_back((named ? "" : socket + ": ") + reason);
        }
    }
    failed.insert(failed.begin(), refused.begin(), refused.end());
    std::string reasons = failed.empty() ? "there is no Unix socket of a daemon named " + daemon : failed.front();
    for (std::size_t i = 1; i < failed.size(); ++i) {
        reasons += "; " + failed[i];
    }
    if (!sockets.looked_for) {
        throw std::runtime_error(reasons);
    }
    throw std::runtime_error("no daemon answers: " + reasons + " (" + advice(daemon) + ")");
}

}  // namespace disparityd::clients

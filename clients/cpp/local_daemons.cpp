// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/local_daemons.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "proto/shared_memory_layout.h"
#include "proto/socket_places.h"

namespace disparity {
namespace {

namespace proto = disparityd::proto;

constexpr const char* shared_memory_folder = "/dev/shm";

/// Where a daemon of the name "default" listens when its configuration does not say otherwise.
constexpr const char* default_tcp = "tcp:127.0.0.1:9876";

/// A daemon whose heartbeat is older has died.
constexpr std::chrono::seconds oldest_heartbeat{3};

bool has_memory(const std::string& name, const ClientOptions& options) {
    try {
        open_memory_of(name, options);
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

/// Returns the names of the daemons whose sockets somebody listens at, or whose shared memory can be read. It asks
/// nobody: a daemon that hangs is among them.
std::set<std::string> running_daemons(const ClientOptions& options) {
    std::set<std::string> names;
    std::vector<std::string> folders = proto::socket_folders();
    folders.emplace_back(shared_memory_folder);
    for (const std::string& folder : folders) {
        std::error_code error;
        for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
             entry.increment(error)) {
            const std::string file = entry->path().filename().string();
            if (folder == shared_memory_folder) {
                if (const auto name = proto::daemon_of_shm_file(file); name && has_memory(*name, options)) {
                    names.insert(*name);
                }
            } else if (const auto name = proto::daemon_of_socket_file(file, folder);
                       name && entry->symlink_status(error).type() == std::filesystem::file_type::socket &&
                       proto::somebody_listens(entry->path().string())) {
                names.insert(*name);
            }
            error.clear();
        }
    }
    return names;
}

std::string list_of(const std::set<std::string>& names) {
    std::string list;
    for (const std::string& name : names) {
        list += (list.empty() ? "" : ", ") + name;
    }
    return list;
}

/// Says what to do when no daemon of this name answers.
std::string advice(const std::string& name, const ClientOptions& options) {
    std::set<std::string> others = running_daemons(options);
    others.erase(name);
    return others.empty() ? "start one with disparityd" + (name == "default" ? "" : " --name " + name) +
                                ", or say where it listens: unix:PATH, tcp:HOST:PORT or tls:HOST:PORT"
                          : "daemons of other names run: " + list_of(others) + "; say which one";
}

bool is_trusted_user(uid_t user) {
    return user == getuid() || user == 0;
}

std::string not_trusted(const std::string& socket, uid_t user, const char* what) {
    return socket + ": " + what + " user " + std::to_string(user) +
           ", neither to this user nor to root, so it is left alone; if that daemon is meant, say " + socket;
}

/// Sockets that may lead to a daemon.
struct Sockets {
    struct Candidate {
        std::string address;      ///< as SocketClient takes it
        bool check_user = false;  ///< the listening process must be this user's or root's
    };
    std::vector<Candidate> usable;     ///< in the order in which to try them
    std::vector<std::string> refused;  ///< one line each: which socket is not used, and why
};

Sockets default_sockets(const std::string& name) {
    Sockets found;
    bool of_the_system = true;
    for (const std::string& folder : proto::socket_folders()) {
        const std::string path = folder + '/' + proto::socket_file(name, folder);
        const bool check_user = !std::exchange(of_the_system, false);
        struct stat file {};
        // stat would follow a link of another user.
        if (lstat(path.c_str(), &file) != 0 || !S_ISSOCK(file.st_mode)) {
            continue;
        }
        if (!check_user || is_trusted_user(file.st_uid)) {
            found.usable.push_back({"unix:" + path, check_user});
        } else {
            found.refused.push_back(not_trusted("unix:" + path, file.st_uid, "the socket belongs to"));
        }
    }
    // A daemon of another name does not listen at the default port.
    if (name == "default") {
        found.usable.push_back({default_tcp});
    }
    return found;
}

}  // namespace

void check_daemon_name(const std::string& name) {
    if (!proto::is_daemon_name(name)) {
        throw std::invalid_argument("name of a daemon: found '" + name +
                                    "', allowed: 1 to 64 characters of A-Z a-z 0-9 . _ -");
    }
}

SharedMemoryReader open_memory_of(const std::string& name, const ClientOptions& options) {
    SharedMemoryReader reader(name, SharedMemoryOptions{false, options.owner});
    if (reader.heartbeat_age() > oldest_heartbeat) {
        throw std::runtime_error("shared memory " + proto::shm_object_name(name) + ": its daemon has died");
    }
    return reader;
}

SocketClient connect_to(const std::string& name, const ClientOptions& options, std::chrono::milliseconds timeout) {
    auto [usable, refused] = default_sockets(name);
    std::vector<std::string> failed;
    for (const auto& [socket, check_user] : usable) {
        try {
            SocketClient client(socket, options.reach, options.client_name, timeout);
            const std::optional<unsigned> user = client.server_user();
            if (check_user && user && !is_trusted_user(*user)) {
                refused.push_back(not_trusted(socket, *user, "its process belongs to"));
                continue;
            }
            if (options.note) {
                std::for_each(refused.begin(), refused.end(), options.note);
            }
            return client;
        } catch (const std::runtime_error& error) {
            const std::string reason = error.what();
            const bool named = reason.find(socket.substr(socket.find(':') + 1)) != std::string::npos;
            failed.push_back((named ? "" : socket + ": ") + reason);
        }
    }
    failed.insert(failed.begin(), refused.begin(), refused.end());
    std::string reasons = failed.empty() ? "there is no Unix socket of a daemon named " + name : failed.front();
    for (std::size_t i = 1; i < failed.size(); ++i) {
        reasons += "; " + failed[i];
    }
    throw std::runtime_error("no daemon answers: " + reasons + " (" + advice(name, options) + ")");
}

std::string running_daemon(const ClientOptions& options) {
    const std::set<std::string> names = running_daemons(options);
    if (names.empty() || names.count("default") != 0) {
        return "default";
    }
    if (names.size() > 1) {
        throw std::runtime_error("several daemons run on this machine: " + list_of(names) + "; say which one");
    }
    return *names.begin();
}

}  // namespace disparity

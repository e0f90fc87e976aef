// SPDX-License-Identifier: Apache-2.0
#include "clients/places/running_daemons.h"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/shared_memory_layout.h"

namespace disparityd::clients {
namespace {

constexpr const char* temporary = "/tmp";

bool is_daemon_name(const std::string& name) {
    try {
        proto::shm_object_name(name);
        return true;
    } catch (const std::invalid_argument&) {
        return false;
    }
}

/// Returns the name of the daemon whose socket is called so in this folder; nothing when it is another file.
std::optional<std::string> daemon_of(const std::string& file, const std::string& folder) {
    if (file == socket_file("default", folder)) {
        return "default";
    }
    const std::string any = socket_file("*", folder);
    const std::size_t before = any.find('*');
    const std::size_t behind = any.size() - before - 1;
    if (file.size() < any.size() || file.compare(0, before, any, 0, before) != 0 ||
        file.compare(file.size() - behind, behind, any, before + 1, behind) != 0) {
        return std::nullopt;
    }
    const std::string name = file.substr(before, file.size() - before - behind);
    return is_daemon_name(name) ? std::optional(name) : std::nullopt;
}

bool somebody_listens(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) {
        return false;
    }
    path.copy(address.sun_path, path.size());
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    // Of a daemon with too many that wait it is said to try again later.
    const bool listens =
        fd >= 0 && (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EAGAIN);
    if (fd >= 0) {
        ::close(fd);
    }
    return listens;
}

}  // namespace

void check_daemon_name(const std::string& name) {
    if (!is_daemon_name(name)) {
        throw std::invalid_argument("--name: found '" + name + "', allowed: 1 to 64 characters of A-Z a-z 0-9 . _ -");
    }
}

std::vector<std::string> socket_folders() {
    std::vector<std::string> folders{"/run/disparityd"};
    if (const char* runtime = std::getenv("XDG_RUNTIME_DIR"); runtime != nullptr && *runtime != '\0') {
        folders.emplace_back(runtime);
    }
    folders.emplace_back(temporary);
    return folders;
}

std::string socket_file(const std::string& name, const std::string& folder) {
    return "disparityd" + (name == "default" ? "" : '-' + name) +
           (folder == temporary ? '-' + std::to_string(getuid()) : "") + ".sock";
}

std::vector<std::string> running_daemons() {
    std::set<std::string> names;
    for (const std::string& folder : socket_folders()) {
        std::error_code error;
        for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
             entry.increment(error)) {
            const std::string file = entry->path().filename().string();
            const auto name = daemon_of(file, folder);
            if (name && entry->symlink_status(error).type() == std::filesystem::file_type::socket &&
                somebody_listens(entry->path().string())) {
                names.insert(*name);
            }
            error.clear();
        }
    }
    return {names.begin(), names.end()};
}

}  // namespace disparityd::clients

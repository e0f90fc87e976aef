// SPDX-License-Identifier: Apache-2.0
#include "proto/socket_places.h"

#include <cerrno>
#include <cstdlib>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "proto/shared_memory_layout.h"

namespace disparityd::proto {
namespace {

constexpr const char* temporary = "/tmp";

/// Connects, says nothing and waits for nothing. Returns the errno of the refusal; 0: there is none.
int error_of_connecting(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) {
        return ENOENT;  // nobody can have a socket there
    }
    path.copy(address.sun_path, path.size());
    const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    const bool connected = fd >= 0 && ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    const int error = connected ? 0 : errno;
    if (fd >= 0) {
        ::close(fd);
    }
    return error;
}

}  // namespace

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

std::optional<std::string> daemon_of_socket_file(const std::string& file, const std::string& folder) {
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

bool is_trusted_socket(const std::string& path, bool of_the_system) {
    struct stat status {};
    // stat would follow a link of another user.
    return lstat(path.c_str(), &status) == 0 && S_ISSOCK(status.st_mode) &&
           (of_the_system || status.st_uid == getuid() || status.st_uid == 0);
}

bool somebody_listens(const std::string& path) {
    const int error = error_of_connecting(path);
    // Of a daemon with too many that wait it is said to try again later.
    return error == 0 || error == EAGAIN;
}

bool nobody_listens(const std::string& path) {
    const int error = error_of_connecting(path);
    return error == ECONNREFUSED || error == ENOENT;
}

}  // namespace disparityd::proto

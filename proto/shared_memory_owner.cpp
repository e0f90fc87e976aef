// SPDX-License-Identifier: Apache-2.0
#include "proto/shared_memory_owner.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <vector>

#include <pwd.h>
#include <unistd.h>

namespace disparityd::proto {
namespace {

/// Calls getpwnam_r() or getpwuid_r() with a buffer that is large enough. Returns nullptr where there is no such user.
template <typename Call>
const passwd* look_up(const Call& call, passwd& entry, std::vector<char>& buffer) {
    constexpr std::size_t most = 1 << 20;
    buffer.resize(1024);
    passwd* found = nullptr;
    int error = 0;
    while ((error = call(&entry, buffer.data(), buffer.size(), &found)) == EINTR ||
           (error == ERANGE && buffer.size() < most)) {
        buffer.resize(error == ERANGE ? 2 * buffer.size() : buffer.size());
    }
    return found;
}

std::optional<uid_t> uid_of(const std::string& user) {
    passwd entry{};
    std::vector<char> buffer;
    const auto by_name = [&user](passwd* to, char* room, std::size_t size, passwd** found) {
        return ::getpwnam_r(user.c_str(), to, room, size, found);
    };
    if (const passwd* found = look_up(by_name, entry, buffer); found != nullptr) {
        return found->pw_uid;
    }
    uid_t number = 0;
    const auto [end, error] = std::from_chars(user.data(), user.data() + user.size(), number);
    if (!user.empty() && error == std::errc() && end == user.data() + user.size()) {
        return number;
    }
    return std::nullopt;
}

std::string mode_text(mode_t mode) {
    std::array<char, 8> digits{};
    const auto [end, _] = std::to_chars(digits.data(), digits.data() + digits.size(), mode & 07777U, 8);
    return '0' + std::string(digits.data(), end);
}

}  // namespace

std::string trusted_user(const std::string& named) {
    if (!named.empty()) {
        return named;
    }
    const char* variable = ::secure_getenv(owner_variable);
    return variable != nullptr && *variable != '\0' ? variable : service_user;
}

bool is_trusted(uid_t owner, const std::string& user) {
    return owner == 0 || owner == ::geteuid() || owner == uid_of(user);
}

std::string distrust(const struct stat& object, const std::function<bool(uid_t)>& trusted) {
    if (!S_ISREG(object.st_mode)) {
        return "is no plain file: nothing that disparityd made";
    }
    if (!trusted(object.st_uid)) {
        return "belongs to " + user_text(object.st_uid);
    }
    if ((object.st_mode & (S_IWGRP | S_IWOTH)) != 0) {
        return "can be written by others than its owner (mode " + mode_text(object.st_mode) +
               ", allowed: none of 0022): nothing that disparityd made";
    }
    return {};
}

std::string user_text(uid_t uid) {
    passwd entry{};
    std::vector<char> buffer;
    const auto by_uid = [uid](passwd* to, char* room, std::size_t size, passwd** found) {
        return ::getpwuid_r(uid, to, room, size, found);
    };
    const passwd* found = look_up(by_uid, entry, buffer);
    const std::string number = "uid " + std::to_string(uid);
    return found == nullptr ? "a user with " + number : "user " + std::string(found->pw_name) + " (" + number + ")";
}

}  // namespace disparityd::proto

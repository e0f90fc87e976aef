// SPDX-License-Identifier: Apache-2.0
#include "daemon/system/core_locks.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/failure_text.h"
#include "base/file_lock.h"

namespace disparityd::daemon {
namespace {

constexpr mode_t everybody_reads = 0444;

/// Returns whether somebody else has a lock on the file; false where that cannot be known.
bool is_locked_by_others(int descriptor) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    return fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

/// Returns whether the path still names the open file: a file that was removed locks nothing for those who come later.
bool is_named(int descriptor, const std::string& path) {
    struct stat file {};
    struct stat named {};
    return fstat(descriptor, &file) == 0 && lstat(path.c_str(), &named) == 0 && file.st_dev == named.st_dev &&
           file.st_ino == named.st_ino;
}

}  // namespace

CoreLocks::CoreLocks(bool takes_all, std::string folder) : takes_all_(takes_all), folder_(std::move(folder)) {}

CoreLocks::~CoreLocks() {
    leave();
}

void CoreLocks::leave() {
    while (!descriptors_.empty()) {
        give_back(descriptors_.begin()->first);
    }
    if (presence_ >= 0) {
        close(presence_);
        presence_ = -1;
    }
}

bool CoreLocks::claim(int core) {
    tell_others();
    if (takes_all_ && has_rivals()) {
        give_back(core);
        return false;
    }
    const auto held = descriptors_.find(core);
    if (held != descriptors_.end() && is_named(held->second, path_of(core))) {
        return true;
    }
    const int descriptor = lock_file(core);
    give_back(core);
    if (descriptor >= 0) {
        descriptors_.emplace(core, descriptor);
    }
    return descriptor >= 0;
}

void CoreLocks::give_back(int core) {
    if (const auto held = descriptors_.find(core); held != descriptors_.end()) {
        close(held->second);
        descriptors_.erase(held);
    }
}

std::string CoreLocks::path_of(int core) const {
    return folder_ + "/disparityd-core-" + std::to_string(core);
}

/// Returns the descriptor of the file, which is made where there is none; -1: refusal_ says why. Anybody may have put
/// something else there: the call follows no link and waits for no pipe. A reader may lock, so nobody needs to write.
int CoreLocks::open_file(const std::string& path) {
    constexpr int careful = O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
    int descriptor = open(path.c_str(), careful);
    if (descriptor < 0 && errno == ENOENT) {
        descriptor = open(path.c_str(), careful | O_CREAT | O_EXCL, everybody_reads);
        if (descriptor >= 0) {
            fchmod(descriptor, everybody_reads);  // whatever the mask of this process is
        } else if (errno == EEXIST) {             // another process was faster
            descriptor = open(path.c_str(), careful);
        }
    }
    const int error = errno;
    struct stat file {};
    if (descriptor < 0) {
        refusal_ = path + ": " + base::error_text(error);
    } else if (fstat(descriptor, &file) != 0 || !S_ISREG(file.st_mode)) {
        refusal_ = path + ": something that is no plain file has this name; remove it";
        close(descriptor);
        descriptor = -1;
    }
    return descriptor;
}

std::string CoreLocks::presence_path(bool takes_all) const {
    return folder_ + (takes_all ? "/disparityd-core-all" : "/disparityd-core-shares");
}

/// Has the lock by which others see this one. Where that cannot be there is none, and no core has a lock either.
void CoreLocks::tell_others() {
    const std::string path = presence_path(takes_all_);
    if (presence_ >= 0 && is_named(presence_, path)) {
        return;
    }
    if (presence_ >= 0) {
        close(presence_);
    }
    presence_ = open_file(path);
    struct flock lock {};
    lock.l_type = F_RDLCK;
    lock.l_whence = SEEK_SET;
    fcntl(presence_, F_OFD_SETLK, &lock);
}

/// Returns whether another one takes all cores, too, or has a share of its own; refusal_ says which.
bool CoreLocks::has_rivals() {
    if (is_locked_by_others(presence_)) {
        refusal_ = "another daemon takes all cores, too ([pipeline] cores gives each its share)";
        return true;
    }
    const int shares = open_file(presence_path(false));
    const bool has_way = is_locked_by_others(shares);
    if (shares >= 0) {
        close(shares);
    }
    if (has_way) {
        refusal_ = "another daemon has a share of the cores, and comes first ([pipeline] cores gives this one a share)";
    }
    return has_way;
}

/// Returns the descriptor of the locked file; -1: refusal_ says why.
int CoreLocks::lock_file(int core) {
    constexpr int attempts = 3;  // somebody may remove the file between the two calls, but not for ever
    for (int attempt = 0; attempt < attempts; ++attempt) {
        const int descriptor = open_file(path_of(core));
        if (descriptor < 0) {
            return descriptor;
        }
        if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
            const int error = errno;
            refusal_ = error == EWOULDBLOCK ? "core " + std::to_string(core) + " is held by another program" +
                                                  base::lock_holder(descriptor)
                                            : path_of(core) + " cannot be locked: " + base::error_text(error);
            close(descriptor);
            return -1;
        }
        if (is_named(descriptor, path_of(core))) {
            return descriptor;
        }
        close(descriptor);
    }
    refusal_ = path_of(core) + ": another program removes it again and again";
    return -1;
}

}  // namespace disparityd::daemon

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include "proto/mapping.h"

/// A reader of shared memory holds a read lock on the object's first byte as long as it has the object mapped: so the
/// daemon knows that there is one, though a reader writes nothing. The kernel takes the lock away, however the reader
/// ends. A lock keeps nobody from anything.
namespace disparityd::proto {

inline struct flock first_byte(short type) {
    struct flock lock {};
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    lock.l_len = 1;
    return lock;
}

/// Locks until the file is closed. Where the system has no such locks, the daemon sees a reader that waits all the
/// same.
inline void hold_reader_lock(const Descriptor& file) {
    struct flock lock = first_byte(F_RDLCK);
    ::fcntl(file.get(), F_OFD_SETLK, &lock);
}

/// Returns whether another open file holds a lock.
inline bool has_reader_lock(const Descriptor& file) {
    struct flock lock = first_byte(F_WRLCK);
    return ::fcntl(file.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace disparityd::proto

// SPDX-License-Identifier: Apache-2.0
#include "proto/shared_memory_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <stdexcept>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "proto/descriptor.h"
#include "proto/futex.h"
#include "proto/mapping.h"
#include "proto/monotonic_clock.h"
#include "proto/sequence_lock.h"

namespace disparityd::proto {
namespace {

/// A copy that the writer overtook is tried again at once; only this often when the time is up already.
constexpr int attempts_beyond_timeout = 8;

std::string reason_to_open(const std::string& object, int error) {
    if (error == EACCES) {
        return "shared memory " + object + ": access denied: join the daemon's group, or run as its user";
    }
    return "shared memory " + object + ": cannot be opened: " + std::strerror(error);
}

std::string reason_to_map(const std::string& object, int error) {
    return "shared memory " + object + ": cannot be mapped: " + std::strerror(error);
}

}  // namespace

ShmReader::ShmReader(const std::string& name, const Options& options)
    : object_name_(shm_object_name(name)), options_(options) {
    if (!map_current()) {
        throw std::runtime_error("shared memory " + object_name_ +
                                 ": there is none: is disparityd running, with shared memory on and this name?");
    }
}

ShmReader::~ShmReader() {
    unmap();
}

void ShmReader::unmap() {
    if (header_ != nullptr) {
        ::munmap(const_cast<ShmHeader*>(header_), mapped_bytes_);
        header_ = nullptr;
    }
}

bool ShmReader::map_current() {
    const int fd = ::shm_open(object_name_.c_str(), O_RDONLY, 0);
    if (fd < 0) {
        if (errno == ENOENT) {
            return false;
        }
        throw std::runtime_error(reason_to_open(object_name_, errno));
    }
    const Descriptor file(fd);
    struct stat info {};
    if (::fstat(file.get(), &info) != 0) {
        throw std::runtime_error(reason_to_map(object_name_, errno));
    }
    // Two objects that exist at the same time never share an inode number, and ours exists as long as we map it.
    if (header_ != nullptr && info.st_ino == inode_) {
        return header_->generation.load(std::memory_order_acquire) == generation_;
    }
    if (info.st_size <= 0) {
        throw std::runtime_error("shared memory " + object_name_ + " is empty");
    }
    const auto bytes = static_cast<std::uint64_t>(info.st_size);
    Mapping mapping(file, bytes, PROT_READ);
    if (!mapping) {
        throw std::runtime_error(reason_to_map(object_name_, errno));
    }
    const auto& header = mapping.start<const ShmHeader>();
    ShmView view;
    if (const std::string wrong = check_header(header, bytes, view); !wrong.empty()) {
        throw std::runtime_error("shared memory " + object_name_ + " " + wrong);
    }
    const std::uint32_t generation = header.generation.load(std::memory_order_acquire);
    if (generation == 0) {
        return false;
    }
    unmap();
    mapping.release();
    header_ = &header;
    mapped_bytes_ = bytes;
    inode_ = info.st_ino;
    generation_ = generation;
    last_total_ = 0;
    view_ = view;
    return true;
}

std::chrono::nanoseconds ShmReader::heartbeat_age() const {
    if (header_ == nullptr) {
        return std::chrono::nanoseconds::max();
    }
    // Any value may stand there; a difference that does not fit is no age.
    std::int64_t age = 0;
    if (__builtin_sub_overflow(monotonic_ns(), header_->heartbeat_ns.load(std::memory_order_acquire), &age)) {
        age = std::numeric_limits<std::int64_t>::max();
    }
    return std::chrono::nanoseconds(std::max<std::int64_t>(age, 0));
}

bool ShmReader::lives() const {
    return header_ != nullptr && header_->generation.load(std::memory_order_acquire) == generation_;
}

ShmReader::Copy ShmReader::copy_newest(ShmFrame& frame, const Target& target) {
    const std::uint64_t total = header_->published_total.load(std::memory_order_acquire);
    if (total == last_total_ || total == 0) {
        return Copy::nothing_new;
    }
    const ShmSlot& slot = slot_at(*header_, view_, (total - 1) % view_.slot_count);
    const ReadCheck check(slot.lock);
    if (check.writer_inside()) {
        return Copy::torn;
    }
    copy_from_shared(&frame, reinterpret_cast<const std::uint64_t*>(&slot.frame), sizeof frame);
    for (std::uint32_t i = 0; i < view_.plane_count; ++i) {
        if (std::uint8_t* to = target(view_.planes[i]); to != nullptr) {
            copy_from_shared(to, plane_words(slot, view_, view_.planes[i]), view_.planes[i].bytes);
        }
    }
    if (!check.unchanged()) {
        return Copy::torn;
    }
    last_total_ = total;
    return Copy::done;
}

ShmReader::Result ShmReader::read(ShmFrame& frame, const Target& target, std::chrono::nanoseconds timeout) {
    // Far beyond any use, and near enough that sums cannot overflow.
    const auto longest = std::chrono::nanoseconds(std::chrono::hours(24 * 365));
    const std::int64_t deadline = monotonic_ns() + std::clamp(timeout, std::chrono::nanoseconds(0), longest).count();
    int attempts = 0;
    while (true) {
        if (!lives() && !map_current()) {
            unmap();
            return Result::gone;
        }
        const std::uint32_t seen = header_->published.load(std::memory_order_acquire);
        const Copy copy = copy_newest(frame, target);
        if (copy == Copy::done) {
            return Result::frame;
        }
        const std::int64_t now = monotonic_ns();
        if (copy == Copy::torn) {
            if (now >= deadline && ++attempts >= attempts_beyond_timeout) {
                return Result::timeout;
            }
            continue;
        }
        if (heartbeat_age() > options_.stale_after) {
            const std::uint64_t before = inode_;
            if (!map_current() || inode_ == before) {
                return Result::gone;
            }
            continue;
        }
        if (now >= deadline) {
            return Result::timeout;
        }
        if (lives()) {
            futex_wait(header_->published, seen,
                       std::min(std::chrono::nanoseconds(deadline - now), options_.check_every));
        }
    }
}

}  // namespace disparityd::proto
